// The parts of the page that its steps share: a step, words that are spoken, and a panel that is loaded when it is needed.

import { retryButton } from '../dom/elements.js';
import { styles } from '../dom/styles.js';
import { Nodes, Told } from '../panels/parts.js';
import { html, useEffect, useState } from '../vendor/preact/preact.js';

/** @typedef {import('./rig.js').Rig} Rig */
/** @typedef {import('../panels/parts.js').Result} Result */

/** Quiet before a result is spoken, ms: nobody hears each turn of a knob. */
const SPOKEN_MS = 1000;

/** Speaks words once they stay. @param {{words: string}} props */
export function Spoken({ words }) {
  const [said, say] = useState('');
  useEffect(() => {
    const timer = setTimeout(() => say(words), SPOKEN_MS);
    return () => clearTimeout(timer);
  }, [words]);
  return html`<p class="unseen" role="status">${said}</p>`;
}

/** Opens a step, and brings it into view. @param {string} id */
export function openStep(id) {
  if (location.hash === `#${id}`) dispatchEvent(new Event('hashchange'));
  else location.hash = id;
}

/**
 * A numbered step that folds to its result.
 * @param {{n: number, id: string, title: string, result: Result, open?: boolean, children: any}} props a body as a function is made when the step is opened
 */
export function Step({ n, id, title, result, open: begins = false, children }) {
  const [open, turn] = useState(begins || location.hash === `#${id}`);
  const [seen, see] = useState(open);
  useEffect(() => {
    const named = () => {
      if (location.hash !== `#${id}`) return;
      turn(true);
      document.getElementById(id)?.scrollIntoView();
    };
    addEventListener('hashchange', named);
    named();
    return () => removeEventListener('hashchange', named);
  }, []);
  useEffect(() => {
    if (open) see(true);
  }, [open]);
  return html`<section id=${id} class="step card" aria-labelledby=${`${id}-title`}>
    <details open=${open} onToggle=${(/** @type {Event} */ event) => turn(/** @type {HTMLDetailsElement} */ (event.currentTarget).open)}>
      <summary>
        <h2 id=${`${id}-title`}><span class="n">${n}</span> ${title}</h2>
        ${result && html`<span class="result"><${Told} result=${result} /></span>`}
      </summary>
      <div class="step-body">${seen && (typeof children === 'function' ? children(open) : children)}</div>
    </details>
    <a class="to-step" href=${`#${id}`} aria-label=${`Link to step ${n}: ${title}`}>#</a>
  </section>`;
}

/**
 * A panel, once its code and its styles are there.
 * @param {{entry: import('../panels/card.js').Entry, name: string, [prop: string]: unknown}} props `name` of the component, and what it takes
 */
export function Panel({ entry: { id, sheets, load }, name, ...props }) {
  const [loaded, bring] = useState(/** @type {{Component: any} | null} */ (null));
  const [failed, fail] = useState(false);
  const ask = async () => {
    try {
      const [module] = await Promise.all([load(), ...sheets.map(styles)]);
      bring({ Component: /** @type {any} */ (module)[name] });
      fail(false);
    } catch {
      fail(true);
    }
  };
  useEffect(() => void ask(), []);
  if (loaded) return html`<div id=${`${id}-body`}><${loaded.Component} ...${props} /></div>`;
  return (
    failed && html`<p class="muted">This part did not load. <${Nodes} nodes=${[retryButton(() => void ask())]} /></p>`
  );
}
