// The parts of the page that its steps share: a step, and the verdict on a scene.

import { useAnswer } from '../panels/ask.js';
import { Told } from '../panels/parts.js';
import { html, useEffect, useRef, useState } from '../vendor/preact/preact.js';

/** @typedef {import('./rig.js').Rig} Rig */
/** @typedef {import('../panels/parts.js').Result} Result */

/** The verdict on a scene, with the gains that this release allows. @param {string | URLSearchParams | null} query null for none */
export const useVerdict = (query) => useAnswer(query && `v1/stability?${query}&release_margins=true`);

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
  const seen = useRef(open);
  seen.current ||= open;
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
  return html`<section id=${id} class="step card" aria-labelledby=${`${id}-title`}>
    <details open=${open} onToggle=${(/** @type {Event} */ event) => turn(/** @type {HTMLDetailsElement} */ (event.currentTarget).open)}>
      <summary>
        <h2 id=${`${id}-title`}><span class="n">${n}</span> ${title}</h2>
        ${result && html`<span class="result"><${Told} result=${result} /></span>`}
      </summary>
      <div class="step-body">${seen.current && (typeof children === 'function' ? children(open) : children)}</div>
    </details>
    <a class="to-step" href=${`#${id}`} aria-label=${`Link to step ${n}: ${title}`}>#</a>
  </section>`;
}
