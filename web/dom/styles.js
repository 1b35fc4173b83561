// Style sheets that load when something needs them.

import { h } from './elements.js';

/** The colours and sizes of the server's pictures in the page, and the form of a study. */
export const STUDY_SHEETS = ['charts/generated/figure-colours.css', 'panels/study.css'];

/** The style sheets that are loaded or on their way. @type {Map<string, Promise<void>>} */
const sheets = new Map();

/** Loads a style sheet once; one that failed can be asked for again. @param {string} path */
export function styles(path) {
  const sheet = sheets.get(path) ?? appendSheet(path);
  sheets.set(path, sheet);
  return sheet;
}

/** @param {string} path @returns {Promise<void>} */
function appendSheet(path) {
  return new Promise((resolve, reject) => {
    const failed = () => {
      sheets.delete(path);
      reject(new Error(path));
    };
    document.head.append(h('link', { rel: 'stylesheet', href: path, load: () => resolve(), error: failed }));
  });
}
