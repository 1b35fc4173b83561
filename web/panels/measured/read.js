// Measured bounces: their quantities, the file of them that the page has, read as labs write it, and its columns, which the reader may correct.
// Remarks say which lines could not be read. The file stays in this browser.

import { number } from '../../dom/numbers.js';
import { parse, unitOf } from '../../dom/typed-number.js';
import { shownFactor, shownUnit } from '../../dom/units.js';
import { html, useRef } from '../../vendor/preact/preact.js';
import { Choice, Row, Table, useChanges } from '../parts.js';
import ALL_QUANTITIES from './quantities.json' with { type: 'json' };

/** @typedef {keyof typeof QUANTITIES} Quantity */
/** Those that a fit takes. @typedef {Exclude<Quantity, 'n'>} Column */
/** Those that are compared with a run. @typedef {Exclude<Column, 'x'>} Compared */

/**
 * Symbol, unit, name, units to choose from with that of SI first, and heads of columns that mean it, in small letters without anything
 * between them.
 */
export const QUANTITIES = ALL_QUANTITIES;

const ALL = /** @type {Quantity[]} */ (Object.keys(QUANTITIES));
export const COLUMNS = /** @type {Column[]} */ (ALL.filter((quantity) => quantity !== 'n'));
export const COMPARED = /** @type {Compared[]} */ (COLUMNS.filter((quantity) => quantity !== 'x'));

/** Name and shown unit of a quantity. @param {Quantity} quantity */
export const nameOf = (quantity) => `${QUANTITIES[quantity].symbol} / ${shownUnit(QUANTITIES[quantity].unit)}`;

/** The shown value of a quantity, without its unit. @param {Quantity} quantity @param {number} value in SI units */
export const shownOf = (quantity, value) => value * shownFactor(QUANTITIES[quantity].unit);

/** @typedef {Record<Quantity, number>} Measured in SI units; what is not there is NaN */

/**
 * @typedef {object} Reading
 * @property {Measured[]} impacts
 * @property {Quantity[]} columns that there are
 * @property {boolean} numbered the numbers of the impacts are those of the file
 * @property {number[]} lines of the file, one for each impact
 * @property {string[]} remarks what was left out, in words
 */

/** A column of a file and what it is taken for. @typedef {{head: string, quantity: Quantity | null, unit: string}} Head */
/** A column that is read, with what makes SI of its numbers. @typedef {{quantity: Quantity, place: number, factor: number, head: string}} Reader */
/** The columns of a file with its impacts, or the reason why there are none. @typedef {{heads: Head[], reading: Reading | null, refusal: string}} Content */

/** Files larger than this are no table of impacts that a page can draw. */
const LIMIT_BYTES = 4_000_000;
/** More impacts than these are not drawn as diamonds. */
const LIMIT_IMPACTS = 20_000;
/** Remarks about single lines beyond these are counted only. */
const REMARKS = 8;

/** The quantity that a name means. @param {string} name */
const meant = (name) => ALL.find((quantity) => QUANTITIES[quantity].heads.includes(plain(name)));

/** @param {string} text short enough to print */
const shown = (text) => (text.length > 30 ? `${text.slice(0, 30)}…` : text);

/** A dot over a letter in words, Greek in Latin, and nothing else but letters. @param {string} name */
const plain = (name) =>
  name
    .normalize('NFD')
    .toLowerCase()
    .replaceAll('\u0307', 'dot')
    .replaceAll('θ', 'theta')
    .replaceAll('ω', 'omega')
    .replace(/[^a-z]/g, '');

/** @param {string} unit */
const plainUnit = (unit) =>
  unit
    .trim()
    .replace(/_per_/g, '/')
    .replace(/[\s·*\u202f]*s(?:⁻¹|\^?-1)$/, '/s')
    .replace(/^sec$/, 's')
    .replace(/^(?:-|1\/1)$/, '1');

/** Value of a unit in SI; null if it is none of the quantity. @param {Quantity} quantity @param {string} unit */
function sizeOf(quantity, unit) {
  const own = QUANTITIES[quantity].unit;
  if (unit === '') return 1;
  if (unit === 'rpm' && own === 'rad/s') return Math.PI / 30;
  const told = unitOf(unit);
  return told?.kind === unitOf(own)?.kind ? (told?.factor ?? null) : null;
}

/** The column that a cell of the first line names; the unit is '' where none is told. @param {string} head @returns {Head} */
function headOf(head) {
  const told =
    /^(.+?)\s*(?:[([]([^)\]]*)[)\]]|\/(.+))$/.exec(head.trim()) ??
    /^(.+?)_((?:k|c|m)?(?:s|rad|deg|m|m_per_s|rad_per_s|deg_per_s))$/.exec(head.trim());
  const [named, unit] = told ? [meant(told[1]), plainUnit(told[2] ?? told[3])] : [undefined, ''];
  const whole = meant(head);
  // A degree sign is no letter, so that a name with it is one of its own too.
  if (whole && !(named && sizeOf(named, unit) !== null)) return { head, quantity: whole, unit: '' };
  return { head, quantity: named ?? null, unit };
}

/** The cells of every line that has any. Quotes hold what is between them together, ends of lines included. @param {string} text */
function recordsOf(text) {
  const opening = text.split('\n', 20).find((one) => one.trim() !== '' && !/^\s*#/.test(one)) ?? '';
  const between = ['\t', ';', ','].find((mark) => opening.includes(mark)) ?? ',';
  const cell = new RegExp(`(?: *"((?:[^"]|"")*)")?([^${between}\\n]*)(${between}|\\n|$)`, 'g');
  const records = [];
  let [line, first] = [1, 1];
  /** @type {string[]} */
  let cells = [];
  for (const [whole, quoted = '', rest, end] of text.matchAll(cell)) {
    cells.push((quoted.replaceAll('""', '"') + rest).trim());
    line += whole.split('\n').length - 1;
    if (end === between) continue;
    if (cells.some((one) => one !== '')) records.push({ line: first, cells });
    cells = [];
    first = line;
  }
  return records;
}

/** @param {string} text @param {Head[]} [picked] the columns as the reader takes them @returns {Content} */
function read(text, picked) {
  const records = recordsOf(text.replace(/^\ufeff/, '').replace(/\r\n?/g, '\n'));
  const isRemark = (/** @type {string[]} */ [first]) => first.startsWith('#');
  const headsOf = (/** @type {string[]} */ cells) =>
    cells.map((one, place) => headOf(place === 0 ? one.replace(/^#/, '') : one));
  // A remark may name the columns, or none.
  const at = records.findIndex(({ cells }) => !isRemark(cells) || columnsOf(headsOf(cells), []).length > 0);
  if (at < 0) return { heads: [], reading: null, refusal: 'The file is empty.' };
  const { cells } = records[at];
  const heads = picked ?? headsOf(cells);
  const remarks = /** @type {string[]} */ ([]);
  const columns = columnsOf(heads, remarks);
  const rows = records.slice(at + 1).filter((one) => !isRemark(one.cells));
  const impacts = impactsOf(rows, columns, remarks);
  const refusal =
    columns.length === 0
      ? `The first line names none of the columns n, t, theta, x_dot, y_dot, theta_dot and x. It is “${shown(cells.join(' '))}”.`
      : `No line after the first has a bounce in it. ${remarks.join(' ')}`.trim();
  if (impacts.impacts.length === 0) return { heads, reading: null, refusal };
  return { heads, reading: { ...impacts, columns: columns.map(({ quantity }) => quantity), remarks }, refusal: '' };
}

/** The columns that are read; those that are left out are remarked. @param {Head[]} heads @param {string[]} remarks */
function columnsOf(heads, remarks) {
  /** @type {Reader[]} */
  const columns = [];
  for (const [place, { head, quantity, unit }] of heads.entries()) {
    if (!quantity) continue;
    const factor = sizeOf(quantity, unit);
    if (columns.some((column) => column.quantity === quantity))
      remarks.push(`The column “${shown(head)}” is left out: there is one of ${quantity} before it.`);
    else if (factor === null)
      remarks.push(`The column “${shown(head)}” is left out: “${shown(unit)}” is not known as a unit of ${quantity}.`);
    else columns.push({ quantity, place, factor, head: shown(head) });
  }
  return columns;
}

/** The impact of a line, or the reason why it is none. @param {string[]} cells @param {Reader[]} columns @returns {Measured | string} */
function impactOf(cells, columns) {
  const impact = { n: NaN, t: NaN, theta: NaN, x_dot: NaN, y_dot: NaN, theta_dot: NaN, x: NaN };
  for (const { quantity, place, factor, head } of columns) {
    const cell = cells[place] ?? '';
    if (/^(|-|–|nan|na|null)$/i.test(cell)) continue;
    const value = parse(cell, null);
    if (value === null) return `${head} is “${shown(cell)}”, which is not a number`;
    if (quantity === 'n' && !(Number.isInteger(value) && value >= 1))
      return `${head} is ${shown(cell)}, which is no number of a bounce`;
    impact[quantity] = value * factor;
  }
  const isEmpty = ALL.every((quantity) => quantity === 'n' || Number.isNaN(impact[quantity]));
  return isEmpty ? 'it has no value' : impact;
}

/** @param {{line: number, cells: string[]}[]} rows @param {Reader[]} columns @param {string[]} remarks */
function impactsOf(rows, columns, remarks) {
  /** @type {Measured[]} */
  const impacts = [];
  /** @type {number[]} */
  const lines = [];
  let bad = 0;
  for (const { line, cells } of rows) {
    const impact = impactOf(cells, columns);
    if (typeof impact === 'string') {
      bad += 1;
      if (bad <= REMARKS) remarks.push(`Line ${line} is left out: ${impact}.`);
    } else if (impacts.length === LIMIT_IMPACTS) {
      remarks.push(`Bounces from line ${line} on are left out: at most ${LIMIT_IMPACTS} are shown.`);
      break;
    } else {
      impacts.push(impact);
      lines.push(line);
    }
  }
  if (bad > REMARKS) remarks.push(`${bad - REMARKS} more lines are left out.`);
  const hasNumbers = columns.some(({ quantity }) => quantity === 'n');
  const numbered =
    hasNumbers && impacts.every(({ n }, index) => Number.isFinite(n) && (index === 0 || n > impacts[index - 1].n));
  if (hasNumbers && !numbered)
    remarks.push('The bounces are numbered by their lines: the numbers in the file do not rise from line to line.');
  if (!numbered) for (const [index, impact] of impacts.entries()) impact.n = index + 1;
  return { impacts, lines, numbered };
}

/** It tells each change by an event. */
class MeasuredFile extends EventTarget {
  name = '';
  /** Remarks about where it comes from. */
  about = '';
  /** Counts the files. */
  files = 0;
  /** @type {Content} */
  content = { heads: [], reading: null, refusal: '' };
  #text = '';

  /** A sentence on the file; '' without one. */
  get words() {
    const { reading, refusal } = this.content;
    if (reading) return `${this.name}: ${number(reading.impacts.length, 7)} bounces`;
    return refusal && `${this.name}: ${refusal}`;
  }

  /** Reads a file. @param {File} file @param {string} [about] where it comes from */
  async take(file, about = '') {
    const isLarge = file.size > LIMIT_BYTES;
    const text = isLarge ? null : await file.text().catch(() => null);
    Object.assign(this, { name: file.name, about, files: this.files + 1 });
    this.#text = text ?? '';
    const size = `The file has ${number(file.size / 1e6, 3)} MB; at most ${LIMIT_BYTES / 1e6} MB are read.`;
    const refusal = isLarge ? size : 'The file could not be read.';
    this.#show(text === null ? { heads: [], reading: null, refusal } : read(text));
  }

  /** Reads the file again. @param {Head[]} heads its columns as they are to be taken */
  pick = (heads) => this.#show(read(this.#text, heads));

  /** @param {Content} content */
  #show(content) {
    this.content = content;
    this.dispatchEvent(new Event('change'));
  }
}

/** The file of this page. */
export const measured = new MeasuredFile();

/** The same, drawn anew with each change of it. */
export const useMeasured = () => useChanges(measured);

const CHOICES = {
  '': 'not used',
  ...Object.fromEntries(ALL.map((one) => [one, `${QUANTITIES[one].symbol}, ${QUANTITIES[one].name}`])),
};
/** Columns beyond these are no table of impacts. */
const MOST = 40;
/** Columns beyond these are not named one by one. */
const NAMED = 20;

/** Units of a column, that of SI first, and the one that its head tells among them. @param {Head} head */
function unitsOf({ quantity, unit }) {
  const units = quantity ? QUANTITIES[quantity].units : [];
  return units.length === 0 || unit === '' || units.includes(unit) ? units : [...units, unit];
}

/** @param {{file: typeof measured}} props */
export function Columns({ file: { content, pick } }) {
  const { heads, reading } = content;
  // It stays open while its columns are taken for others.
  const open = useRef(false);
  if (heads.length === 0) return null;
  const timeless = heads.every(({ quantity }) => quantity !== 't');
  const untold = heads.some(({ quantity, unit }) => quantity && quantity !== 'n' && unit === '');
  if (!reading || timeless || untold) open.current = true;
  const asked = `${timeless ? '; none is the time' : ''}${untold ? '; check the units that no head tells' : ''}`;
  const left = heads.filter(({ quantity }) => quantity === null);
  const named = left.map(({ head }) => shown(head)).filter(Boolean);
  const row = (/** @type {Head} */ one, /** @type {number} */ place) => {
    const label = one.head || `column ${place + 1}`;
    const units = unitsOf(one);
    const take = (/** @type {Partial<Head>} */ part) => pick(heads.with(place, { ...one, ...part }));
    // A column that is taken for something else begins in the unit of its head, if it may have that, or of SI.
    const is = (/** @type {string} */ name) => {
      const quantity = /** @type {Quantity | ''} */ (name) || null;
      const { unit } = headOf(one.head);
      take({ quantity, unit: quantity && sizeOf(quantity, unit) !== null ? unit : '' });
    };
    return html`<${Row} cells=${[
      label,
      html`<${Choice} label=${`${label}: is`} value=${one.quantity ?? ''} choices=${CHOICES} changed=${is} />`,
      html`<${Choice} label=${`${label}: unit`} value=${one.unit || (units[0] ?? '')} disabled=${units.length === 0}
        choices=${Object.fromEntries(units.map((unit) => [unit, unit]))} changed=${(/** @type {string} */ unit) => take({ unit })} />`,
    ]} />`;
  };
  return html`<details class="measured-columns" id="fit-columns" open=${open.current}>
    <summary>Columns: ${heads.length - left.length} used, ${left.length} not used${asked}</summary>
    <${Table} label="Columns of the file" head=${['Column', 'is', 'in']}>${heads.slice(0, MOST).map(row)}<//>
    ${reading && named.length > 0 && html`<p class="muted">Not used: ${named.slice(0, NAMED).join(', ')}${named.length > NAMED && ' and more'}.</p>`}
  </details>`;
}
