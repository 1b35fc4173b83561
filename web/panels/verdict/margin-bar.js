// The tilt gain between the ends of its stable range, as a bar.

import { marginOf } from '../../api/margins.js';
import { h } from '../../dom/elements.js';
import { number } from '../../dom/numbers.js';
import { symbol } from '../../dom/typeset.js';

/** Part of the range that is drawn beyond each of its ends. */
const BEYOND = 0.25;

/** @param {import('contract').Stability} answer @returns {HTMLElement | string} */
export function marginBar(answer) {
  const { value = 0, below, above } = marginOf(answer, 'table.tilt_gain') ?? {};
  if (!below || !above || above.limit <= below.limit) return '';
  const [lower, critical] = [below.limit, above.limit];
  const place = (value - lower) / (critical - lower);
  const inside = place > 0 && place < 1;
  const shown = Math.max(-BEYOND, Math.min(1 + BEYOND, place));
  const mark = h('span', { class: `margin-mark ${inside ? 'inside' : 'outside'}` });
  mark.style.left = `${((shown + BEYOND) / (1 + 2 * BEYOND)) * 100}%`;
  const words = inside
    ? `${number(Math.min(below.margin, above.margin), 3)} from the nearer end`
    : `${number(-Math.min(below.margin, above.margin), 3)} beyond`;
  return h(
    'div',
    { class: 'margin' },
    h('span', { class: 'margin-value' }, symbol('κ'), ` ${number(value)}`),
    h(
      'div',
      {
        class: 'margin-track',
        role: 'img',
        'aria-label': `Stable from ${number(lower)} to ${number(critical)}; ${words}`,
      },
      h('span', { class: 'margin-range' }),
      mark,
      h('span', { class: 'margin-end low' }, number(lower)),
      h('span', { class: 'margin-end high' }, number(critical, 5)),
    ),
    h('span', { class: 'muted' }, words),
  );
}
