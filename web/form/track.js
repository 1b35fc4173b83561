// A slider on a track that can show what is known of its values: a mark, and whether a run survives at each of them.

import { h } from '../dom/elements.js';

/** @typedef {{from: number, to: number, outcomes: (boolean | null)[]}} Known true where a run survives, null where there is no such scene */

export class Track {
  element;
  slider;
  #map = h('span', { class: 'track-map', 'aria-hidden': 'true', hidden: true });
  #mark = h('span', { class: 'track-mark', 'aria-hidden': 'true', hidden: true });
  /** The marked value in the slider's numbers. @type {number | null} */
  #marked = null;
  /** @type {Known | null} */
  #known = null;
  /** Words on the mark and the map, for those who do not see them. */
  #words = h('span', { class: 'unseen' });
  #markWords = '';
  #mapWords = '';

  /** Takes the place of a slider and holds it. @param {HTMLInputElement} slider */
  constructor(slider) {
    this.slider = slider;
    this.element = h('span', { class: 'track' });
    slider.replaceWith(this.element);
    this.#words.id = `${slider.id}-track`;
    this.element.append(
      this.#map,
      h('span', { class: 'track-rail', 'aria-hidden': 'true' }),
      this.#mark,
      slider,
      this.#words,
    );
    const described = slider.getAttribute('aria-describedby');
    slider.setAttribute('aria-describedby', [described, this.#words.id].filter(Boolean).join(' '));
  }

  /** The range of the slider, where its ends are. */
  get range() {
    return { from: Number(this.slider.min), to: Number(this.slider.max) };
  }

  /** An empty track without a thumb: the field has no value. @param {boolean} hollow */
  set hollow(hollow) {
    this.element.classList.toggle('hollow', hollow);
    this.slider.disabled = hollow;
  }

  /**
   * Marks a value; null for none.
   * @param {number | null} value in the slider's numbers
   * @param {string | Node} label
   * @param {string} words
   */
  mark(value, label = '', words = '') {
    this.#marked = value;
    this.#markWords = value === null ? '' : words;
    this.#mark.replaceChildren(h('span', {}, label));
    this.refresh();
  }

  /**
   * Lays a map behind the slider; null takes it away.
   * @param {Known | null} known
   * @param {string} words
   */
  know(known, words = '') {
    this.#known = known;
    this.#mapWords = known ? words : '';
    this.refresh();
  }

  /** Draws mark and map where they belong, once the range of the slider or they themselves have changed. */
  refresh() {
    const { from, to } = this.range;
    const seen = this.#marked !== null && this.#marked >= from && this.#marked <= to;
    this.#mark.hidden = !seen;
    if (seen) this.#mark.style.setProperty('--at', String((Number(this.#marked) - from) / (to - from)));
    const fits = this.#known !== null && this.#known.from === from && this.#known.to === to;
    this.#map.hidden = !fits;
    this.element.classList.toggle('known', fits);
    if (fits && this.#known) this.#map.replaceChildren(...runsOf(this.#known.outcomes));
    this.#words.textContent = [seen && this.#markWords, fits && this.#mapWords].filter(Boolean).join(' ');
  }
}

/** One element for neighbours of the same outcome, as wide as they are many. @param {(boolean | null)[]} outcomes */
function runsOf(outcomes) {
  const elements = [];
  for (let begin = 0; begin < outcomes.length; ) {
    const kind = outcomes[begin];
    let end = begin + 1;
    while (end < outcomes.length && outcomes[end] === kind) end += 1;
    const run = h('span', { class: kind === null ? 'none' : kind ? 'survives' : 'falls' });
    run.style.flexGrow = String(end - begin);
    elements.push(run);
    begin = end;
  }
  return elements;
}
