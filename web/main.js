// The page: joins the form, the run and the panels. Not for what any of them does.

import { MOST_IMPACTS, Problem, get, server } from './api/client.js';
import { fieldsOf, pathOf, playedAt, same, setAt, valueAt } from './api/scene-fields.js';
import { Circle } from './charts/eigenvalue-circle.js';
import { Controls } from './run/controls.js';
import { Form } from './form/form.js';
import { Run } from './run/run.js';
import { SceneView } from './scene/scene-view.js';
import { Verdict } from './panels/verdict/verdict.js';
import { anglePlane, velocityPlane } from './charts/impacts/phase-planes.js';
import { byId, copy, h, prose, settled } from './dom/dom.js';
import { clearNotice, connectionNotice, notice } from './dom/notices.js';
import { energyPlot } from './charts/impacts/energy-plot.js';
import { enlarger } from './export/enlarge-button.js';
import { invalidate } from './charts/surface.js';
import { FASTEST, SLOWEST, interventionsOf, merged, readLink, sceneQuery } from './app/link.js';

/** @typedef {import('./api/scene-fields.js').Field} Field */
/** @typedef {import('contract').Preset} Case */
/** @typedef {import('./api/scene-fields.js').Scene} Scene */

const GAIN = 'table.tilt_gain';
/** What `[` and `]` go through. */
const SPEEDS = [SLOWEST, 0.1, 0.2, 0.5, 1, 2, 5, 10, FASTEST];
const chooser = byId('case', HTMLSelectElement);

/** @type {Field[]} */
let fields = [];
/** @type {Case[]} */
let cases = [];
/** @type {Case | null} */
let chosen = null;
/** @type {Form | null} */
let form = null;
let speed = 1;
/** What was typed when the run began. @type {Scene} */
let releasedAs = {};
/** Those below the fold, which come after the first plot. @type {import('./panels/panels.js').Panels | null} */
let panels = null;
/** What acts on all charts of the impacts, after the first plot too. @type {import('./charts/impacts/plot-interaction.js').Acts | null} */
let acts = null;
/** What they show by the link, and the newest verdict, until they are there. */
let panelLink = new URLSearchParams();
/** @type {import('./panels/panels.js').Judged | null} */
let judged = null;
/** Whether the run has lost the server, and whether the newest scene has no verdict for want of one. */
let [away, unjudged] = [false, false];
/** The last thing sent to the run, to know whose error comes back. @type {'kick' | 'set' | 'other'} */
let lastSent = 'other';

const run = new Run({
  changed: showRun,
  struck: () => {
    for (const plot of plots) invalidate(plot);
    acts?.struck();
    view.redraw();
  },
  cleared: () => {
    for (const plot of plots) plot.clear();
    acts?.cleared();
    view.reset();
  },
  lost: (seconds) => {
    connectionNotice(seconds, () => run.retry());
    if (!Number.isNaN(seconds)) away = true;
    else if (away) back();
  },
  refused: (problem) => {
    clearNotice('connection');
    const homeless = form?.blame(problem.errors) ?? [];
    notice(
      'run',
      [
        h('strong', {}, 'The server did not take this run. '),
        problem.message,
        homeless.length > 0 ? ` ${homeless.join(' ')}` : '',
        ' Its scene is kept; Run releases it anew.',
      ],
      { caution: true },
    );
    address();
  },
  problem: ({ title, detail, errors }) => {
    const homeless =
      form?.blame(errors.filter(({ pointer }) => fields.some((field) => field.path === pathOf(pointer)))) ?? [];
    const others = [
      ...homeless,
      ...errors
        .filter(({ pointer }) => !fields.some((field) => field.path === pathOf(pointer)))
        .map((error) => error.detail),
    ];
    const words = others.join(' ') || (errors.length > 0 ? '' : detail || title);
    if (lastSent === 'kick') controls.blameKick(words || detail);
    else if (words) notice('message', [words], { caution: true });
  },
});
const view = new SceneView(byId('scene-frame'), byId('scene-readout'), run);
const plots = [
  anglePlane(run.impacts),
  velocityPlane(run.impacts),
  energyPlot(run.impacts, () => run.scene ?? form?.read().scene ?? null),
];
const circle = new Circle();
const verdict = new Verdict(byId('verdict'));
const controls = new Controls(byId('controls'), {
  toggle,
  step: () => {
    lastSent = 'other';
    run.step();
  },
  restart,
  speed: setSpeed,
  gain: (value, final) => {
    form?.put(GAIN, value);
    edited(GAIN, final);
  },
  kick: (velocities) => {
    lastSent = 'kick';
    run.kick(velocities);
  },
});
byId('impacts-bar').before(
  plots[0].figure.element,
  plots[1].figure.element,
  circle.figure.element,
  plots[2].figure.element,
);
for (const one of [...plots, circle]) one.figure.offer(() => savesOf(one.figure.id, one.figure.title, one));
const sceneCard = /** @type {HTMLElement} */ (byId('scene-frame').closest('.card'));
sceneCard.querySelector('.card-head')?.append(enlarger(sceneCard, 'Scene', () => savesOf('scene', 'Scene', view)));

/** What is typed, as a query; null while some of it is no value. */
function typedQuery() {
  const read = form?.read();
  return read?.complete ? sceneQuery(read.scene, chosen, fields) : null;
}

/** What the plots show, as a query: the run with what was done to it, else what is typed. */
function playedQuery() {
  if (!run.released) return typedQuery();
  const query = sceneQuery(run.released, chosen, fields);
  for (const [key, value] of run.query) if (key.startsWith('interventions.')) query.set(key, value);
  return query;
}

/** The call that gives the impacts of the plots. */
function impactsPath() {
  const query = playedQuery();
  return query && `v1/trajectories?${query}&impacts=${Math.min(MOST_IMPACTS, run.impacts.last?.n ?? 100)}`;
}

/**
 * @param {string} id
 * @param {string} title
 * @param {import('./export/capture.js').Layered} view
 * @returns {import('./export/save-actions.js').Saves}
 */
function savesOf(id, title, view) {
  addressNow();
  const query = playedQuery();
  return {
    id,
    title,
    view,
    formats: ['csv', 'json'],
    path: id === 'circle' ? query && `v1/stability?${typedQuery() ?? query}` : impactsPath(),
  };
}

/** Fields whose typed value the run does not play. */
function unplayed() {
  const typed = form?.read().scene;
  const { asked } = run;
  if (!typed || !asked) return [];
  // What was left open at the release the server has filled in.
  const open = (/** @type {Field} */ { path }) =>
    [typed, releasedAs].every((scene) => valueAt(scene, path) === undefined) &&
    same(valueAt(asked, path), valueAt(run.released ?? {}, path));
  return fields.filter((field) => !same(playedAt(typed, field), playedAt(asked, field)) && !open(field));
}

/** The page's address says what is shown: the run while there is one, else what is typed. */
function addressNow() {
  const query = run.released ? sceneQuery(run.released, chosen, fields) : typedQuery();
  if (!query) return;
  if (run.released) {
    // The server spells the scene out; the name of the case says it shorter and for people.
    for (const [key, value] of run.query) if (key !== 'preset' && !key.startsWith('scene.')) query.set(key, value);
  } else if (speed !== 1) query.set('speed', String(speed));
  for (const [key, value] of panels?.query() ?? panelLink) query.set(key, value);
  history.replaceState(null, '', `?${query}`);
  panels?.played();
}
const address = settled(150, addressNow);

/** @type {AbortController | null} */
let asking = null;
const askSoon = settled(120, async () => {
  asking?.abort();
  const query = typedQuery();
  if (!query) return verdict.fail('A parameter is not a number; it is marked below.');
  const mine = (asking = new AbortController());
  try {
    const answer = await get(`v1/stability?${query}`, mine.signal);
    unjudged = false;
    form?.blame([]);
    verdict.show(answer, () => get(`v1/stability?${query}&basin=true`, mine.signal));
    circle.show(answer);
    judged = { answer, scene: query };
    panels?.judged(judged);
    byId('build').textContent = server.build;
  } catch (error) {
    if (mine.signal.aborted) return;
    circle.show(null);
    unjudged = !(error instanceof Problem);
    if (error instanceof Problem && error.errors.length > 0) {
      const homeless = form?.blame(error.errors) ?? [];
      verdict.fail(
        homeless.length > 0
          ? homeless.join(' ')
          : 'The server does not take this scene; the parameter is marked below.',
      );
    } else {
      verdict.fail(error instanceof Problem ? error.message : 'The server does not answer.', ask);
    }
  }
});

/** What stands there is out of date from now on, and asked for anew once typing has paused. */
function ask() {
  verdict.busy(true);
  askSoon();
}

/** Sends the live parameters that the run does not play yet; some make sense only together. */
const sendChanges = settled(100, () => {
  const typed = form?.read().scene;
  if (!typed || !run.active) return;
  // One law for another is no change of a value: it is for a restart.
  const swapped = Boolean(typed.table?.feedback) !== Boolean(run.asked?.table?.feedback);
  const changes = Object.fromEntries(
    unplayed()
      .filter(({ live, path }) => live && !(swapped && /^table\.(tilt_gain$|feedback)/.test(path)))
      .map((field) => [field.path, playedAt(typed, field)])
      .filter(([, value]) => value !== undefined),
  );
  if (Object.keys(changes).length === 0) return;
  lastSent = 'set';
  run.set(changes);
});

/** The server is there again: what it has missed is made up for. */
function back() {
  away = false;
  if (unjudged) ask();
  sendChanges();
}

/**
 * @param {string} path
 * @param {boolean} final
 */
function edited(path, final) {
  const scene = form?.read().scene ?? {};
  const value = valueAt(scene, path);
  if (path === GAIN && typeof value === 'number') {
    controls.setGain(value);
    circle.preview(value);
  }
  if (final && run.active && fields.find((field) => field.path === path)?.live) sendChanges();
  nameScene();
  view.draft(scene);
  plots[2].redraw();
  panels?.sceneChanged();
  ask();
  if (run.phase === 'idle') address();
  else showRun();
}

function start() {
  const query = typedQuery();
  if (!query || !form) {
    form?.complain();
    return form?.focusError();
  }
  query.set('speed', String(speed));
  releasedAs = form.read().scene;
  clearNotice('run');
  lastSent = 'other';
  run.start(query);
}

function toggle() {
  lastSent = 'other';
  if (run.phase === 'idle' || run.phase === 'ended') start();
  else if (run.active) run.toggle();
}

/** From the release again, with what is typed now. */
function restart() {
  lastSent = 'other';
  if (run.phase === 'idle') return;
  if (!run.active || unplayed().length > 0) start();
  else run.restart();
}

/** @param {number} value */
function setSpeed(value) {
  speed = value;
  controls.setSpeed(value);
  lastSent = 'other';
  if (run.active) run.setSpeed(value);
  else address();
}

function showRun() {
  const { phase, outcome } = run;
  const words = run.words || 'Ready';
  const state = byId('run-state');
  if (state.textContent !== words) state.textContent = words;
  state.dataset.phase = phase;
  const told = byId('outcome');
  told.hidden = phase !== 'ended' && run.impacts.missing === 0;
  told.replaceChildren(
    ...(phase === 'ended'
      ? prose(sentence(outcome?.detail ?? ''))
      : [`${run.impacts.missing} impacts were skipped over.`]),
  );
  controls.show(phase, run.phase !== 'idle' && unplayed().length > 0, form !== null);
  if (run.active) {
    speed = run.clock.speed || speed;
    controls.setSpeed(speed);
    address();
  }
  view.redraw();
}

/** @param {string} words */
const sentence = (words) => words.slice(0, 1).toUpperCase() + words.slice(1);

/** Where nothing can be set low: in an option, in the window's title. @param {string} text */
const plain = (text) => text.replaceAll('κ_', 'κ');

/** The case that a scene is, if it is one. @param {Scene} scene */
const caseOf = (scene) =>
  cases.find((one) => fields.every((field) => same(playedAt(one.scene, field), playedAt(scene, field)))) ?? null;

/** Says which case the typed scene is, or what of it is another. */
function nameScene() {
  const typed = form?.read().scene ?? {};
  const one = chosen;
  const other = one ? fields.filter((field) => !same(playedAt(typed, field), playedAt(one.scene, field))) : [];
  const shows = byId('case-shows');
  chooser.value = one?.name ?? '';
  document.title = one ? `${plain(one.title)}${other.length > 0 ? ', changed' : ''} · equipoise` : 'equipoise';
  const named = other
    .slice(0, 3)
    .map(({ title }) => title.toLowerCase())
    .join(', ');
  const words =
    other.length > 0
      ? `Changed from the case: ${named}${other.length > 3 ? ` and ${other.length - 3} more` : ''}. `
      : (one?.shows ?? 'A scene of your own.');
  // A button that is being pressed has to stay.
  if (shows.dataset.words === words) return;
  shows.dataset.words = words;
  shows.replaceChildren(
    ...prose(words),
    one && other.length > 0
      ? h(
          'button',
          {
            type: 'button',
            id: 'case-back',
            click: () => {
              if (chosen) choose(chosen);
            },
          },
          'Back to the case',
        )
      : '',
  );
}

/** Shows a scene without running it. @param {Scene} scene */
function present(scene) {
  form?.fill(scene);
  controls.setGain(valueAt(scene, GAIN) ?? null);
  controls.setSpeed(speed);
  nameScene();
  plots[2].redraw();
  view.draft(scene);
  panels?.sceneChanged();
  ask();
}

/** Releases what is typed with these values in it; the way back leads to the run before. @param {Record<string, number>} values */
function launch(values) {
  addressNow();
  history.pushState(null, '', location.href);
  for (const [path, value] of Object.entries(values)) form?.put(path, value);
  run.reset();
  const scene = form?.read().scene ?? {};
  controls.setGain(valueAt(scene, GAIN) ?? null);
  circle.preview(valueAt(scene, GAIN) ?? null);
  nameScene();
  view.draft(scene);
  panels?.sceneChanged();
  ask();
  start();
}

/** Shows a scene from further below and runs it. @param {Scene} scene */
function play(scene) {
  chosen = caseOf(scene);
  history.pushState(
    null,
    '',
    `?${new URLSearchParams([...sceneQuery(scene, chosen, fields), ...(panels?.query() ?? panelLink)])}`,
  );
  run.reset();
  present(scene);
  start();
  chooser.focus({ preventScroll: true });
  scrollTo(0, 0);
}

/** @param {string} kind @param {string[]} dropped */
function notWhole(kind, dropped) {
  notice(
    kind,
    [
      h('strong', {}, 'This link was not whole. '),
      'Dropped: ',
      h('ul', {}, ...dropped.map((what) => h('li', {}, what))),
    ],
    { caution: true },
  );
}

/** @param {string} search */
function restore(search) {
  const link = readLink(search, fields, cases);
  const bare = link.preset === null && Object.keys(link.changes).length === 0;
  chosen = cases.find((one) => one.name === (bare ? cases[0]?.name : link.preset)) ?? caseOf(link.changes);
  speed = link.speed;
  run.reset();
  panelLink = link.panels;
  panels?.restore(panelLink);
  if (link.dropped.length > 0) notWhole('link', link.dropped);
  else clearNotice('link');
  const scene = merged(chosen?.scene ?? {}, link.changes);
  if (!link.run) return present(scene);
  const query = sceneQuery(scene, chosen, fields);
  for (const [key, value] of link.run) query.set(key, value);
  query.set('speed', String(speed));
  for (const { set } of interventionsOf(link.run))
    for (const [path, value] of Object.entries(set)) setAt(scene, path, value);
  present(scene);
  releasedAs = form?.read().scene ?? {};
  run.start(query);
}

/** @param {Case} one */
function choose(one) {
  const going = run.phase !== 'idle';
  chosen = one;
  history.pushState(null, '', `?${new URLSearchParams([['preset', one.name], ...(panels?.query() ?? panelLink)])}`);
  run.reset();
  present(one.scene);
  if (going) start();
}

async function begin() {
  try {
    const [table, list] = await Promise.all([get('v1/fields'), get('v1/scenes')]);
    clearNotice('server');
    fields = fieldsOf(table);
    cases = list.scenes;
  } catch {
    verdict.fail('The server does not answer.');
    return notice(
      'server',
      ['The server does not answer. ', h('button', { type: 'button', click: begin }, 'Try again')],
      { dismissible: false, caution: true },
    );
  }
  const root = byId('parameters');
  root.replaceChildren();
  form = new Form(root, fields, edited);
  controls.knowGain(fields.find((field) => field.path === GAIN) ?? null);
  chooser.replaceChildren(
    h('option', { value: '', hidden: true }, 'A scene of your own'),
    ...cases.map(({ name, title }) => h('option', { value: name }, plain(title))),
  );
  chooser.disabled = false;
  chooser.addEventListener('change', () => {
    const one = cases.find(({ name }) => name === chooser.value);
    if (one) choose(one);
  });
  byId('build').textContent = server.build;
  restore(location.search);
  showRun();
  // The plots of the first look are drawn in the next frame; what nobody sees yet comes after.
  await new Promise((resolve) => requestAnimationFrame(resolve));
  performance.mark('first plot');
  const late = await Promise.all([
    import('./panels/panels.js'),
    import('./app/keys.js'),
    import('./charts/impacts/plot-interaction.js'),
  ]).catch(() => null);
  // A browser remembers a module that it did not get, so that only a fresh page gets it.
  if (!late)
    return notice(
      'server',
      [
        'Part of the page did not load. ',
        h('button', { type: 'button', click: () => location.reload() }, 'Load it again'),
      ],
      { caution: true },
    );
  const [{ Panels }, { listenToKeys }, { Acts }] = late;
  listenToKeys(KEYS);
  panels = new Panels(
    byId('main'),
    {
      fields,
      query: typedQuery,
      scene: () => form?.read().scene ?? {},
      chosen: () => chosen,
      played: playedQuery,
      launch,
      play,
      changed: address,
    },
    (id, dropped) => (dropped.length > 0 ? notWhole(`link-${id}`, dropped) : clearNotice(`link-${id}`)),
  );
  acts = new Acts(byId('impacts-bar'), {
    run,
    view,
    plots,
    typed: () => {
      const read = form?.read();
      return read?.complete ? read.scene : null;
    },
    fields,
    launch,
    changed: address,
  });
  panels.join('brush', acts);
  panels.restore(panelLink);
  if (judged) panels.judged(judged);
}

byId('share').addEventListener('click', (event) => {
  addressNow();
  void copy(/** @type {HTMLElement} */ (event.currentTarget), location.href);
});
addEventListener('popstate', () => restore(location.search));
/** The focus to the first control of a panel, which may only come now. @param {HTMLElement} body */
async function focusIn(body) {
  const first = () => /** @type {HTMLElement | null} */ (body.querySelector('input, select, button'));
  while (!first())
    await new Promise((resolve) =>
      new MutationObserver((_, observer) => {
        observer.disconnect();
        resolve(null);
      }).observe(body, { childList: true, subtree: true }),
    );
  first()?.focus({ preventScroll: true });
}

/** @type {import('./app/keys.js').Key[]} */
const KEYS = [
  { keys: [' '], label: 'Space', name: 'Run, pause, resume', act: toggle },
  {
    keys: ['.'],
    label: '.',
    name: 'Stop at the next strike',
    act: () => {
      if (run.active) run.step();
    },
  },
  { keys: ['r'], label: 'r', name: 'Restart from the release', act: restart },
  {
    keys: ['k'],
    label: 'k',
    name: 'Kick',
    act: () => {
      if (run.active) controls.kick();
    },
  },
  {
    keys: ['1', '2', '3', '4', '5'],
    label: '1 – 5',
    name: 'Cases 1 to 5 of the paper',
    act: (key) => {
      const one = cases.find(({ name }) => name === `case-${key}`);
      if (one) choose(one);
    },
  },
  {
    keys: ['[', ']'],
    label: '[ ]',
    name: 'Slower, faster',
    act: (key) =>
      setSpeed((key === '[' ? SPEEDS.findLast((one) => one < speed) : SPEEDS.find((one) => one > speed)) ?? speed),
  },
  {
    keys: ['m'],
    label: 'm',
    name: 'Go to the stability map',
    act: () => {
      byId('map').scrollIntoView();
      void focusIn(byId('map-body'));
    },
  },
  { keys: ['s'], label: 's', name: 'Copy the link', act: () => byId('share').click() },
  {
    keys: ['e'],
    label: 'e',
    name: 'Save the impacts as CSV',
    act: () => {
      const path = impactsPath();
      if (path) h('a', { href: `${path}&format=csv`, download: 'equipoise-impacts.csv' }).click();
    },
  },
];
showRun();
void begin();
