// Reads a table of measured impacts as labs write them: finds columns and units, and says what could not be read.

import { parse, unitOf } from '../../dom/typed-number.js';
import { ALL, QUANTITIES } from './quantities.js';

/** @typedef {import('./quantities.js').Quantity} Quantity */
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
/** Columns by their place, as the reader picked them; `null` leaves a column out. @typedef {Map<number, {quantity: Quantity | null, unit: string}>} Picks */
/** A column that is read, with what makes SI of its numbers. @typedef {{quantity: Quantity, place: number, factor: number, head: string}} Column */
/** The columns of a file with its impacts, or the reason why there are none. @typedef {{heads: Head[], reading: Reading | null, refusal: string}} Content */

/** Files larger than this are no table of impacts that a page can draw. */
export const LIMIT_BYTES = 4_000_000;
/** More impacts than these are not drawn as diamonds. */
const LIMIT_IMPACTS = 20_000;
/** Remarks about single lines beyond these are counted only. */
const REMARKS = 8;

/** The quantity that a name means. @param {string} name */
const meant = (name) => ALL.find((quantity) => QUANTITIES[quantity][3].includes(plain(name)));

/** @param {string} text short enough to print */
export const shown = (text) => (text.length > 30 ? `${text.slice(0, 30)}…` : text);

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
  const own = QUANTITIES[quantity][1];
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
  const whole = meant(head);
  if (!told || whole) return { head, quantity: whole ?? null, unit: '' };
  return { head, quantity: meant(told[1]) ?? null, unit: plainUnit(told[2] ?? told[3]) };
}

/**
 * The cells of every line that has any. Quotes hold what is between them together, ends of lines included.
 * @param {string} text
 */
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

/**
 * @param {string} text
 * @param {Picks} [picks] what the reader says about columns
 * @returns {Content}
 */
export function read(text, picks = new Map()) {
  const records = recordsOf(text.replace(/^\ufeff/, '').replace(/\r\n?/g, '\n'));
  const isRemark = (/** @type {string[]} */ [first]) => first.startsWith('#');
  /** @type {Head[]} */
  let heads = [];
  for (const [index, { cells }] of records.entries()) {
    const own = cells.map((one, place) => headOf(place === 0 ? one.replace(/^#/, '') : one));
    // A remark names no column, also where the reader has picked what the columns are.
    if (isRemark(cells) && own.every(({ quantity }) => !quantity)) continue;
    heads = own.map((head, place) => ({ ...head, ...picks.get(place) }));
    const remarks = /** @type {string[]} */ ([]);
    const columns = columnsOf(heads, remarks);
    if (columns.length > 0) {
      const rows = records.slice(index + 1).filter((one) => !isRemark(one.cells));
      const reading = {
        ...impactsOf(rows, columns, remarks),
        columns: columns.map(({ quantity }) => quantity),
        remarks,
      };
      const refusal =
        reading.impacts.length > 0 ? '' : `No line after the first has a bounce in it. ${remarks.join(' ')}`.trim();
      return { heads, reading: refusal ? null : reading, refusal };
    }
    if (!isRemark(cells))
      return {
        heads,
        reading: null,
        refusal: `The first line names none of the columns n, t, theta, x_dot, y_dot, theta_dot and x. It is “${shown(cells.join(' '))}”.`,
      };
  }
  return { heads, reading: null, refusal: 'The file is empty.' };
}

/** The columns that are read; those that are left out are remarked. @param {Head[]} heads @param {string[]} remarks */
function columnsOf(heads, remarks) {
  /** @type {Column[]} */
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

/** The impact of a line, or the reason why it is none. @param {string[]} cells @param {Column[]} columns @returns {Measured | string} */
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

/** @param {{line: number, cells: string[]}[]} rows @param {Column[]} columns @param {string[]} remarks */
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
