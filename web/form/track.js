// A slider on a track that shows what is known of its values: a mark, and a row of `/v1/regions`, which has a run of this scene at each of them.

import { idOf } from '../api/settings.js';
import { number } from '../dom/numbers.js';
import { shownFactor, shownUnit } from '../dom/units.js';
import { useAnswer } from '../panels/ask.js';
import { html } from '../vendor/preact/preact.js';

/** @typedef {import('../api/scene-fields.js').Field} Field */
/** A marked value, with its label and its words. @typedef {{at: number, label: unknown, words: string}} Mark */
/** Outcomes of runs: true for one that survives, null where there is no such scene. @typedef {(boolean | null)[]} Outcomes */

/** Cells of a row. */
const CELLS = 96;
/** Bounces of each run: few, so that the map is there at once. */
const BOUNCES = 500;
/** Wait after a change of the scene, ms. */
const QUIET_MS = 250;
/** A field that every scene has, for the axis that stands still. */
const STILL = 'gravity';
/** Ranges that the words name. */
const TOLD = 4;

/** The request for a map. @param {import('./typed-scene.js').TypedScene} typed @param {Field} field @param {[number, number]} ends in the unit that the page shows @param {string} scene */
function requestOf(typed, { field: path, unit }, [from, to], scene) {
  const query = new URLSearchParams(scene);
  const factor = shownFactor(unit);
  // The scene's own value of the field does not matter: the same map serves all of them.
  query.set(`scene.${path}`, String(from / factor));
  const gravity = typed.fields.find(({ field }) => field === STILL);
  const still = gravity && (typed.value(gravity) ?? gravity.default);
  const axes = { x: [path, from / factor, to / factor, CELLS], y: [STILL, still, still, 1] };
  for (const [axis, values] of Object.entries(axes))
    for (const [index, part] of ['field', 'from', 'to', 'count'].entries())
      query.set(`${axis}.${part}`, String(values[index]));
  query.set('bounces', String(BOUNCES));
  return `v1/regions?${query}`;
}

/** The ends of the map that a request is for. @param {string | null} request */
const endsOf = (request) => /x\.from=[^&]*&x\.to=[^&]*/.exec(request ?? '')?.[0];

/** The outcomes of a map; those of the scene before until they are there. @param {string | null} request @returns {Outcomes | null} */
function useOutcomes(request) {
  const { answer, of, problem } = useAnswer(request, QUIET_MS);
  // A scene without such runs has no map.
  if (!answer || !request || problem || endsOf(of) !== endsOf(request)) return null;
  const none = answer.outcome_names.indexOf('none');
  return answer.values[0].map((/** @type {number | null} */ contacts, /** @type {number} */ cell) =>
    answer.outcomes[0][cell] === none || contacts === null ? null : contacts >= BOUNCES,
  );
}

/** Neighbours of the same outcome. @param {Outcomes} outcomes */
function runsOf(outcomes) {
  /** @type {{kind: boolean | null, first: number, count: number}[]} */
  const runs = [];
  for (const [first, kind] of outcomes.entries()) {
    const last = runs.at(-1);
    if (last?.kind === kind) last.count += 1;
    else runs.push({ kind, first, count: 1 });
  }
  return runs;
}

/** The map in words. @param {Field} field @param {[number, number]} ends @param {ReturnType<typeof runsOf>} runs */
function wordsOf({ title, unit }, [from, to], runs) {
  const at = (/** @type {number} */ cell) => number(from + ((to - from) * cell) / (CELLS - 1), 3);
  const ranges = runs
    .filter(({ kind }) => kind)
    .map(({ first, count }) => (count === 1 ? at(first) : `${at(first)} to ${at(first + count - 1)}`));
  if (ranges.length === 0) return `No run lasts ${BOUNCES} bounces on this track.`;
  const more = ranges.length > TOLD ? [`${ranges.length - TOLD} more`] : [];
  const told = [...ranges.slice(0, TOLD), ...more].join(', ');
  const printed = unit === '1' || unit === null ? '' : ` ${shownUnit(unit)}`;
  return `Runs last ${BOUNCES} bounces with ${title.toLowerCase()} ${told}${printed}; hatched values fall.`;
}

/**
 * @param {object} props
 * @param {{typed: import('./typed-scene.js').TypedScene, reset: (field: Field) => void}} props.form
 * @param {Field} props.field
 * @param {[number, number]} props.ends
 * @param {Mark | null} [props.mark] in the slider's numbers
 * @param {string | null} [props.scene] the query of the scene, for a field with a map
 * @param {boolean} props.hollow the field has no value
 * @param {unknown} props.children the slider
 */
export function Track({ form, field, ends, mark, scene, hollow, children }) {
  const [from, to] = ends;
  const outcomes = useOutcomes(scene ? requestOf(form.typed, field, ends, scene) : null);
  const runs = outcomes && runsOf(outcomes);
  const seen = mark && mark.at >= from && mark.at <= to ? mark : null;
  const words = [seen?.words, runs && wordsOf(field, ends, runs)].filter(Boolean).join(' ');
  return html`<span class=${`track ${hollow ? 'hollow' : ''} ${runs ? 'known' : ''}`} onDblClick=${() => form.reset(field)}>
    <span class="track-map" aria-hidden="true" hidden=${!runs}>
      ${runs?.map(
        ({ kind, count }) =>
          html`<span class=${kind === null ? 'none' : kind ? 'survives' : 'falls'} style=${{ flexGrow: count }} />`,
      )}
    </span>
    <span class="track-rail" aria-hidden="true" />
    <span class="track-mark" aria-hidden="true" hidden=${!seen}
      style=${{ '--at': seen ? (seen.at - from) / (to - from) : 0 }}>
      <span>${seen?.label}</span>
    </span>
    ${children}
    <span class="unseen" id=${`${idOf(field)}-slider-track`}>${words}</span>
  </span>`;
}
