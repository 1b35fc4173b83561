// The chapters of the paper's page: its items, its cases, and the scenes on which usual methods fail; with figures of the server, a place for the
// reader's own scan of one, and printed values beside computed ones.

import { wordsOf } from '../api/client.js';
import { sceneQuery } from '../api/scene-query.js';
import { here, serverFigure } from '../charts/readable/server-figure.js';
import { number, quantity } from '../dom/numbers.js';
import { Row, Table, sentence, sign, words } from '../panels/parts.js';
import { html, useEffect, useLayoutEffect, useRef, useState } from '../vendor/preact/preact.js';

/** @import { PaperItem, Quantity, Failure } from 'contract' */

/** Time that a figure may take, ms. */
const PATIENCE_MS = 60_000;

/** Acts once, when an element comes near or the page is printed. @param {Element | null} element @param {() => void} act @returns {() => void} gives it up */
export function whenNear(element, act) {
  const stop = () => {
    watch.disconnect();
    removeEventListener('beforeprint', now);
  };
  const now = () => {
    stop();
    act();
  };
  const near = (/** @type {IntersectionObserverEntry[]} */ entries) =>
    entries.some(({ isIntersecting }) => isIntersecting) && now();
  const watch = new IntersectionObserver(near, { rootMargin: '600px 0px' });
  if (element) watch.observe(element);
  addEventListener('beforeprint', now);
  return stop;
}

/** A picture by the server, asked for when it comes near. @param {{path: string, label: string, over?: unknown}} props `over` lies above the picture */
export function Figure({ path, label, over }) {
  const box = useRef(/** @type {HTMLElement | null} */ (null));
  const [told, tell] = useState('The picture is being drawn…');
  const draw = () =>
    void serverFigure(path, AbortSignal.timeout(PATIENCE_MS)).then(
      (figure) => {
        box.current?.replaceChildren(figure);
        tell('');
      },
      (error) => tell(wordsOf(error)),
    );
  useEffect(() => whenNear(box.current, draw), [path]);
  return html`<div class="picture" role="img" aria-label=${label}>
    <div class="picture-box" ref=${box} />
    ${over}
    ${told && html`<p class="muted">${told}</p>`}
  </div>`;
}

/** A value with its place in the paper, or in the answer. @param {string} value @param {string | undefined} where */
const placed = (value, where) => html`${value}${where && html`<span class="note">${where}</span>`}`;

/**
 * Printed values beside computed ones.
 * @param {{label: string, rows: {name: unknown, printed: string, computed: string, agrees: boolean | null, why: string | null, where?: string[]}[]}} props
 */
export const Compared = ({
  label,
  rows,
}) => html`<${Table} label=${label} kind="compared" head=${['Quantity', 'Printed', 'Computed', html`<span class="unseen">Equal</span>`]}>
  ${rows.map(
    ({ name, printed, computed, agrees, why, where = [] }) => html`<${Row} cells=${[
      name,
      placed(printed, where[0]),
      placed(computed, where[1]),
      agrees !== null && html`<span class=${agrees ? 'same' : 'differs'}>${agrees ? '=' : '≠'}</span>`,
    ]} />
    ${why && html`<tr class="why"><td colspan="4">${sentence(why)}</td></tr>`}`,
  )}
<//>`;

/** Largest file that is read. */
const LIMIT_BYTES = 30e6;
/** Steps of the arrow keys, in parts of the picture's width. */
const STEP = 0.005;

/** Place and size of the scan over the picture, in parts of the picture's width. */
const LAID = { over: false, opacity: 0.5, x: 0, y: 0, size: 1 };
const SLIDERS = /** @type {const} */ ([
  ['opacity', 'Opacity', 0.05, 1],
  ['size', 'Size', 0.2, 2],
]);

/**
 * @param {string} place of the figure in the paper
 * @param {boolean} picture there is a computed one, over which the scan can lie
 * @returns {{layer: unknown, element: unknown}} the scan over the picture, and its place with the controls
 */
function useScan(place, picture) {
  const [image, show] = useState(/** @type {ImageBitmap | null} */ (null));
  const [told, tell] = useState('');
  const [laid, lay] = useState(LAID);
  const file = useRef(/** @type {HTMLInputElement | null} */ (null));
  const take = async (/** @type {File | undefined} */ given) => {
    if (!given) return;
    const { name, size } = given;
    if (size > LIMIT_BYTES)
      return tell(`${name} has ${(size / 1e6).toFixed(0)} MB; at most ${LIMIT_BYTES / 1e6} MB are read.`);
    try {
      show(await createImageBitmap(given));
      tell(`${name} is shown.`);
    } catch {
      tell(`${name} is not a picture that this browser reads. Save a page of the paper as PNG or JPEG.`);
    }
  };
  const remove = () => {
    if (file.current) file.current.value = '';
    show(null);
    tell('The scan is removed.');
  };
  const drop = (/** @type {DragEvent} */ event) => {
    event.preventDefault();
    event.stopPropagation();
    void take(event.dataTransfer?.files[0]);
  };
  const set = (/** @type {Partial<typeof LAID>} */ part) => lay((before) => ({ ...before, ...part }));
  const move = (/** @type {number} */ dx, /** @type {number} */ dy) =>
    lay((before) => ({ ...before, x: before.x + dx, y: before.y + dy }));
  const slider = (/** @type {typeof SLIDERS[number]} */ [name, words, min, max]) =>
    html`<label class="scan-control">${words} <input type="range" min=${min} max=${max} step="0.01" value=${laid[name]}
      onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => set({ [name]: Number(currentTarget.value) })} /></label>`;
  const scan = image && html`<${Scan} image=${image} place=${place} laid=${laid} move=${move} />`;
  return {
    layer: laid.over && scan && html`<div class="scan-layer">${scan}</div>`,
    element: html`<div class="scan-place" onDragOver=${(/** @type {Event} */ event) => event.preventDefault()} onDrop=${drop}>
      <p>Drop your scan of ${place} here, or choose a file. It stays in this browser.</p>
      <input type="file" accept="image/*" aria-label=${`Your scan of ${place}`} ref=${file}
        onChange=${() => void take(file.current?.files?.[0])} />
      <p class="muted" role="status">${told}</p>
      ${
        image &&
        html`<div class="scan-controls">
          ${
            picture &&
            html`<label class="check">
                <input type="checkbox" checked=${laid.over} onChange=${() => set({ over: !laid.over })} />
                Over the computed picture
              </label>
              ${SLIDERS.map(slider)}`
          }
          <button type="button" onClick=${remove}>Remove the scan</button>
        </div>`
      }
      ${!laid.over && scan && html`<div class="scan-beside">${scan}</div>`}
    </div>`,
  };
}

/** The scan itself; over the picture the pointer and the arrow keys move it. @param {{image: ImageBitmap, place: string, laid: typeof LAID, move: (dx: number, dy: number) => void}} props */
function Scan({ image, place, laid: { over, opacity, x, y, size }, move }) {
  const canvas = useRef(/** @type {HTMLCanvasElement | null} */ (null));
  /** The pointer where it was. */
  const before = useRef(/** @type {PointerEvent | null} */ (null));
  useLayoutEffect(() => canvas.current?.getContext('2d')?.drawImage(image, 0, 0), [image]);
  const key = (/** @type {KeyboardEvent} */ event) => {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (!step || !over) return;
    event.preventDefault();
    event.stopPropagation();
    const far = STEP * (event.shiftKey ? 10 : 1);
    move(step[0] * far, step[1] * far);
  };
  const press = (/** @type {PointerEvent} */ event) => {
    if (over) canvas.current?.setPointerCapture(event.pointerId);
    before.current = event;
  };
  const drag = (/** @type {PointerEvent} */ event) => {
    if (!before.current || !canvas.current?.hasPointerCapture(event.pointerId)) return;
    const width = canvas.current.parentElement?.clientWidth || 1;
    move((event.clientX - before.current.clientX) / width, (event.clientY - before.current.clientY) / width);
    before.current = event;
  };
  // A margin in per cent is one of the width, above as well.
  const style = over
    ? { width: `${100 * size}%`, left: `${100 * x}%`, marginTop: `${100 * y}%`, opacity }
    : { width: '100%' };
  return html`<canvas class="scan" tabindex="0" role="img"
    aria-label=${`Your scan of ${place}; arrow keys move it over the picture`} width=${image.width}
    height=${image.height} style=${style} ref=${canvas} onKeyDown=${key} onPointerDown=${press} onPointerMove=${drag} />`;
}

/**
 * A part with its ways on: its run, and the request for it.
 * @param {{id: string, title: string, heading?: unknown, run: string, ask?: string, children: unknown}} props
 */
const Article = ({ id, title, heading, run, ask, children }) => html`<article class="stack" id=${id}
  aria-labelledby=${`${id}-title`}>
  <h3 class="row" id=${`${id}-title`}>${heading ?? words(title)}</h3>
  ${children}
  <p class="actions">
    <a href=${run} aria-label=${`Run it: ${title}`}>Run it</a>
    ${ask && html`<a href=${here(ask)} aria-label=${`Ask the server: ${title}`}>Ask the server</a>`}
  </p>
</article>`;

/** The run of a scene in the place of play. @param {PaperItem['scene'] | Failure['scene']} scene @param {ScenePage} page */
const runOf = (scene, { fields, cases: [usual] }) => `./?${sceneQuery(scene, usual, fields)}`;

/** Name of a quantity beside its symbol; none where it is a path. @param {string} name */
const named = (name) => (/^[a-z_]+\.[a-z_.]+$/.test(name) ? '' : html` <span class="muted">${name}</span>`);

/** @param {{item: PaperItem}} props */
function Checks({ item: { checks, place, title } }) {
  const rows = checks.map(({ quantity: name, symbol, unit, printed, computed, agrees, why }) => ({
    name: html`${sign(symbol)}${named(name)}`,
    printed: printed === null ? 'in words' : quantity(printed, unit, 5),
    computed: quantity(computed, unit, 5),
    agrees,
    why,
  }));
  return rows.length > 0 && html`<${Compared} label=${`Printed and computed: ${place}, ${title}`} rows=${rows} />`;
}

/** The computed picture, and a place for the reader's own scan. @param {{item: PaperItem}} props */
function Pictures({ item: { kind, picture, place, title } }) {
  const { layer, element } = useScan(place, picture !== null);
  return html`<div class="pictures">
    ${picture && html`<${Figure} path=${here(picture)} label=${`Computed: ${title}`} over=${layer} />`}
    ${kind === 'figure' && html`<details><summary>Lay your scan beside it</summary>${element}</details>`}
  </div>`;
}

/** @param {{item: PaperItem, run: string}} props */
function Item({ item, run }) {
  const { id, place, title, printed, why, ask, checks, agrees } = item;
  const heading = html`<a class="place" href=${`#${id}`}>${words(place)}</a> ${words(title)}
    ${checks.length > 0 && html`<span class=${`chip ${agrees ? 'same' : 'differs'}`}>${agrees ? 'agrees' : 'differs'}</span>`}`;
  return html`<${Article} id=${id} title=${title} heading=${heading} run=${run} ask=${ask}>
    <p class="printed">${words(printed)}</p>
    <${Checks} item=${item} />
    ${why && html`<p>${sentence(why)}</p>`}
    <${Pictures} item=${item} />
  <//>`;
}

/** @param {string} section */
const anchor = (section) => `section-${section.toLowerCase().replace(/[^a-z0-9]+/g, '-')}`;

/** The items of the paper by their sections, which `listed` hears of as anchors and titles. @param {{page: ScenePage, answer: {items: PaperItem[]}, listed?: (sections: string[][]) => void}} props */
export function Items({ page, answer: { items }, listed }) {
  const sections = [...new Set(items.map(({ section }) => section))];
  const differ = items.filter(({ agrees }) => !agrees).length;
  useEffect(() => listed?.(sections.map((section) => [anchor(section), section])), []);
  return html`<p>${items.length} items. ${differ} differ from the print, each with the reason.</p>
    ${sections.map(
      (section) => html`<section aria-labelledby=${anchor(section)}>
        <h2 id=${anchor(section)}>${words(section)}</h2>
        ${items
          .filter((item) => item.section === section)
          .map((item) => html`<${Item} key=${item.id} item=${item} run=${runOf(item.scene, page)} />`)}
      </section>`,
    )}`;
}

/** @param {Quantity | undefined} value */
const told = (value) => quantity(value?.value, value?.unit ?? '', 5);

/** @param {{one: Case, run: string}} props */
function PaperCase({ one: { name, title, shows, printed, computed }, run }) {
  const rows = computed.map((value, index) => {
    const words = value.quantity.replaceAll(/[._]/g, ' ');
    return {
      name: value.symbol ? html`${sign(value.symbol)} <span class="muted">${words}</span>` : words,
      printed: told(printed[index]),
      computed: told(value),
      // A value that differs from the printed one has a reason.
      agrees: printed[index]?.value == null ? null : !value.why,
      why: value.why ?? null,
      where: [printed[index]?.where ?? '', value.where ?? ''],
    };
  });
  return html`<${Article} id=${`case-${name}`} title=${title} run=${run}>
    <p>${sentence(shows)}</p>
    ${
      rows.length > 0
        ? html`<${Compared} label=${`Printed and computed values: ${title}`} rows=${rows} />`
        : html`<p class="muted">The paper prints no number for this case.</p>`
    }
  <//>`;
}

/** The case of the page, or `every` one. @param {{page: ScenePage, every?: boolean}} props */
export function PaperCases({ page: { fields, cases, chosen }, every }) {
  const shown = chosen && !every ? [chosen] : cases.filter(({ computed }) => computed.length > 0);
  return shown.map(
    (one) => html`<${PaperCase} key=${one.name} one=${one} run=${`./?${sceneQuery(one.scene, one, fields)}`} />`,
  );
}

/** So near to 1 that only the distance tells anything. @param {number} value */
const nearOne = (value) => value !== 1 && Math.abs(value - 1) < 1e-6;

/** @param {number} value @param {string | null} unit */
const valued = (value, unit) =>
  nearOne(value) && unit === null
    ? `1 ${value > 1 ? '+' : '\u2212'} ${number(Math.abs(value - 1), 3)}`
    : quantity(value, unit);

/** @param {{says: Failure['says'][number]}} props */
const Claim = ({ says: { method, text, value, unit, right, detail } }) => html`<li class=${right ? 'right' : 'wrong'}>
  <p>
    <span class="sign" aria-hidden="true">${right ? '✓' : '✗'}</span> ${words(method)}:${' '}
    <strong>${words(text)}</strong>${value === null ? '' : ` (${valued(value, unit)})`}${' '}
    <span class="chip">${right ? 'right' : 'wrong'}</span>
  </p>
  <p class="muted">${sentence(detail, words)}</p>
</li>`;

/** @param {{failure: Failure, run: string}} props */
const FailureCase = ({
  failure: { name, title, why, says, truth, ask, picture },
  run,
}) => html`<${Article} id=${`failure-${name}`} title=${title} run=${run} ask=${ask}>
  <p class="truth"><strong>In truth: ${words(truth.text)}.</strong> ${sentence(truth.detail, words)}</p>
  <ul class="says" aria-label="What each method says">
    ${says.map((one) => html`<${Claim} says=${one} />`)}
  </ul>
  <p>${sentence(why, words)}</p>
  <a class="picture" href=${here(picture)}>
    <img src=${here(picture)} loading="lazy" width="720" height="542" alt=${`Picture: ${title}. It opens by itself.`} />
  </a>
<//>`;

/** Scenes on which usual methods fail. @param {{page: ScenePage, answer: {items: Failure[]}}} props */
export const Failures = ({ page, answer: { items } }) =>
  items.map((one) => html`<${FailureCase} key=${one.name} failure=${one} run=${runOf(one.scene, page)} />`);
