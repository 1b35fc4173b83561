// Reads a table of measured impacts as labs write them: finds columns and units, and says what could not be read.

import { parse } from '../../dom/typed-number.js';
import { ALL, QUANTITIES } from './quantities.js';

/** @typedef {import('./quantities.js').Quantity} Quantity */
/** @typedef {Record<Quantity, number>} Measured in SI units; what is not there is NaN */

/**
 * @typedef {object} Reading
 * @property {Measured[]} impacts
 * @property {Quantity[]} columns that there are
 * @property {Head[]} heads all columns of the file
 * @property {boolean} numbered the numbers of the impacts are those of the file
 * @property {number[]} lines of the file, one for each impact
 * @property {string[]} remarks what was left out, in words
 * @property {string} unused columns that were left out, in words
 */

/** A column of a file and what it is taken for. @typedef {{head: string, quantity: Quantity | null, unit: string}} Head */
/** Columns by their place, as the reader picked them; `null` leaves a column out. @typedef {Map<number, {quantity: Quantity | null, unit: string}>} Picks */

/** A file with nothing in it to show; its message is for people. */
export class Unreadable extends Error {
  /** Columns that the reader may tell about. @type {Head[]} */
  heads = [];
}

/** Files larger than this are no table of impacts that a page can draw. */
export const LIMIT_BYTES = 4_000_000;
/** More impacts than these are not drawn as diamonds. */
const LIMIT_IMPACTS = 20_000;
/** Remarks about single lines beyond these are counted only. */
const REMARKS = 8;

/** The quantity that a name means. @param {string} name */
const meant = (name) => ALL.find((quantity) => QUANTITIES[quantity][3].includes(plain(name)));

const TURN = Math.PI / 180;
/** Units by that of SI, with what makes SI of them. @type {Record<string, Record<string, number>>} */
const UNITS = {
  1: { 1: 1 },
  s: { s: 1, sec: 1, ms: 1e-3, us: 1e-6, µs: 1e-6, μs: 1e-6 },
  rad: { rad: 1, mrad: 1e-3, deg: TURN, degree: TURN, degrees: TURN, '°': TURN },
  m: { m: 1, cm: 1e-2, mm: 1e-3 },
  'm/s': { 'm/s': 1, 'cm/s': 1e-2, 'mm/s': 1e-3 },
  'rad/s': { 'rad/s': 1, 'mrad/s': 1e-3, 'deg/s': TURN, '°/s': TURN, rpm: Math.PI / 30 },
};
/** Units that a quantity may have. @param {Quantity} quantity */
export const unitsOf = (quantity) => Object.keys(UNITS[QUANTITIES[quantity][1]]);

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
    .replace(/^(?:-|1\/1)$/, '1');

/**
 * @param {string} head
 * @returns {{quantity: Quantity | undefined, unit: string}} the unit '' where none is told
 */
function columnOf(head) {
  const told =
    /^(.+?)\s*(?:[([]([^)\]]*)[)\]]|\/(.+))$/.exec(head.trim()) ??
    /^(.+?)_((?:k|c|m)?(?:s|rad|deg|m|m_per_s|rad_per_s|deg_per_s))$/.exec(head.trim());
  const whole = meant(head);
  if (!told || whole) return { quantity: whole, unit: '' };
  return { quantity: meant(told[1]), unit: plainUnit(told[2] ?? told[3]) };
}

/**
 * The cells of every line that has any. Quotes hold what is between them together, ends of lines included.
 * @param {string} text
 * @param {string} between two cells
 */
function* records(text, between) {
  /** @type {string[]} */
  let cells = [];
  let cell = '';
  let quoted = false;
  let line = 1;
  let first = 1;
  for (let at = 0; at <= text.length; at += 1) {
    const letter = text[at];
    if (letter === '\n') line += 1;
    if (quoted && letter !== undefined) {
      if (letter !== '"') cell += letter;
      else if (text[at + 1] === '"') {
        cell += '"';
        at += 1;
      } else quoted = false;
    } else if (letter === '"' && cell.trim() === '') {
      cell = '';
      quoted = true;
    } else if (letter === between) {
      cells.push(cell.trim());
      cell = '';
    } else if (letter === '\n' || letter === undefined) {
      cells.push(cell.trim());
      if (cells.some((one) => one !== '')) yield { line: first, cells };
      cells = [];
      cell = '';
      first = line;
    } else cell += letter;
  }
}

/**
 * @param {string} text
 * @param {Picks} [picks] what the reader says about columns
 * @returns {Reading}
 */
export function read(text, picks = new Map()) {
  const lines = text.replace(/^\ufeff/, '').replace(/\r\n?/g, '\n');
  const opening = lines.split('\n', 20).find((one) => one.trim() !== '' && !/^\s*#/.test(one)) ?? '';
  const between = ['\t', ';', ','].find((mark) => opening.includes(mark)) ?? ',';
  /** @type {{quantity: Quantity, place: number, factor: number, head: string}[] | null} */
  let columns = null;
  /** @type {string[]} */
  const remarks = [];
  /** @type {Measured[]} */
  const impacts = [];
  /** @type {Head[]} */
  let heads = [];
  /** @type {number[]} */
  const lineNumbers = [];
  let bad = 0;
  for (const { line, cells } of records(lines, between)) {
    const comment = cells[0].startsWith('#');
    if (!columns) {
      if (comment) cells[0] = cells[0].slice(1);
      // A remark names no column, also where the reader has picked what the columns are.
      if (comment && headsOf(cells, new Map()).every(({ quantity }) => !quantity)) continue;
      heads = headsOf(cells, picks);
      const found = header(heads, remarks);
      if (found.length > 0) columns = found;
      else if (!comment)
        throw unreadable(
          `The first line names none of the columns n, t, theta, x_dot, y_dot, theta_dot and x. It is “${shown(cells.join(' '))}”.`,
          heads,
        );
      else remarks.length = 0;
      continue;
    }
    if (comment) continue;
    /** @type {Measured} */
    const impact = { n: NaN, t: NaN, theta: NaN, x_dot: NaN, y_dot: NaN, theta_dot: NaN, x: NaN };
    let wrong = '';
    for (const { quantity, place, factor, head } of columns) {
      const cell = cells[place] ?? '';
      if (/^(|-|–|nan|na|null)$/i.test(cell)) continue;
      const value = parse(cell, null);
      if (value === null) wrong ||= `${head} is “${shown(cell)}”, which is not a number`;
      else if (quantity === 'n' && !(Number.isInteger(value) && value >= 1))
        wrong ||= `${head} is ${shown(cell)}, which is no number of a bounce`;
      else impact[quantity] = value * factor;
    }
    if (!wrong && ALL.every((quantity) => quantity === 'n' || Number.isNaN(impact[quantity])))
      wrong = 'it has no value';
    if (!wrong && impacts.length === LIMIT_IMPACTS) {
      remarks.push(`Bounces from line ${line} on are left out: at most ${LIMIT_IMPACTS} are shown.`);
      break;
    }
    if (!wrong) {
      impacts.push(impact);
      lineNumbers.push(line);
    } else {
      bad += 1;
      if (bad <= REMARKS) remarks.push(`Line ${line} is left out: ${wrong}.`);
    }
  }
  if (bad > REMARKS) remarks.push(`${bad - REMARKS} more lines are left out.`);
  if (!columns) throw new Unreadable('The file is empty.');
  if (impacts.length === 0)
    throw unreadable(`No line after the first has a bounce in it. ${remarks.join(' ')}`.trim(), heads);
  const numbered =
    columns.some(({ quantity }) => quantity === 'n') &&
    impacts.every(({ n }, index) => Number.isFinite(n) && (index === 0 || n > impacts[index - 1].n));
  if (!numbered) {
    if (columns.some(({ quantity }) => quantity === 'n'))
      remarks.push('The bounces are numbered by their lines: the numbers in the file do not rise from line to line.');
    for (const [index, impact] of impacts.entries()) impact.n = index + 1;
  }
  const left = heads.filter(({ head, quantity }) => !quantity && head !== '').map(({ head }) => shown(head));
  const unused = `Not used: ${left.slice(0, 20).join(', ')}${left.length > 20 ? ' and more' : ''}.`;
  return {
    impacts,
    columns: columns.map(({ quantity }) => quantity),
    heads,
    numbered,
    lines: lineNumbers,
    remarks,
    unused: left.length > 0 ? unused : '',
  };
}

/** @param {string} words @param {Head[]} heads */
function unreadable(words, heads) {
  const error = new Unreadable(words);
  error.heads = heads;
  return error;
}

/** @param {string[]} cells of the first line @param {Picks} picks @returns {Head[]} */
const headsOf = (cells, picks) =>
  cells.map((head, place) => {
    const { quantity = null, unit } = columnOf(head);
    return { head, quantity, unit, ...picks.get(place) };
  });

/**
 * @param {Head[]} heads
 * @param {string[]} remarks
 */
function header(heads, remarks) {
  /** @type {{quantity: Quantity, place: number, factor: number, head: string}[]} */
  const columns = [];
  for (const [place, { head, quantity, unit }] of heads.entries()) {
    if (!quantity) continue;
    const factor = unit === '' ? 1 : UNITS[QUANTITIES[quantity][1]][unit];
    if (columns.some((column) => column.quantity === quantity))
      remarks.push(`The column “${shown(head)}” is left out: there is one of ${quantity} before it.`);
    else if (factor === undefined)
      remarks.push(`The column “${shown(head)}” is left out: “${shown(unit)}” is not known as a unit of ${quantity}.`);
    else columns.push({ quantity, place, factor, head: shown(head) });
  }
  return columns;
}
