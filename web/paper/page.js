// The paper as one page to read: its chapters, each asked for when it comes near, and the contents beside them.

import { arrive } from '../app/arrive.js';
import { byId, h } from '../dom/elements.js';
import { card, entriesOf } from '../panels/card.js';
import { words } from '../panels/parts.js';
import { Cases, ScenePage, begin } from '../panels/scene-page.js';
import { html, render } from '../vendor/preact/preact.js';
import { whenNear } from './contents.js';

const CHAPTERS = entriesOf('paper');
/** The first of the chapters that ask about one scene. */
const SCENIC = 'precision';

/** Lists the chapters, the first with its sections. @param {string[][]} sections as anchors and titles */
function listContents(sections) {
  const lines = (/** @type {string[][]} */ places, /** @type {unknown} */ below) => html`<ol>
    ${places.map(([anchor, title], index) => html`<li><a href=${`#${anchor}`}>${words(title)}</a>${index === 0 && below}</li>`)}
  </ol>`;
  const chapters = CHAPTERS.map(({ id, title }) => [id, title]);
  render(lines(chapters, sections.length > 0 && lines(sections, null)), byId('contents'));
}

begin((fields, cases) => {
  const page = new ScenePage('paper', fields, cases);
  page.read(location.search);
  page.followHistory();
  const chapters = CHAPTERS.map((entry) => {
    const { element, draw } = card(entry);
    element.classList.add('chapter');
    const now = () => draw(page, { every: true, listed: listContents });
    const begun = () => {
      now();
      page.addEventListener('change', now);
    };
    // A link into a chapter needs all that stands above its place.
    if (location.hash) begun();
    else whenNear(element, begun);
    return element;
  });
  const scene = h('div');
  render(
    html`<${Cases} page=${page} id="scene" label="The scene of the next two chapters" own="the scene of the address" />`,
    scene,
  );
  chapters.splice(
    CHAPTERS.findIndex(({ id }) => id === SCENIC),
    0,
    scene,
  );
  const root = h('div', {}, ...chapters);
  byId('text').append(root);
  listContents([]);
  arrive(root);
});
