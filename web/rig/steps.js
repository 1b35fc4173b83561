// The steps of the page, from the values of a rig to what it takes to watch it.

import { merged } from '../api/scene-query.js';
import { number, quantity } from '../dom/numbers.js';
import { capitalized, inWords } from '../dom/typeset.js';
import { absolute, frame } from '../export/save-actions.js';
import { Form } from '../form/form.js';
import { useAnswer } from '../panels/ask.js';
import { Panel } from '../panels/card.js';
import { useMeasured } from '../panels/measured/read.js';
import { Code, Folded, NumberField, Numbers, Row, Scale, Spoken, Table, Told } from '../panels/parts.js';
import { sentence, sign, useChanges, words } from '../panels/parts.js';
import { Cases } from '../panels/scene-page.js';
import { ERRORS, GAINS, linesOf, rangeWords, thingOf, typedUnit } from '../panels/verdict/facts.js';
import { numbersOf } from '../panels/verdict/verdict.js';
import { plainly, rangeOf, verdictOf } from '../panels/verdict/words.js';
import { contactDistance, derivedOf, drawable } from '../physics/body.js';
import { drawSymbols } from '../scene/symbols.js';
import { World } from '../scene/world.js';
import { html, useEffect, useLayoutEffect, useRef, useState } from '../vendor/preact/preact.js';

/** @import { Controller as Law } from 'contract' */
/** @import { Ends } from '../panels/verdict/words.js' */
/** @import { Line } from '../panels/verdict/facts.js' */

/** The verdict on a scene, with the gains that this release allows. @param {string | URLSearchParams | null} query null for none */
const useVerdict = (query) => useAnswer(query && `v1/stability?${query}&release_margins=true`, { quiet_ms: 0 });

/** Opens a step, and brings it into view. @param {string} id */
export function openStep(id) {
  if (location.hash === `#${id}`) dispatchEvent(new Event('hashchange'));
  else location.hash = id;
}

/**
 * A numbered step that folds to its result.
 * @param {{n: number, id: string, title: string, result: Result, open?: boolean, children: any}} props a body as a function is made when the step is opened
 */
function Step({ n, id, title, result, open: begins = false, children }) {
  const [open, turn] = useState(begins || location.hash === `#${id}`);
  const seen = useRef(open);
  seen.current ||= open;
  useEffect(() => {
    const named = () => {
      if (location.hash !== `#${id}`) return;
      turn(true);
      document.getElementById(id)?.scrollIntoView();
    };
    addEventListener('hashchange', named);
    named();
    return () => removeEventListener('hashchange', named);
  }, []);
  return html`<section id=${id} class="step card" aria-labelledby=${`${id}-title`}>
    <details open=${open} onToggle=${(/** @type {Event} */ event) => turn(/** @type {HTMLDetailsElement} */ (event.currentTarget).open)}>
      <summary>
        <h2 id=${`${id}-title`}><span class="n">${n}</span> ${title}</h2>
        ${result && html`<span class="result"><${Told} result=${result} /></span>`}
      </summary>
      <div class="step-body stack">${seen.current && (typeof children === 'function' ? children(open) : children)}</div>
    </details>
    <a class="to-step" href=${`#${id}`} aria-label=${`Link to step ${n}: ${title}`}>#</a>
  </section>`;
}

// Step 1: the values of the rig. Those that a lab knows first stand open, all others behind a search.

/** Fields that a lab knows first. */
const FIRST = [
  'body.contact_distance',
  'body.radius_of_gyration',
  'contact.restitution',
  'contact.friction',
  'table.tilt_gain',
  'release.theta',
  'release.height',
];

/** @param {Scene} scene */
const slides = ({ table }) => table?.slide === 'matched';

/** The rig in a line. @param {Rig} rig */
function summary({ scene, chosen }) {
  const { body = {}, contact = {}, table = {} } = scene;
  const parts = [
    body.point ? 'a point mass' : body.vertices ? 'a polygon' : `l ${quantity(body.contact_distance, 'm', 3)}`,
    `e ${quantity(contact.restitution ?? 1, '1', 3)}`,
    `μ ${quantity(contact.friction ?? 0, '1', 3)}`,
    table.feedback ? 'state feedback' : `κ ${quantity(table.tilt_gain, '1', 4)}`,
    ...(slides(scene) ? ['a table that slides along'] : []),
  ];
  return `${chosen ? `${chosen.title}: ` : ''}${parts.join(', ')}`;
}

/** @param {{rig: Rig, verdict: Answer<Stability>}} props */
function Values({ rig, verdict }) {
  const first = useRef(/** @type {HTMLElement | null} */ (null));
  const more = useRef(/** @type {HTMLElement | null} */ (null));
  /** @type {{current: Form | null}} */
  const made = useRef(null);
  useEffect(() => {
    if (!first.current || !more.current) return;
    const form = new Form(
      more.current,
      rig.fields,
      (_, final) => {
        const complete = form.typed.complete !== null;
        rig.type(form.typed.typed ?? {}, complete);
        if (!complete) form.complain();
        // The address keeps what was before a drag until it ends.
        if (complete && final) rig.keep(true);
      },
      { first: FIRST, into: first.current },
    );
    first.current.addEventListener('submit', (event) => event.preventDefault());
    made.current = form;
    const fill = () => {
      form.compare(rig.chosen?.scene ?? null);
      // The scene that was typed is there already.
      if (form.typed.typed !== rig.scene) form.typed.fill(rig.scene);
    };
    fill();
    rig.addEventListener('change', fill);
  }, []);
  const { problem } = verdict;
  useEffect(() => {
    made.current?.blame(problem?.errors ?? []);
  }, [problem]);
  return html`<${Step} n=${1} id="values" title="Your values" open result=${{ tone: 'none', words: summary(rig) }}>
    <${Cases} page=${rig} id="case" label="Begin with" own="values of your own" />
    <div class="values stack">
      <form class="rig-first" ref=${first} novalidate aria-label="Values that a lab knows first" />
      <${Drawing} scene=${rig.scene} derived=${verdict.answer?.derived ?? rig.chosen?.derived ?? null} />
    </div>
    ${rig.scene.table?.feedback && html`<p class="muted">A state feedback tilts its table, not a tilt gain. Its gains are below, and in step 4.</p>`}
    ${slides(rig.scene) && html`<p class="muted">The table slides along with the foot; the choice is below, under More. <button type="button" onClick=${() => rig.take(rig.with({ 'table.slide': null }))}>Let it stand</button></p>`}
    <details class="more">
      <summary>More: gravity, air, limits and errors of the table, noise</summary>
      <form id="parameters" ref=${more} novalidate aria-label="All other values" />
    </details>
  <//>`;
}

// Beside them the rig at its release, to scale, with the symbols of the paper.

/** The tilt of the table by its law at the angle of the release; null where it takes more than that. @param {Scene} scene */
function tiltOf({ table = {}, release = {} }) {
  const theta = release.theta ?? 0;
  if (table.feedback) return table.feedback.theta === undefined ? null : -table.feedback.theta * theta;
  return typeof table.tilt_gain === 'number' ? table.tilt_gain * theta : null;
}

class Release extends World {
  /** @type {Scene} */
  scene = {};
  followers = [drawSymbols];

  /** @override */
  draw() {
    const { height = 0, theta = 0 } = this.scene.release ?? {};
    this.forget();
    this.contain(this.scene, height);
    const table = { x: contactDistance(this.scene) * Math.sin(theta), y: 0, alpha: tiltOf(this.scene) ?? 0 };
    this.paint(this.scene, { x: 0, y: height, theta }, table, {});
    return false;
  }
}

/** @param {{scene: Scene, derived: Derived | null}} props */
function Drawing({ scene: typed, derived }) {
  const scene = drawable(typed, derived);
  const box = useRef(/** @type {any} */ (null));
  const view = useRef(/** @type {Release | null} */ (null));
  useLayoutEffect(() => {
    view.current ??= new Release(box.current, 1);
    view.current.scene = scene;
    view.current.redraw();
  });
  const { contact_distance: l, radius_of_gyration: rho } = derivedOf(scene);
  const { height = 0, theta = 0 } = typed.release ?? {};
  const alpha = tiltOf(typed) ?? 0;
  const words = [
    l > 0 ? `contact ${quantity(l, 'm', 3)} from the centre of gravity` : 'a point',
    rho !== null && `radius of gyration ${quantity(rho, 'm', 3)}`,
    `dropped from ${quantity(height, 'm', 3)} at ${quantity(theta, 'rad', 3)}`,
    `the table tilts ${quantity(alpha, 'rad', 3)} for it`,
  ].filter(Boolean);
  return html`<figure class="drawing">
    <div class="scene-frame" role="img" aria-label=${`The rig to scale: ${words.join(', ')}.`} ref=${box} />
    <figcaption class="muted">${alpha === 0 ? 'At its release, to scale' : `The table meets it at ${quantity(alpha, 'rad', 3)}`}</figcaption>
  </figure>`;
}

// Step 2: whether the rig balances, why, and for which gains.

/** Gains whose range is told, with symbol and name. */
const RANGES = /** @type {const} */ ([
  ['table.tilt_gain', 'κ', 'tilt gain'],
  ['table.feedback', 'K ×', 'gain of the state feedback, as a factor'],
  ['table.energy_gain', 'κ_E', 'energy gain'],
]);

/** Part of the range that is drawn beyond each end. */
const BEYOND = 0.25;

/** A gain on its ranges: that of small swings around that of this release. @param {{answer: Stability, gain: typeof RANGES[number]}} props */
function Range({ answer, gain: [field, symbol, name] }) {
  const { value, small, release, both: shown } = rangeOf(answer, field);
  if (!shown || (shown.low === null && shown.high === null)) return null;
  const falls = verdictOf(answer).tone === 'unstable';
  const letter = sign(symbol);
  const words = falls
    ? html`<span class="range-words muted">Small swings would hold for ${letter} ${rangeWords(shown)}</span>`
    : html`<span class="range-words">${letter}${` may be ${rangeWords(shown)}`}<span class="muted">${release ? ' for this release' : ' for small swings'}${release && small && ` · ${rangeWords(small)} for small swings`}</span></span>`;
  const ends = [small, release].flatMap((one) => (one ? [one.low, one.high] : [])).filter((end) => end !== null);
  if (shown.low === null || shown.high === null) return html`<p class="range row">${words}</p>`;
  const [least, most] = [Math.min(...ends, value), Math.max(...ends, value)];
  const room = (most - least) * BEYOND || 1;
  const bar = (/** @type {Ends | null | undefined} */ one, /** @type {string} */ kind) =>
    one?.low != null && one.high != null ? [[one.low, one.high, kind]] : [];
  return html`<div class=${`range row ${falls ? 'falls' : ''}`}>
    ${words}
    <${Scale} low=${least - room} high=${most + room} bars=${[...bar(small, 'small'), ...bar(shown, 'release')]} marks=${[[value, '']]}
      label=${`${name} ${number(value)}: it may be ${rangeWords(shown)}`} />
  </div>`;
}

/** Share of the angle of the release that is tried where the rig falls. */
const LESS = 1 / 3;

/** Changes that are tried where a rig falls, from the one that is made most easily on. @param {Scene} scene */
function othersOf({ contact = {}, table = {}, release = {} }) {
  const slides = contact.friction > 0 && (table.slide ?? 'none') === 'none';
  const angle = Number(((release.theta ?? 0) * LESS).toPrecision(2));
  const along = slides && {
    words: 'With a table that slides along with the foot',
    values: { 'table.slide': 'matched' },
  };
  const less = angle !== 0 && { words: `Released at ${quantity(angle, 'rad')}`, values: { 'release.theta': angle } };
  const words = along && less && `${along.words}, ${less.words.toLowerCase()}`;
  return [along, less, words && { words, values: { ...along.values, ...less.values } }];
}

/** Changes that would keep it up, where it falls. @param {{rig: Rig}} props */
function Others({ rig }) {
  const others = othersOf(rig.scene);
  const answers = others.map((other) => useVerdict(other ? rig.queryOf(rig.with(other.values)) : null));
  const held = others.findIndex((other, index) => {
    const { answer, current } = answers[index];
    return other && current && verdictOf(answer).tone !== 'unstable';
  });
  const other = others[held];
  if (!other) return html`<p>A <a href="#controller">controller</a> may hold it.</p>`;
  const { both: range } = rangeOf(answers[held].answer, 'table.tilt_gain');
  const result = verdictOf(answers[held].answer);
  return html`<p class="other">
    ${other.words}: <${Told} result=${{ ...result, words: result.reason }} />${range && `, κ ${rangeWords(range)}`}.${' '}
    <button type="button" onClick=${() => rig.take(rig.with(other.values))}>Use it</button>
  </p>`;
}

/** @param {{rig: Rig, verdict: Answer<Stability>, result: Result}} props */
function Verdict({ rig, verdict: { answer, problem, lost, current }, result }) {
  const held = !rig.complete || problem || lost;
  const gains = RANGES.filter(([field]) => field !== 'table.energy_gain' || answer?.scene.table.energy_gain !== 0);
  const falls = answer && !held && verdictOf(answer).tone === 'unstable';
  return html`<${Step} n=${2} id="verdict" title="Will it balance?" open result=${result}>
    <p class="headline" aria-busy=${!current}>${result && html`<${Told} result=${result} />`}</p>
    <${Spoken} words=${result?.words ?? ''} />
    ${lost && html`<p>${lost}</p>`}
    ${problem && html`<p>${words(faultOf(problem))}</p>`}
    ${
      answer &&
      !held &&
      html`${gains.map((gain) => html`<${Range} key=${gain[0]} answer=${answer} gain=${gain} />`)}
      ${falls && html`<${Others} rig=${rig} />`}
      <${Folded} title="Why, and numbers">
        <p>${sentence(plainly(answer.verdict.reason))}</p>
        <${Numbers} rows=${numbersOf(answer)} />
        ${answer.notes.map((note) => html`<p class="muted">${sentence(note)}</p>`)}
      <//>`
    }
  <//>`;
}

/** The words of the server on values that it refuses. @param {Problem} problem */
const faultOf = ({ errors, message }) =>
  errors.length === 0 ? message : errors.map(({ detail }) => `${capitalized(inWords(detail))}.`).join(' ');

/** The first words of the step. @param {Rig} rig @param {Answer<Stability>} verdict @returns {Result} */
function verdictResult(rig, { answer, problem, lost }) {
  if (!rig.complete) return { tone: 'none', words: 'No verdict: a value is missing in step 1' };
  if (lost) return { tone: 'none', words: 'No verdict: the server does not answer' };
  if (problem) return { tone: 'none', words: 'No verdict: these values do not go together, see step 1' };
  return answer ? verdictOf(answer) : { tone: 'none', words: 'Asking…' };
}

/** @typedef {NonNullable<Stability['budget']>} Budget */
/** @typedef {Answer<Stability>} Limits */

// Step 3: what ends the balance first. Each limit is set against what the owner has.

/** Bounces that a run has to survive: fewer than those of the verdict, for a budget takes a thousand runs. */
const BOUNCES = 500;
/** The budget of a scene, once it stays. @param {string | URLSearchParams | null} query null for none */
const useBudget = (query) => useAnswer(query && `v1/stability?${query}&budget=true&bounces=${BOUNCES}`);

/** The first line in a sentence. @param {Line[]} lines @returns {Result} */
function firstOf([first]) {
  if (!first) return { tone: 'stable', words: 'Nothing ends it within the errors that are tried' };
  if (!first.short) return { tone: 'stable', words: `All fine; the nearest: ${first.says}` };
  const verb = first.known ? 'Mend' : 'Check';
  return { tone: 'beyond', words: `${verb} ${first.thing.what} first: ${first.size} ends it` };
}

/** Ends of the scale of the bars, as powers of ten of limit over what there is. */
const [LOW, HIGH] = [-2, 2];

/** A bar that ends at the limit; the mark stands where that is what the owner has. @param {{line: Line}} props */
function Bar({ line: { ratio } }) {
  const words = ratio >= 100 ? 'a hundred times what you have, or more' : `${number(ratio, 2)} of what you have`;
  const end = ratio === 0 ? LOW : Math.log10(ratio);
  return html`<${Scale} low=${LOW} high=${HIGH} bars=${[[LOW, Math.max(LOW + 0.04, end), '']]} marks=${[[0, '']]} label=${words} kind=${ratio < 1 ? 'short' : 'long'} />`;
}

/** The field for what the owner has. @param {{rig: Rig, field: string, unit: string, has: number}} props */
function Has({ rig, field, unit, has }) {
  const { what } = thingOf(field);
  const [typed, size] = typedUnit(field, unit);
  const id = `have-${field.replaceAll('.', '-')}`;
  return html`<span class="limit-has"><label for=${id}>you have ±</label>
    <${NumberField} id=${id} label=${`You have, ${what}, plus or minus`} unit=${typed}
      value=${field in rig.have ? rig.have[field] / size : undefined}
      placeholder=${String(Number((has / size).toPrecision(3)))} open
      fault=${(/** @type {number} */ value) => (value >= 0 ? null : 'It must be 0 or more.')}
      changed=${(/** @type {number | undefined} */ value) => rig.own(field, value === undefined ? undefined : value * size)}
      />
  </span>`;
}

/** @param {{rig: Rig, line: Line}} props */
function Limit({ rig, line }) {
  const { error, says, lost, has, told, own, known, short } = line;
  const act = short ? (known ? 'mend this' : 'check this') : 'fine';
  return html`<li class="limit" data-field=${error.field}>
    <span class="limit-words">${says}<span class="note">${lost}</span></span>
    <${Bar} line=${line} />
    <${Has} rig=${rig} field=${error.field} unit=${error.unit} has=${has} />
    <span class=${`limit-act ${short ? 'short' : 'long'}`}>${act}${!told && html`<span class="note"> ${own ? 'as in your values' : 'if usual'}</span>`}</span>
  </li>`;
}

/** Lines that stand open; the others fold. */
const WORST = 6;

/** @param {{rig: Rig, lines: Line[]}} props */
const Lines = ({ rig, lines }) =>
  html`<ul class="limits">
    ${lines.map((line) => html`<${Limit} key=${line.error.field} rig=${rig} line=${line} />`)}
  </ul>`;

/** The errors of a rig that has no limits, for its owner to tell of. @param {{rig: Rig}} props */
const Unlimited = ({ rig }) => html`<p class="muted">Tell already what your rig has; its limits come with a verdict.</p>
  <ul class="limits">
    ${rig.fields
      .filter(({ field }) => ERRORS.includes(field))
      .map(
        ({ field, unit }) => html`<li class="limit" key=${field} data-field=${field}>
        <span class="limit-words">${capitalized(thingOf(field).what)}</span>
        <${Has} rig=${rig} field=${field} unit=${unit} has=${thingOf(field).usual} />
      </li>`,
      )}
  </ul>`;

/** @param {{budget: Budget, rig: Rig}} props */
function Whole({ budget, rig }) {
  const { errors, together, present, bounces, reason } = budget;
  if (!errors) return html`<p>${sentence(plainly(reason ?? ''))}</p><${Unlimited} rig=${rig} />`;
  const lines = linesOf(budget, rig.have);
  const rest = lines.slice(WORST);
  const others = errors.filter(({ field }) => !lines.some(({ error }) => error.field === field));
  const free = others.filter(({ reason: why }) => why === null).map(({ field }) => thingOf(field).what);
  const none = others.filter(({ reason: why }) => why !== null);
  const share = (/** @type {number} */ factor) => `${number(100 * factor, 2)} %`;
  return html`<p class="muted">Each alone, until a run of ${number(bounces)} bounces is lost. The line across the bars is what you have; type yours, and the worst comes first. Grey ones are usual in a lab.</p>
    <${Lines} rig=${rig} lines=${lines.slice(0, WORST)} />
    ${
      rest.length > 0 &&
      html`<details id="other-limits">
        <summary>${rest.length} more</summary>
        <${Lines} rig=${rig} lines=${rest} />
      </details>`
    }
    ${together && html`<p>All at once: each may come to ${share(together.factor.value)} of its limit${lines.some(({ limit }) => limit === 0) && ', but for those that may not be at all'}.</p>`}
    ${present && html`<p>${present.factor.value < 1 ? `The errors in your values are too large together: all would have to come down to ${share(present.factor.value)}.` : `The errors in your values may all grow to ${share(present.factor.value)}.`}</p>`}
    ${
      others.length > 0 &&
      html`<${Folded} title=${`${others.length} without a limit here`}>
        ${free.length > 0 && html`<p>Of any size that was tried: ${free.join(', ')}.</p>`}
        ${none.map(({ field, reason: why }) => html`<p>${capitalized(thingOf(field).what)}: ${sentence(plainly(why ?? ''))}</p>`)}
      <//>`
    }
    <${Folded} title="Numbers">
      <${Table} label="Limits by field" head=${['field', 'here', 'down by', 'up by', 'unit']}>
        ${errors.map(({ field, value, below, above, unit }) => html`<${Row} cells=${[field, ...[value, below?.value, above?.value].map((one) => number(one, 4)), unit]} />`)}
      <//>
    <//>`;
}

/**
 * The verdict with the errors that the owner has told: those that end it come after the word of the rig without errors.
 * @param {Result} result
 * @param {Limits} limits
 * @param {Rig['have']} have
 * @returns {Result}
 */
function withErrors(result, { answer, current }, have) {
  if (!result || !current || !answer?.budget?.errors || !['stable', 'beyond'].includes(result.tone)) return result;
  const ending = linesOf(answer.budget, have).find(({ told, short }) => told && short);
  return ending
    ? { tone: 'beyond', words: `Yes without errors; with yours no: ${ending.thing.what}, ${ending.size}` }
    : result;
}

/** @param {Rig} rig @param {Limits} limits @param {boolean} falls @returns {NonNullable<Result>} */
function budgetResult(rig, { answer, current, problem, lost }, falls) {
  if (lost) return { tone: 'none', words: 'The server does not answer' };
  if (rig.query === null || problem) return { tone: 'none', words: 'It has no limits without a verdict' };
  if (!answer?.budget || !current) return { tone: 'none', words: 'Trying some thousand runs…' };
  if (answer.budget.errors) return /** @type {any} */ (firstOf(linesOf(answer.budget, rig.have)));
  return falls
    ? { tone: 'unstable', words: 'It falls without any error: mend its values first' }
    : { tone: 'none', words: 'It has no limits' };
}

/** @param {{rig: Rig, limits: Limits, falls: boolean}} props */
function Budget({ rig, limits, falls }) {
  const { answer, current, problem, lost } = limits;
  const result = budgetResult(rig, limits, falls);
  const isLacking = rig.query === null || problem !== null;
  return html`<${Step} n=${3} id="budget" title="What ends it first" open result=${result}>
    <p class="answer">${result.words}${result.words.endsWith('…') ? '' : '.'}</p>
    <${Spoken} words=${result.words} />
    ${lost && html`<p>${lost}</p>`}
    ${isLacking && !lost && html`<${Unlimited} rig=${rig} />`}
    ${answer?.budget && !isLacking && !lost && html`<div class=${current ? '' : 'stale'}><${Whole} budget=${answer.budget} rig=${rig} /></div>`}
  <//>`;
}

// Step 4: the law of the table as it is, beside a designed one.

/** The law of a scene in symbols. @param {Scene} scene */
function lawOf({ table = {} }) {
  if (!table.feedback) return [sign('κ'), ` ${number(table.tilt_gain)}`];
  return GAINS.filter(([name]) => table.feedback[name] !== undefined).map(
    ([name, letter, unit], index) =>
      html`${index > 0 && ', '}${sign(`K_${letter}`)} ${quantity(table.feedback[name], unit, 3)}`,
  );
}

/** Tilt gain that is tried where a case has none. */
const USUAL_GAIN = 1.1;

/** A scene with a tilt gain in place of its state feedback. @param {Rig} rig */
const withGain = ({ scene, chosen }) =>
  merged(scene, { table: { feedback: null, tilt_gain: chosen?.scene.table?.tilt_gain ?? USUAL_GAIN } });

/** A scene with another law. @param {Scene} scene @param {Law['gain']} gain */
const withLaw = (scene, gain) => merged(scene, { table: { tilt_gain: null, feedback: gain } });

/** The compared cells of a law. @param {Stability} answer */
function factsOf(answer) {
  const { both: range } = rangeOf(answer, answer.scene.table.feedback ? 'table.feedback' : 'table.tilt_gain');
  const radius = answer.linear?.spectral_radius ?? NaN;
  const dies = `falls to a tenth in ${number(Math.log(0.1) / Math.log(radius), 2)} bounces`;
  return [
    answer.verdict.code === 'unstable' || Number.isNaN(radius) ? '–' : radius < 1 ? dies : 'goes on',
    range ? rangeWords(range) : '–',
    answer.nonlinear.demand ? quantity(answer.nonlinear.demand.tilt, 'rad', 3) : '–',
  ];
}

/** A law among those compared. @param {{rig: Rig, name: string, scene: Scene, open: boolean, held: boolean}} props the scene with the law; `open` while somebody sees it, `held` where there is no verdict on the rig */
function Law({ rig, name, scene, open, held }) {
  const query = rig.complete ? String(rig.queryOf(scene)) : null;
  const judged = useVerdict(query);
  // A verdict from before is no answer to values that do not go together.
  const { current } = judged;
  const answer = held || judged.problem || judged.lost ? null : judged.answer;
  const { answer: limits, current: limited } = useBudget(open ? query : null);
  const [first] = limits?.budget?.errors && limited ? linesOf(limits.budget, rig.have) : [];
  const use = html`<button type="button" disabled=${!current} onClick=${() => rig.take(scene)} aria-label=${`Use it: ${name}`}>Use it</button>`;
  return html`<${Row} kind=${current ? '' : 'stale'} cells=${[
    html`${name}<span class="note">${lawOf(scene)}</span>`,
    answer ? html`<${Told} result=${verdictOf(answer)} />` : '–',
    ...(answer ? factsOf(answer) : ['–', '–', '–']),
    first && answer ? first.says : limited || !answer ? '–' : '…',
    query === rig.words ? 'in use' : use,
  ]} />`;
}

const HEAD = ['Law', 'Balances?', 'A swing', 'Gain may be', 'Most tilt', 'Ends it first'];

/** @param {{rig: Rig, held: boolean}} props */
function Controller({ rig, held }) {
  /** The design by other weights is open; null before it was for the first time. */
  const [weighed, weigh] = useState(/** @type {boolean | null} */ (null));
  const { query, scene } = rig;
  // A point has no angle to feed back.
  const isPoint = Boolean(scene.body?.point);
  const designed = useAnswer(query && !isPoint ? `v1/controllers?${query}` : null);
  /** The newest law stays until there is another, so that nothing moves. @type {Law | null} */
  const law = isPoint || designed.problem ? null : designed.answer;
  const other = law && withLaw(scene, law.gain);
  const judged = useVerdict(other && rig.queryOf(other));
  const found = judged.current ? judged.answer : null;
  const isFeedback = Boolean(scene.table?.feedback);
  const verdict = found && verdictOf(found);
  const lacking = held
    ? 'It has no laws without a verdict'
    : designed.problem || isPoint
      ? 'No state feedback for this body'
      : !verdict && 'Asking…';
  const result = lacking
    ? { tone: 'none', words: lacking }
    : { tone: verdict?.tone, words: `State feedback, designed: ${verdict?.reason}` };
  const body = (/** @type {boolean} */ open) => {
    const row = (/** @type {string} */ name, /** @type {Scene | null} */ one) =>
      one && html`<${Law} rig=${rig} open=${open} held=${held} name=${name} scene=${one} />`;
    return html`<${Table} label="Controllers compared" kind="laws" head=${[...HEAD, html`<span class="unseen">Use</span>`]}>
        ${row(isFeedback ? 'State feedback, as it is' : 'Tilt gain, as it is', scene)}
        ${row('Tilt gain alone', isFeedback ? withGain(rig) : null)}
        ${row('State feedback, designed', other)}
      <//>
      ${isPoint && html`<p>A point has no angle of its own, and so no state feedback.</p>`}
      ${designed.problem && !held && html`<p>${words(designed.problem.message)}</p>`}
      ${designed.lost && html`<p>${designed.lost}</p>`}
      <p class="muted">A tilt in proportion to the angle keeps a body circling. State feedback needs its place and velocities too, and brings it to rest in place.</p>
      <details onToggle=${(/** @type {Event} */ event) => weigh(/** @type {HTMLDetailsElement} */ (event.currentTarget).open)}>
        <summary>Design it by other weights</summary>
        ${weighed !== null && html`<${Panel} id="design" page=${rig} open=${weighed && open} />`}
      </details>`;
  };
  return html`<${Step} n=${4} id="controller" title="Choose a controller" result=${result}>${body}<//>`;
}

// Steps 5 to 7: measured bounces, noise, and this rig elsewhere.

/** Measured bounces, over the run of the rig's values, and what they tell of them. @param {{rig: Rig}} props */
function Measurements({ rig }) {
  const { name, content, words } = useMeasured();
  const [told, tell] = useState(/** @type {Result} */ (null));
  useEffect(() => tell(null), [content]);
  const say = (/** @type {string} */ said, /** @type {boolean | null} */ holds) =>
    tell({ tone: holds === null ? 'none' : holds ? 'stable' : 'unstable', words: `${name}: ${said}` });
  return html`<${Step} n=${5} id="measurements" title="Your measurements" result=${told ?? { tone: 'none', words: words || 'Drop a CSV file anywhere on the page' }}>
    <${Panel} id="fit" page=${rig} told=${say} />
  <//>`;
}

/** How many of many runs last when the table errs at random. @param {{rig: Rig}} props */
function Noise({ rig }) {
  const [words, tell] = useState('How many of many runs last when the table errs at random');
  return html`<${Step} n=${6} id="noise" title="Under noise" result=${{ tone: 'none', words }}>
    ${(/** @type {boolean} */ open) => html`<${Panel} id="survival" page=${rig} open=${open} told=${tell} />`}
  <//>`;
}

/** Text in quotes of YAML. @param {string} text */
const quoted = (text) => `'${text.replaceAll("'", "''")}'`;

/** The job of Prometheus that asks for the verdict on the rig. @param {string} query */
const scrape = (query) => `- job_name: equipoise_rigs
  metrics_path: /v1/probe
  static_configs:
    - targets: [${quoted(query)}]
      labels: { instance: my-rig }
  relabel_configs:
    - { source_labels: [__address__], target_label: __param_target }
    - { target_label: __address__, replacement: ${quoted(new URL(document.baseURI).host)} }`;

/** A rule of Prometheus on what the job above has asked. */
const ALERT = `- alert: MyRigUnstable
  expr: equipoise_stability_verdict{instance="my-rig",verdict_code=~"unstable|weakly_unstable"} == 1
- alert: MyRigNearItsLimit
  expr: min by (instance) (equipoise_margin{instance="my-rig",of="small"}) < 0.05`;

/** Exactly this rig in a dashboard, an alert and a script. @param {{rig: Rig}} props */
function Watch({ rig }) {
  const { words } = rig;
  return html`<${Step} n=${7} id="watch" title="Watch it" result=${{ tone: 'none', words: 'A link, a panel for your dashboard, an alert, a script' }}>
    <${Code} title="Link" about="Opens this page with your values." code=${absolute(`rig?${words}`)} />
    <${Code} title="In another page" about="The rig as it runs, in a frame." code=${frame('scene', 'my rig', `?${words}`)} />
    <${Code} title="Prometheus" about="A job that asks for the verdict and its margins." code=${scrape(words)} />
    <${Code} title="Alert" about="Rules for that job: it falls, or a gain is near its limit." code=${ALERT} />
    <div id="calls-body"><${Panel} id="calls" page=${rig} /></div>
  <//>`;
}

/** All steps, drawn anew with each change of the rig. @param {{rig: Rig}} props */
export function Steps({ rig }) {
  const { query } = useChanges(rig);
  const verdict = useVerdict(query);
  const limits = useBudget(query);
  const result = withErrors(verdictResult(rig, verdict), limits, rig.have);
  return html`<${Values} rig=${rig} verdict=${verdict} />
    <${Verdict} rig=${rig} verdict=${verdict} result=${result} />
    <${Budget} rig=${rig} limits=${limits} falls=${result?.tone === 'unstable'} />
    <${Controller} rig=${rig} held=${result?.tone === 'none'} />
    <${Measurements} rig=${rig} />
    <${Noise} rig=${rig} />
    <${Watch} rig=${rig} />`;
}
