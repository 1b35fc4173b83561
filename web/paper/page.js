// The paper as one page to read: its chapters, each asked for when it comes near, and the contents beside them.

import { get, wordsOf } from '../api/client.js';
import { byId, h, retryButton } from '../dom/elements.js';
import { brokenLinkNotice, notice } from '../dom/notices.js';
import { knowTitles } from '../dom/typeset.js';
import { card } from '../panels/card.js';
import { words } from '../panels/parts.js';
import { sceneOf, scenePage } from '../panels/scene-page.js';
import { html, render, useEffect, useRef, useState } from '../vendor/preact/preact.js';
import { CHAPTERS, PANEL_CHAPTERS, head } from './chapters.js';
import { whenNear } from './words.js';

/** @typedef {import('./words.js').Context} Context */

/** The reader has gone elsewhere than the address. */
let moved = false;
for (const kind of ['wheel', 'pointerdown', 'keydown', 'touchstart'])
  addEventListener(kind, () => (moved = true), { once: true, passive: true });

/** Brings what the address names into view, again with each chapter that came above it. */
function arrive() {
  const wanted = location.hash.slice(1);
  if (wanted && !moved) document.getElementById(wanted)?.scrollIntoView();
}

/** @param {{chapter: typeof CHAPTERS[number], context: Context, listed: (contents: [string, string][]) => void}} props */
function Chapter({ chapter, context, listed }) {
  const place = useRef(/** @type {HTMLElement | null} */ (null));
  const [body, show] = useState(
    /** @type {unknown} */ (html`<p class="muted" role="status">It is being computed…</p>`),
  );
  const ask = () =>
    void chapter.load(context).then(
      (loaded) => {
        show(loaded.body);
        listed(loaded.contents);
      },
      (error) =>
        show(html`<p role="status">${wordsOf(error)}</p><button type="button" onClick=${ask}>Try again</button>`),
    );
  // A link into a chapter needs all that stands above its place.
  useEffect(() => (location.hash ? ask() : whenNear(place.current, ask)), []);
  useEffect(arrive, [body]);
  return html`<section id=${chapter.id} class="chapter" aria-labelledby=${`${chapter.id}-title`} ref=${place}>
    ${head(chapter)} ${body}
  </section>`;
}

/** Panels on one scene, which the reader chooses. @param {{context: Context, asked: ReturnType<typeof sceneOf>}} props */
function Panels({ context: { fields, cases }, asked }) {
  const place = useRef(/** @type {HTMLElement | null} */ (null));
  useEffect(() => {
    let shown = asked;
    /** @type {import('../panels/card.js').Panel[]} */
    const panels = [];
    const changed = () => {
      const query = new URLSearchParams(shown.query);
      for (const panel of panels) for (const [key, value] of panel.query?.() ?? []) query.append(key, value);
      history.replaceState(null, '', `?${query}${location.hash}`);
    };
    const page = scenePage(fields, () => shown, changed);
    const chooser = h(
      'select',
      {
        id: 'scene',
        change: () => {
          shown = sceneOf(chooser.value, fields, cases);
          changed();
          for (const panel of panels) panel.sceneChanged?.();
        },
      },
      asked.chosen ? null : h('option', { value: location.search }, 'The scene of the address'),
      ...cases.map(({ name, title }) => h('option', { value: `?preset=${name}` }, title)),
    );
    chooser.value = asked.chosen ? `?preset=${asked.chosen.name}` : location.search;
    place.current?.append(
      h('p', { class: 'chosen' }, h('label', { for: 'scene' }, 'The scene of the next two chapters '), chooser),
    );
    for (const entry of PANEL_CHAPTERS) {
      const { element, bring } = card(
        entry,
        page,
        () => asked.link.panels,
        (panel) => {
          panels.push(panel);
          const dropped = panel.restore?.(asked.link.panels) ?? [];
          if (dropped.length > 0) brokenLinkNotice(entry.id, dropped);
        },
      );
      element.classList.add('chapter');
      place.current?.append(element);
      whenNear(element, () => void bring().then(arrive));
    }
  }, []);
  return html`<div ref=${place} />`;
}

/** @param {{context: Context, asked: ReturnType<typeof sceneOf>}} props */
function Text({ context, asked }) {
  const [contents, list] = useState(/** @type {Record<string, [string, string][]>} */ ({}));
  useEffect(() => {
    const line = (/** @type {string} */ anchor, /** @type {string} */ title) =>
      html`<a href=${`#${anchor}`}>${words(title)}</a>`;
    const chapters = [...CHAPTERS, ...PANEL_CHAPTERS];
    const lines = chapters.map(
      ({ id, title }) => html`<li>
        ${line(id, title)}
        ${contents[id]?.length > 0 && html`<ol>${contents[id].map((one) => html`<li>${line(...one)}</li>`)}</ol>`}
      </li>`,
    );
    render(html`<ol>${lines}</ol>`, byId('contents'));
  }, [contents]);
  return html`${CHAPTERS.map(
    (chapter) => html`<${Chapter}
      key=${chapter.id}
      chapter=${chapter}
      context=${context}
      listed=${(/** @type {[string, string][]} */ sections) => list((before) => ({ ...before, [chapter.id]: sections }))}
    />`,
  )}
  <${Panels} context=${context} asked=${asked} />`;
}

async function begin() {
  const [{ items: fields }, { items: cases }] = await Promise.all([get('v1/fields'), get('v1/scenes')]);
  knowTitles(fields);
  const asked = sceneOf(location.search, fields, cases);
  if (asked.link.dropped.length > 0) brokenLinkNotice('link', asked.link.dropped);
  const root = h('div');
  byId('text').append(root);
  render(html`<${Text} context=${{ fields, cases, chosen: null }} asked=${asked} />`, root);
}

begin().catch((error) => {
  const again = retryButton(() => location.reload());
  notice('server', [wordsOf(error), ' ', again], { dismissible: false, caution: true });
});
