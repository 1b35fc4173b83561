// The scene's tools that come after the first plot: the rod as a handle, the symbols, and the words about the picture.

import { byId, h } from '../../dom/elements.js';
import { remember, remembered } from '../../play/remembered.js';
import { Grab } from './grab.js';
import { MEANINGS, drawSymbols, spokenSymbols } from './symbols.js';

const STORED = 'equipoise.symbols';
/** The spoken values follow the picture at most so often, ms. */
const SPOKEN_MS = 1000;

/**
 * @param {object} parts
 * @param {import('../scene-view.js').SceneView} parts.view
 * @param {import('../../api/scene-fields.js').Field[]} parts.fields
 * @param {() => import('../../api/scene-fields.js').Scene | null} parts.typed
 * @param {(values: Record<string, number>) => void} parts.launch
 */
export function bringSceneTools({ view, ...parts }) {
  const box = byId('scene-frame');
  new Grab(box, { view, ...parts });
  offerSymbols(box, view);
  byId('panel-why').append(aboutPicture());
}

/** @param {HTMLElement} box @param {import('../scene-view.js').SceneView} view */
function offerSymbols(box, view) {
  const words = h('p', { id: 'symbols-words', class: 'unseen' });
  const button = byId('symbols');
  const isOn = () => button.getAttribute('aria-pressed') === 'true';
  let spoken_ms = -Infinity;
  const show = (/** @type {boolean} */ on) => {
    button.setAttribute('aria-pressed', String(on));
    remember(STORED, on);
    words.textContent = '';
    spoken_ms = -Infinity;
    view.measure(on);
  };
  button.addEventListener('click', () => show(!isOn()));
  view.followers.push((drawn) => {
    if (!isOn()) return;
    drawSymbols(view.layers[0].context, drawn);
    const now_ms = performance.now();
    if (now_ms - spoken_ms < SPOKEN_MS) return;
    spoken_ms = now_ms;
    words.textContent = `Drawn in the scene: ${spokenSymbols(drawn)}.`;
  });
  box.append(words);
  show(remembered(STORED, false));
}

const aboutPicture = () =>
  h(
    'details',
    { id: 'about-picture', class: 'about-picture' },
    h('summary', {}, 'About this picture'),
    h(
      'p',
      {},
      'The rod flies in closed form, on the server’s clock. The table is known at its strikes; between them it is drawn on the smoothest way. ' +
        'Drag the rod by its middle to move it and by an end to tilt it; let go to release it. Before a release the faint path shows its first flights.',
    ),
    h('dl', {}, ...MEANINGS.map(([name, meaning]) => h('div', {}, h('dt', {}, name), h('dd', {}, meaning)))),
  );
