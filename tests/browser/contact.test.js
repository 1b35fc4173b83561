// The strike in the scene with its symbols: what the contact did and where, against the impacts of the API.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, impacts as reached, ink, reachImpact, plain, startPaused } from './stage.js';

const stage = await Stage.open();
/** The page with symbols, paused before its first strike. */
async function open(query) {
  const opened = await stage.page(query, { stored: { symbols: 'on' } });
  const { page } = opened;
  await startPaused(page);
  return opened;
}

test('an early strike with friction is shown where and as what it was', async () => {
  const query = 'preset=case-1-noise&scene.contact.friction=0.3&scene.contact.restitution=0.8&scene.release.theta=0.1';
  const { impacts } = await (await fetch(`${stage.url}v1/trajectories?${query}&bounces=9`)).json();
  const { page, clean } = await open(`?${query}&speed=0.05`);
  for (let k = 0; k < 2; k += 1) {
    const n = (await reached(page)) + 1;
    await page.click('#step');
    await reachImpact(page, n);
    await page.waitForFunction(
      (wanted) =>
        document.querySelector('#scene-readout').textContent.replaceAll('\u00a0', ' ').includes(`bounce ${wanted} `),
      n,
    );
    const words = plain(await page.locator('#scene-readout').innerText());
    assert.ok(words.includes(`contact: ${impacts.contact_mode[n - 1].replace('_', ' ')}`), words);
    const shown = Number(/struck at (-?[\d.]+) m/.exec(words)[1]);
    assert.ok(Math.abs(shown - impacts.clearance[n - 1]) < 1e-4, `${shown} ${impacts.clearance[n - 1]}`);
    // The rod is drawn at the height where it was struck.
    const y = Number(/ y (-?[\d.]+) m/.exec(words)[1]);
    const l = 2 / 15;
    assert.ok(Math.abs(y - l * Math.cos(impacts.theta[n - 1]) - impacts.clearance[n - 1]) < 1e-4, words);
  }
  assert.ok((await ink(page, '#scene-frame', '--strike')) > 40, 'the impulse');
  assert.ok((await ink(page, '#scene-frame', '--good')) > 40, 'friction');
  clean();
});

test('a strike without friction at y = 0 has neither', async () => {
  const { page, clean } = await open('?preset=case-1&speed=0.05');
  await page.click('#step');
  await reachImpact(page, 1);
  assert.doesNotMatch(await page.locator('#scene-readout').innerText(), /contact|struck/);
  assert.ok((await ink(page, '#scene-frame', '--strike')) > 40);
  assert.equal(await ink(page, '#scene-frame', '--good'), 0);
  clean();
});
