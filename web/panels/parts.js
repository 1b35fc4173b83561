// Parts of panels and steps as components: words, tables, fields and charts.

import { copy } from '../dom/clipboard.js';
import { byId, h } from '../dom/elements.js';
import { numberInput, takeNumbers } from '../dom/number-input.js';
import { parse } from '../dom/typed-number.js';
import { capitalized, inWords, marked, prose, symbol } from '../dom/typeset.js';
import { angles, shownUnit, shownValue } from '../dom/units.js';
import { html, useLayoutEffect, useMemo, useRef } from '../vendor/preact/preact.js';

/** A child of a component: an element, text, or nothing. @typedef {unknown} Child */

/** Told where the scene of the page is not whole. */
export const NO_SCENE = 'A parameter of the scene is not a number; it is marked among them.';

/** Nodes of the page as children. @param {{nodes: (Node | string)[], tag?: string, class?: string, id?: string}} props */
export function Nodes({ nodes, tag = 'span', ...rest }) {
  const place = useRef(/** @type {HTMLElement | null} */ (null));
  useLayoutEffect(() => place.current?.replaceChildren(...nodes), nodes);
  return html`<${tag} ...${rest} ref=${place} />`;
}

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

/** The same as a sentence, its numbers no longer than one reads. @param {string} text */
export const sentence = (text) => {
  // A symbol has no capital at the beginning.
  const begun = /^[a-z]/.test(text) ? capitalized(text) : text;
  return brief(/[.!?]$/.test(begun) ? begun : `${begun}.`);
};

/** A symbol in italics. @param {string} text as in `κ_c` */
export const sign = (text) => child(symbol(text));

/** Signs of results, which show them without colour. */
export const SIGNS = { stable: '●', beyond: '◆', unstable: '▲', none: '–' };
/** @typedef {keyof typeof SIGNS} Tone */
/** A result in a line. @typedef {{tone: Tone, words: string} | null} Result */

/** A result in its tone. @param {{result: NonNullable<Result>}} props */
export const Told = ({ result: { tone, words: said } }) =>
  html`<span class=${`told ${tone}`}><span class="sign" aria-hidden="true">${SIGNS[tone]}</span> ${said}</span>`;

/**
 * A table of numbers in a box that scrolls.
 * @param {{label: string, head: Child[], kind?: string, children: Child}} props rows as children
 */
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

/** Fields with a button that asks. @param {{ask: () => void, children: Child}} props */
export const Form = ({ ask, children }) => {
  const submit = (/** @type {Event} */ event) => {
    event.preventDefault();
    ask();
  };
  return html`<form class="study-form" novalidate onSubmit=${submit}>${children}</form>`;
};

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
 * A field for a number with its unit.
 * @param {object} props
 * @param {string} props.id
 * @param {string} [props.label] for a field without a label beside it
 * @param {string} [props.unit] of the value; angles are shown as the page shows them
 * @param {number | undefined} props.value
 * @param {string} [props.placeholder]
 * @param {boolean} [props.open] may be left empty
 * @param {(value: number) => string | null} [props.fault] reason to refuse a value
 * @param {string} [props.blame] words on the value that stands
 * @param {(value: number | undefined) => void} props.changed
 */
export function NumberField({
  id,
  label,
  unit = '',
  value,
  placeholder = '',
  open = false,
  fault,
  blame = '',
  changed,
}) {
  const now = useRef({ changed, unit, fault });
  now.current = { changed, unit, fault };
  const parts = useMemo(() => {
    const error = h('p', { class: 'error', id: `${id}-error` });
    const own = () => now.current.unit || null;
    const input = numberInput(
      { id, 'aria-label': label, change: () => now.current.changed(parse(input.value, own()) ?? undefined) },
      error,
      { unit: own, open, fault: (typed) => now.current.fault?.(typed) ?? null },
    );
    return { input, error };
  }, []);
  const text = value === undefined ? '' : String(Number(shownValue(value, unit).toPrecision(6)));
  useLayoutEffect(() => {
    parts.input.placeholder = placeholder;
    parts.input.value = text;
  }, [text, placeholder, unit]);
  useLayoutEffect(() => {
    parts.error.textContent = blame;
    if (blame) parts.input.setAttribute('aria-invalid', 'true');
    else parts.input.removeAttribute('aria-invalid');
  }, [blame]);
  const shown = unit === '1' ? '' : shownUnit(unit);
  return html`<span class="number-field"><${Nodes} nodes=${[parts.input]} />${shown && html` <span class="unit">${shown}</span>`}<${Nodes} nodes=${[parts.error]} /></span>`;
}

/**
 * A field of choices.
 * @param {{id: string, label?: string, value: string, choices: Record<string, Child>, disabled?: boolean, changed: (value: string) => void}} props
 */
export const Choice = ({ id, label, value, choices, disabled, changed }) =>
  html`<select id=${id} aria-label=${label} value=${value} disabled=${disabled}
    onChange=${(/** @type {Event} */ { currentTarget }) => changed(/** @type {HTMLSelectElement} */ (currentTarget).value)}>
    ${Object.entries(choices).map(([name, said]) => html`<option value=${name} selected=${name === value}>${said}</option>`)}
  </select>`;

/** The line under fields that tells why an entry was refused: they write into it too. @param {{id: string, errors?: import('contract').ProblemError[]}} props by the server */
export function ErrorLine({ id, errors = [] }) {
  const words = errors.map(({ detail }) => inWords(detail)).join(' ');
  useLayoutEffect(() => {
    byId(id).textContent = words;
  }, [words]);
  return html`<p class="error" id=${id} role="status" />`;
}

/**
 * @typedef {object} SharedProps
 * @property {string} id
 * @property {string} error id of the line for errors
 * @property {string | null} unit of the value; null for a number without one
 * @property {number | undefined} value in SI units; undefined for an empty field
 * @property {string} [hint] stands in the empty field; a field without one may not be empty
 * @property {(value: number) => string | null} [fault] reason to refuse a value
 * @property {(value: number | undefined) => void} changed
 * @property {boolean} [blamed] the server has refused its value
 * @property {boolean} [disabled]
 */

/** A field for a number whose errors stand in a line that it shares with others. @param {SharedProps} props */
export function SharedField(props) {
  const { id, error, unit, value, hint, changed, blamed, disabled } = props;
  const now = useRef(props);
  now.current = props;
  const input = () => byId(id, HTMLInputElement);
  useLayoutEffect(
    () =>
      takeNumbers(input(), () => byId(error), {
        unit: () => now.current.unit,
        open: () => now.current.hint !== undefined,
        fault: (typed) => now.current.fault?.(typed) ?? null,
      }),
    [],
  );
  useLayoutEffect(() => {
    // An entry of more digits than are shown stays as it was typed.
    if (parse(input().value, unit) === (value ?? null)) return;
    input().value = value === undefined ? '' : String(Number(shownValue(value, unit).toPrecision(8)));
  }, [value, unit, angles()]);
  return html`<input
    type="text"
    inputmode="decimal"
    autocomplete="off"
    spellcheck="false"
    id=${id}
    aria-describedby=${error}
    aria-invalid=${blamed ? 'true' : null}
    placeholder=${hint}
    disabled=${disabled}
    onChange=${() => changed(parse(input().value, unit) ?? undefined)}
  />`;
}
