// Parts of panels and steps as components: words, tables, fields and charts.

import { copy } from '../dom/clipboard.js';
import { commits, withholdPress } from '../dom/number-input.js';
import { parse, read } from '../dom/typed-number.js';
import { capitalized, marked, prose, symbol } from '../dom/typeset.js';
import { angles, shownUnit, shownValue } from '../dom/units.js';
import { html, useEffect, useLayoutEffect, useRef, useState } from '../vendor/preact/preact.js';

/** A child of a component: an element, text, or nothing. @typedef {unknown} Child */

/** Something that tells its changes by events; whoever uses it is drawn anew with each. @template {EventTarget} T @param {T} source @returns {T} */
export function useChanges(source) {
  const [, again] = useState({});
  useEffect(() => {
    const changed = () => again({});
    source.addEventListener('change', changed);
    return () => source.removeEventListener('change', changed);
  }, []);
  return source;
}

/** Told where the scene of the page is not whole. */
export const NO_SCENE = 'A parameter of the scene is not a number; it is marked among them.';

/** A typeset word as a child. @param {Node | string} node @returns {Child} */
const child = (node) =>
  node instanceof Element
    ? html`<${node.localName} class=${node.className || null}>${[...node.childNodes].map(child)}<//>`
    : typeof node === 'string'
      ? node
      : node.textContent;

/** The server's words with symbols and minus signs set as such. @param {string} text */
export const words = (text) => marked(text).map(child);

/** The same with numbers no longer than one reads. @param {string} text */
export const brief = (text) => prose(text).map(child);

/** A sentence of the server, `brief` unless its numbers stand in full. @param {string} text @param {(text: string) => Child} [set] */
export const sentence = (text, set = brief) => {
  // A symbol has no capital at the beginning.
  const begun = /^(?:[a-z]{2}|a )/.test(text) ? capitalized(text) : text;
  return set(/[.!?]$/.test(begun) ? begun : `${begun}.`);
};

/** A symbol in italics. @param {string} text as in `κ_c` */
export const sign = (text) => child(symbol(text));

/** Signs of results, which show them without colour; the last ones are of a run. */
const SIGNS = { stable: '●', beyond: '◆', unstable: '▲', none: '–', kept: '●', fell: '▲', played: '●' };
/** @typedef {keyof typeof SIGNS} Tone */

/** A result in its tone. @param {{result: NonNullable<Result>, tag?: string, kind?: string}} props */
export const Told = ({ result: { tone, words: said }, tag = 'span', kind = '' }) =>
  html`<${tag} class=${`told ${tone} ${kind}`}><span class="sign" aria-hidden="true">${SIGNS[tone]}</span> ${said}<//>`;

/** A result as a headline. @param {{result: NonNullable<Result>}} props */
export const Headline = ({ result }) => html`<${Told} result=${result} tag="p" kind="headline" />`;

/** Quiet before a result is spoken, ms: nobody hears each turn of a knob. */
const SPOKEN_MS = 1000;

/** Speaks words once they stay. @param {{words: string}} props */
export function Spoken({ words: told }) {
  const [said, say] = useState('');
  useEffect(() => {
    const timer = setTimeout(() => say(told), SPOKEN_MS);
    return () => clearTimeout(timer);
  }, [told]);
  return html`<p class="unseen" role="status">${said}</p>`;
}

/** A table of numbers in a box that scrolls. @param {{label: string, head: Child[], kind?: string, children: Child}} props rows as children */
export const Table = ({ label, head, kind, children }) =>
  html`<div class="table-box" tabindex="0" role="region" aria-label=${label}>
    <table class=${kind}>
      <thead><tr>${head.map((one) => html`<th scope="col">${typeof one === 'string' ? shownUnit(one) : one}</th>`)}</tr></thead>
      <tbody>${children}</tbody>
    </table>
  </div>`;

/** A row of a table, its name first. @param {{cells: Child[], kind?: string}} props */
export const Row = ({ cells: [name, ...cells], kind }) =>
  html`<tr class=${kind}><th scope="row">${name}</th>${cells.map((cell) => html`<td>${cell}</td>`)}</tr>`;

/** Named numbers with their meaning. @param {{rows: Child[][], id?: string, kind?: string}} props */
export const Numbers = ({ rows, id, kind = '' }) =>
  html`<dl class=${`numbers ${kind}`} id=${id}>
    ${rows.map(([name, value, meaning]) => html`<div><dt>${name}</dt><dd>${value}</dd><dd class="muted">${meaning}</dd></div>`)}
  </dl>`;

/**
 * Bars and marks on a line.
 * @param {object} props
 * @param {number} props.low
 * @param {number} props.high
 * @param {[from: number, to: number, kind: string][]} [props.bars]
 * @param {[at: number, kind: string][]} props.marks
 * @param {string} [props.label] for those who do not see it, where words beside it do not say the same
 * @param {string} [props.kind]
 */
export function Scale({ low, high, bars = [], marks, label, kind = '' }) {
  const at = (/** @type {number} */ one) =>
    `${(100 * Math.max(0, Math.min(1, (one - low) / (high - low)))).toFixed(2)}%`;
  return html`<span class=${`scale ${kind}`} role=${label && 'img'} aria-label=${label} aria-hidden=${label ? undefined : 'true'}>
    ${bars.map(([from, to, of]) => html`<span class=${`scale-bar ${of}`} style=${{ left: at(from), right: `calc(100% - ${at(to)})` }} />`)}
    ${marks.map(([place, of]) => html`<span class=${`scale-mark ${of}`} style=${{ left: at(place) }} />`)}
  </span>`;
}

/** Fields with a button that asks. @param {{ask: () => void, kind?: string, children: Child}} props */
export const Form = ({ ask, kind = 'study-form row', children }) => {
  const submit = (/** @type {Event} */ event) => {
    event.preventDefault();
    ask();
  };
  return html`<form class=${kind} novalidate onSubmit=${submit}>${children}</form>`;
};

/** A button that asks for a file; `field` is the id of its input. @param {{id: string, field: string, accept: string, taken: (file: File) => void, children: Child}} props */
export function FileButton({ id, field, accept, taken, children }) {
  const input = useRef(/** @type {HTMLInputElement | null} */ (null));
  const take = (/** @type {Event} */ event) => {
    const chosen = /** @type {HTMLInputElement} */ (event.currentTarget);
    if (chosen.files?.[0]) taken(chosen.files[0]);
    // The same file can be chosen again.
    chosen.value = '';
  };
  return html`<button type="button" id=${id} onClick=${() => input.current?.click()}>${children}</button>
    <input type="file" id=${field} accept=${accept} hidden ref=${input} onChange=${take} />`;
}

/** True while an element is in sight or nearly so. @returns {[place: {current: HTMLElement | null}, near: boolean]} */
export function useNear() {
  const place = useRef(/** @type {HTMLElement | null} */ (null));
  const [near, approach] = useState(false);
  useLayoutEffect(() => {
    const watch = new IntersectionObserver((entries) => approach(entries[entries.length - 1].isIntersecting), {
      rootMargin: '100px 0px',
    });
    if (place.current) watch.observe(place.current);
    return () => watch.disconnect();
  }, []);
  return [place, near];
}

/** Keeps the focus among buttons: one that is drawn as disabled loses it. @param {{current: HTMLElement | null}} place of the buttons */
export function useKeptFocus(place) {
  const focused = document.activeElement;
  useLayoutEffect(() => {
    if (focused instanceof HTMLButtonElement && focused.disabled && place.current?.contains(focused))
      /** @type {HTMLElement | null} */ (place.current.querySelector('button:enabled'))?.focus();
  });
}

/** Parts that fold. @param {{title: Child, children: Child}} props */
export const Folded = ({ title, children }) => html`<details><summary>${title}</summary>${children}</details>`;

/** Code with a button that copies it. @param {{title: string, code: string, copier?: string, about?: string, open?: string}} props */
export const Code = ({ title, code, copier = 'Copy', about, open }) => html`<div class="call">
  <h3>${title}</h3>
  ${about && html`<p class="muted">${about}</p>`}
  <pre tabindex="0" role="region" aria-label=${title}><code>${code}</code></pre>
  <p class="actions">
    <button type="button" aria-label=${`${copier}: ${title}`} onClick=${(/** @type {Event} */ event) => void copy(/** @type {HTMLElement} */ (event.currentTarget), code)}>${copier}</button>
    ${open && html`<a href=${open} aria-label=${`Open: ${title}`}>Open</a>`}
  </p>
</div>`;

/**
 * @typedef {object} NumberProps
 * @property {string} id
 * @property {string} [label] for a field without a label beside it
 * @property {string} [unit] of the value; angles are shown as the page shows them
 * @property {number | undefined} value in SI units; undefined for an empty field
 * @property {string} [placeholder]
 * @property {boolean} [open] may be left empty
 * @property {boolean} [disabled]
 * @property {number} [digits] that are shown of a value
 * @property {(value: number) => string | null} [fault] reason to refuse a value
 * @property {string} [blame] words on the value that stands
 * @property {(value: number | undefined) => void} changed
 */

/** A field for a number with its unit, and the reason why an entry was refused. @param {NumberProps} props */
export function NumberField(props) {
  const { id, label, unit = '', value, placeholder, disabled, digits = 6, blame = '', changed } = props;
  const now = useRef(props);
  now.current = props;
  const own = () => now.current.unit || null;
  const input = useRef(/** @type {any} */ (null));
  const error = useRef(/** @type {any} */ (null));
  useLayoutEffect(() => {
    const element = input.current;
    const judge = (/** @type {string} */ text) => {
      if (text.trim() === '' && now.current.open) return {};
      const { value: typed, problem } = read(text, own());
      if (typed === undefined) return { problem };
      const wrong = now.current.fault?.(typed);
      return wrong ? { problem: wrong } : { text: String(Number(shownValue(typed, own()).toPrecision(12))) };
    };
    // The server's words on the value before are void; taken away later they would move a button while it is pressed.
    element.addEventListener('beforeinput', () => {
      error.current.textContent = '';
      element.removeAttribute('aria-invalid');
    });
    commits(element, judge, (problem) => {
      const put = `${element.value.trim() || 'The empty field'} was put back: ${problem}`;
      error.current.textContent = problem === null ? '' : put;
      if (problem !== null) withholdPress(element);
    });
  }, []);
  useLayoutEffect(() => {
    // An entry of more digits than are shown stays as it was typed.
    if (parse(input.current.value, own()) === (value ?? null)) return;
    input.current.value = value === undefined ? '' : String(Number(shownValue(value, unit).toPrecision(digits)));
  }, [value, unit, angles()]);
  useLayoutEffect(() => {
    error.current.textContent = blame;
  }, [blame]);
  const shown = unit === '1' ? '' : shownUnit(unit);
  return html`<span class="number-field"><input type="text" inputmode="decimal" autocomplete="off" spellcheck="false"
      id=${id} aria-label=${label} aria-describedby=${`${id}-error`} aria-invalid=${blame ? 'true' : null}
      placeholder=${placeholder} disabled=${disabled} ref=${input}
      onChange=${() => changed(parse(input.current.value, own()) ?? undefined)}
    />${shown && html` <span class="unit">${shown}</span>`}<p class="error" id=${`${id}-error`} role="status" ref=${error} /></span>`;
}

/**
 * A field of choices.
 * @param {{label?: string, value: string, choices: Record<string, Child>, changed: (value: string) => void, [attribute: string]: unknown}} props
 */
export const Choice = ({ label, value, choices, changed, ...attributes }) =>
  html`<select ...${attributes} aria-label=${label} value=${value}
    onChange=${(/** @type {Event} */ { currentTarget }) => changed(/** @type {HTMLSelectElement} */ (currentTarget).value)}>
    ${Object.entries(choices).map(([name, said]) => html`<option value=${name} selected=${name === value}>${said}</option>`)}
  </select>`;
