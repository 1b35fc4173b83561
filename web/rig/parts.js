// The parts of the page that its steps share: a step, a field for a number, and the place of a panel.

import { debounce } from '../dom/debounce.js';
import { styles } from '../dom/styles.js';
import { h as element, retryButton } from '../dom/elements.js';
import { numberInput } from '../dom/number-input.js';
import { parse } from '../dom/typed-number.js';
import { html, useEffect, useMemo, useRef, useState } from '../vendor/preact/preact.js';

/** @typedef {import('./rig.js').Rig} Rig */
/** The parts that all steps share: the rig, and the page as its panels know it. @typedef {{rig: Rig, page: import('../panels/card.js').PanelPage, dropped: (id: string, what: string[]) => void}} Shared */

/** Signs of results, which show them without colour. */
export const SIGNS = { stable: '●', beyond: '◆', unstable: '▲', none: '–' };
/** @typedef {keyof typeof SIGNS} Tone */
/** The result of a step in a line. @typedef {{tone: Tone, words: string} | null} Result */

/** The rig, drawn anew with each change of it. @param {Rig} rig */
export function useRig(rig) {
  const [, again] = useState({});
  useEffect(() => rig.watch(() => again({})), []);
}

/** A result in its tone. @param {{result: NonNullable<Result>}} props */
export const Told = ({ result: { tone, words } }) =>
  html`<span class=${`told ${tone}`}><span class="sign" aria-hidden="true">${SIGNS[tone]}</span> ${words}</span>`;

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
 * A field for a number with its unit.
 * @param {{id: string, label: string, unit: string, value: number | undefined, placeholder?: string, fault?: (value: number) => string | null, changed: (value: number | undefined) => void}} props value in the unit
 */
export function NumberField({ id, label, unit, value, placeholder, fault, changed }) {
  const now = useRef({ changed, unit });
  now.current = { changed, unit };
  const parts = useMemo(() => {
    const error = element('p', { class: 'error', id: `${id}-error` });
    const input = numberInput(
      {
        id,
        'aria-label': label,
        change: () => now.current.changed(parse(input.value, now.current.unit || null) ?? undefined),
      },
      error,
      { unit: () => now.current.unit || null, open: true, fault },
    );
    return { input, error };
  }, []);
  useEffect(() => {
    parts.input.placeholder = placeholder ?? '';
    if (document.activeElement !== parts.input || parse(parts.input.value, unit || null) !== value)
      parts.input.value = value === undefined ? '' : String(Number(value.toPrecision(6)));
  }, [value, placeholder, unit]);
  return html`<span class="number-field"><${Nodes} nodes=${[parts.input]} /> <span class="unit">${unit}</span><${Nodes} nodes=${[parts.error]} /></span>`;
}

/** Nodes of the page as children. @param {{nodes: (Node | string)[], tag?: string, class?: string}} props */
export function Nodes({ nodes, tag = 'span', class: kind }) {
  const place = useRef(/** @type {HTMLElement | null} */ (null));
  useEffect(() => place.current?.replaceChildren(...nodes), nodes);
  return html`<${tag} class=${kind} ref=${place} />`;
}

/** Time without a change before a panel that follows the rig asks anew, ms. */
const QUIET_MS = 400;

/**
 * The place of a panel of the rig's scene.
 * @param {object} props
 * @param {import('../panels/card.js').Entry} props.entry
 * @param {Rig} props.rig
 * @param {import('../panels/card.js').PanelPage} props.page
 * @param {Shared['dropped']} props.dropped
 * @param {boolean} [props.follows] it asks by itself, at each change; false while nobody sees it
 * @param {(panel: import('../panels/card.js').Panel, root: HTMLElement) => void} [props.mounted]
 */
export function PanelPlace({ entry: { id, shared = [], load }, rig, page, dropped, follows, mounted }) {
  const place = useRef(/** @type {HTMLElement | null} */ (null));
  const [failed, fail] = useState(false);
  /** The scene that the panel has asked for. */
  const asked = useRef('');
  const seen = useRef(follows);
  seen.current = follows;
  const ask = useMemo(
    () =>
      debounce(QUIET_MS, () => {
        if (!seen.current) return;
        asked.current = rig.words;
        rig.panels.get(id)?.ask?.();
      }),
    [],
  );
  const changed = () => {
    page.changed();
    ask();
  };
  const bring = async () => {
    try {
      const [module] = await Promise.all([load(), ...[...shared, `panels/${id}/${id}.css`].map(styles)]);
      if (!place.current) return;
      const panel = module.mount(place.current, follows === undefined ? page : { ...page, changed }, rig.link);
      dropped(id, panel.restore?.(rig.link) ?? []);
      rig.panels.set(id, panel);
      mounted?.(panel, place.current);
      ask();
      fail(false);
    } catch {
      fail(true);
    }
  };
  useEffect(() => {
    void bring();
    let last = rig.words;
    return rig.watch(() => {
      if (last === rig.words) return;
      last = rig.words;
      rig.panels.get(id)?.sceneChanged?.();
      rig.panels.get(id)?.played?.();
      ask();
    });
  }, []);
  useEffect(() => {
    if (follows && rig.panels.has(id) && asked.current !== rig.words) ask();
  }, [follows]);
  return html`<div id=${id} class=${follows === undefined ? '' : 'follows'}>
    <div id=${`${id}-body`} ref=${place} />
    ${failed && html`<p class="muted">This part did not load. <${Nodes} nodes=${[retryButton(() => void bring())]} /></p>`}
  </div>`;
}
