// Brings the strip of pinned runs.

import { updateAddressSoon } from '../app/address-bar.js';
import { playedQuery } from '../app/queries.js';
import { restart, start } from '../app/run-actions.js';
import { play } from '../app/scenes.js';
import { byId } from '../dom/elements.js';
import { styles } from '../panels/card.js';
import { Pins } from './pins.js';

/** @param {import('../app/page.js').Page} page @param {import('../timeline/others.js').Others} others */
export async function bringPins(page, others) {
  await styles('pins/pins.css').catch(() => {});
  const { run, fields, cases, timeline } = page;
  const pins = new Pins(byId('pins'), {
    fields,
    cases,
    run,
    others,
    typed: () => page.typed ?? {},
    played: () => {
      const query = playedQuery(page);
      return query && { query, scene: structuredClone(run.released ?? page.typed ?? {}) };
    },
    bringBack: (pin) => {
      play(page, pin.scene);
      if (pin.interventions.length === 0) return;
      const query = new URLSearchParams(pin.query);
      query.set('speed', String(page.speed));
      run.start(query);
    },
    drop: () => {
      if (run.phase === 'idle') start(page);
      else restart(page);
    },
    record: (label) => page.history?.record(label),
    changed: () => updateAddressSoon(page),
  });
  timeline?.listeners.add(() => pins.moved());
  page.pins = pins;
  return pins;
}
