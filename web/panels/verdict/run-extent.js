// How far the run has gone: its largest angles and its way along x, taken impact by impact.

import { h } from '../../dom/elements.js';
import { number, quantity } from '../../dom/numbers.js';

const DIGITS = 3;

export class RunExtent {
  element = h('dl', { class: 'run-extent muted' });
  /** Impacts that are counted. */
  #end = 0;
  #theta = 0;
  #alpha = 0;
  #low = Infinity;
  #high = -Infinity;

  /** @param {import('../../run/impacts.js').Impacts} impacts */
  show(impacts) {
    if (impacts.end < this.#end) {
      [this.#end, this.#theta, this.#alpha] = [0, 0, 0];
      [this.#low, this.#high] = [Infinity, -Infinity];
    }
    for (let place = Math.max(impacts.begin, this.#end); place < impacts.end; place += 1) {
      const x = impacts.at('x', place);
      this.#theta = Math.max(this.#theta, Math.abs(impacts.at('theta', place)) || 0);
      this.#alpha = Math.max(this.#alpha, Math.abs(impacts.at('alpha', place)) || 0);
      this.#low = Math.min(this.#low, x);
      this.#high = Math.max(this.#high, x);
    }
    this.#end = impacts.end;
  }

  /** Writes the numbers in the unit of angles of now. */
  write() {
    const { element } = this;
    const rows =
      this.#end === 0
        ? []
        : [
            ['Angle', `up to ${quantity(this.#theta, 'rad', DIGITS)}`],
            ['Tilt of the table', `up to ${quantity(this.#alpha, 'rad', DIGITS)}`],
            ['Along x', `${number(this.#low, DIGITS)} to ${quantity(this.#high, 'm', DIGITS)}`],
          ];
    element.replaceChildren(...rows.map(([name, words]) => h('div', {}, h('dt', {}, name), h('dd', {}, words))));
  }
}
