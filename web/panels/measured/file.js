// The file of measured impacts that the page has: read once, for all panels that show it. It stays in this browser.

import { LIMIT_BYTES, Unreadable, read } from './read.js';
import { number } from '../../dom/numbers.js';

/** @typedef {import('./read.js').Head} Head */
/** @typedef {import('./read.js').Picks} Picks */
/** @typedef {import('./read.js').Reading} Reading */

class MeasuredFile {
  name = '';
  /** The impacts; null without a file, and where nothing of it can be shown. @type {Reading | null} */
  reading = null;
  /** Reason why nothing of the file can be shown. */
  refusal = '';
  /** All columns of the file. @type {Head[]} */
  heads = [];
  /** Remarks about where it comes from. */
  about = '';
  #text = '';
  /** @type {Set<(fresh: boolean) => void>} */
  #watchers = new Set();

  /** @param {(fresh: boolean) => void} changed called with true for another file, with false where its columns are taken for others */
  watch(changed) {
    this.#watchers.add(changed);
  }

  /** Reads a file. @param {File} file @param {string} [about] where it comes from */
  async take(file, about = '') {
    const large = file.size > LIMIT_BYTES;
    const text = large ? null : await file.text().catch(() => null);
    this.name = file.name;
    this.about = about;
    this.#text = text ?? '';
    if (text !== null) return this.#read(new Map(), true);
    const size = `The file has ${number(file.size / 1e6, 3)} MB; at most ${LIMIT_BYTES / 1e6} MB are read.`;
    this.#refuse(large ? size : 'The file could not be read.', []);
    this.#tell(true);
  }

  /** Reads the file again. @param {Picks} picks what its columns are */
  pick(picks) {
    this.#read(picks, false);
  }

  remove() {
    this.#text = this.name = this.about = '';
    this.#refuse('', []);
    this.#tell(true);
  }

  /** @param {Picks} picks @param {boolean} fresh */
  #read(picks, fresh) {
    try {
      this.reading = read(this.#text, picks);
      this.heads = this.reading.heads;
      this.refusal = '';
    } catch (error) {
      const known = error instanceof Unreadable;
      this.#refuse(known ? error.message : 'The file could not be read.', known ? error.heads : []);
    }
    this.#tell(fresh);
  }

  /** @param {string} why @param {Head[]} heads */
  #refuse(why, heads) {
    this.reading = null;
    this.refusal = why;
    this.heads = heads;
  }

  /** @param {boolean} fresh */
  #tell(fresh) {
    for (const changed of this.#watchers) changed(fresh);
  }
}

/** The file of this page. */
export const measured = new MeasuredFile();
