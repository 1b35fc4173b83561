// The panel of the paper's printed values beside the computed ones.

import { table } from '../../dom/tables.js';
import { h } from '../../dom/elements.js';
import { prose, symbol } from '../../dom/typeset.js';
import { quantity } from '../../dom/numbers.js';

/** @typedef {import('contract').Quantity} PaperValue */

/** True when the printed value is the computed one to the printed digits. @param {PaperValue['value']} printed @param {PaperValue['value']} computed */
function same(printed, computed) {
  if (printed === null || computed === null) return true;
  if (typeof printed === 'string' || typeof computed === 'string') return printed === computed;
  const decimals = (String(printed).split('.')[1] ?? '').length;
  return Math.abs(printed - computed) <= 0.5000001 * 10 ** -decimals;
}

/** @type {import('../card.js').Module['mount']} */
export function mount(root, { chosen }) {
  const sceneChanged = () => show(root, chosen());
  sceneChanged();
  return { sceneChanged };
}

/** @param {HTMLElement} root @param {import('contract').Preset | null} chosen */
function show(root, chosen) {
  if (!chosen || chosen.computed.length === 0) {
    root.replaceChildren(
      h(
        'p',
        { class: 'muted' },
        chosen ? 'The paper prints no number for this case.' : 'Choose a case to compare it with the paper.',
      ),
    );
    return;
  }
  const rows = chosen.computed.flatMap((computed, index) => {
    const printed = chosen.printed[index];
    const differs = Boolean(computed.why) || !same(printed?.value ?? null, computed.value);
    const words = computed.quantity.replaceAll(/[._]/g, ' ');
    const name = h(
      'th',
      { scope: 'row' },
      computed.symbol ? symbol(computed.symbol) : words,
      computed.symbol ? h('span', { class: 'muted name' }, words) : '',
    );
    const row = h(
      'tr',
      { class: differs ? 'differs' : '' },
      name,
      cell(printed),
      cell(computed),
      h('td', {}, printed?.value == null ? '' : differs ? '≠' : '='),
    );
    return computed.why
      ? [
          row,
          h(
            'tr',
            { class: 'why' },
            h('td', { colspan: 4 }, ...prose(computed.why[0].toUpperCase() + computed.why.slice(1))),
          ),
        ]
      : [row];
  });
  root.replaceChildren(
    table(
      'Printed and computed values',
      ['Quantity', 'Printed', 'Computed', h('span', { class: 'unseen' }, 'Equal')],
      h('tbody', {}, ...rows),
      'paper',
    ),
  );
}

/** @param {PaperValue | undefined} value */
function cell(value) {
  return h(
    'td',
    {},
    typeof value?.value === 'string' ? value.value : quantity(value?.value, value?.unit ?? '', 5),
    h('span', { class: 'muted where' }, value?.where ?? ''),
  );
}
