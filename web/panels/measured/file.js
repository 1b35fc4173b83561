// The file of measured impacts that the page has: read once, for all that show it. It stays in this browser.

import { number } from '../../dom/numbers.js';
import { useEffect, useState } from '../../vendor/preact/preact.js';
import { LIMIT_BYTES, Unreadable, read } from './read.js';

/** @typedef {import('./read.js').Head} Head */
/** @typedef {import('./read.js').Picks} Picks */
/** @typedef {import('./read.js').Reading} Reading */

class MeasuredFile {
  name = '';
  /** Remarks about where it comes from. */
  about = '';
  /** The impacts; null without a file, and where nothing of it can be shown. @type {Reading | null} */
  reading = null;
  /** Reason why nothing of the file can be shown. */
  refusal = '';
  /** All columns of the file. @type {Head[]} */
  heads = [];
  /** Counts the files. */
  files = 0;
  #text = '';
  /** @type {Set<() => void>} */
  #watchers = new Set();

  /** @param {() => void} changed @returns {() => void} ends it */
  watch(changed) {
    this.#watchers.add(changed);
    return () => void this.#watchers.delete(changed);
  }

  /** Reads a file. @param {File} file @param {string} [about] where it comes from */
  async take(file, about = '') {
    const large = file.size > LIMIT_BYTES;
    const text = large ? null : await file.text().catch(() => null);
    Object.assign(this, { name: file.name, about, files: this.files + 1 });
    this.#text = text ?? '';
    if (text !== null) return this.pick(new Map());
    const size = `The file has ${number(file.size / 1e6, 3)} MB; at most ${LIMIT_BYTES / 1e6} MB are read.`;
    this.#show(null, large ? size : 'The file could not be read.', []);
  }

  /** Reads the file again. @param {Picks} picks what its columns are */
  pick = (picks) => {
    try {
      const reading = read(this.#text, picks);
      this.#show(reading, '', reading.heads);
    } catch (error) {
      if (error instanceof Unreadable) this.#show(null, error.message, error.heads);
      else this.#show(null, 'The file could not be read.', []);
    }
  };

  /** @param {Reading | null} reading @param {string} refusal @param {Head[]} heads */
  #show(reading, refusal, heads) {
    Object.assign(this, { reading, refusal, heads });
    for (const changed of this.#watchers) changed();
  }
}

/** The file of this page. */
export const measured = new MeasuredFile();

/** The same, drawn anew with each change of it. */
export function useMeasured() {
  const [, again] = useState({});
  useEffect(() => measured.watch(() => again({})), []);
  return measured;
}
