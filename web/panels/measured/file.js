// The file of measured impacts that the page has: read once, for all that show it. It stays in this browser.

import { number } from '../../dom/numbers.js';
import { useChanges } from '../parts.js';
import { LIMIT_BYTES, read } from './read.js';

/** @typedef {import('./read.js').Content} Content */

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

  /** Reads the file again. @param {import('./read.js').Picks} picks what its columns are */
  pick = (picks) => this.#show(read(this.#text, picks));

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
