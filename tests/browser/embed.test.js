// Panels alone, in frames of pages that are not ours.

import { createServer } from 'node:http';
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { violations } from './axe.js';
import { Stage, changedRun, numbers, reachImpact, showChart } from './stage.js';

const stage = await Stage.open();

/** Every panel, and what is there once it is. */
const SIGNS = {
  scene: '.readout:has-text("bounce 2")',
  'plane-angle': '.readout:has-text("n 2")',
  'plane-velocity': '.readout:has-text("n 2")',
  energy: '.readout:has-text("n 2")',
  circle: '.readout:has-text("κ 1.100")',
  map: '#map-box[aria-busy=false] canvas',
  survival: '#survival-told:has-text("outlast")',
  ladder: '.rungs td',
  design: '#design-sheet svg',
  catch: '#catch-sheet svg',
  branch: '#branch-body svg.figure',
  precision: '#precision-told:has-text("Measured over")',
  paper: '.compared',
  reading: 'article',
  calls: '.call',
  gallery: 'article',
};

test('the contract names every panel', async () => {
  const { paths } = await (await fetch(`${stage.url}openapi.json`)).json();
  assert.deepEqual(paths['/embed/{panel}'].get.parameters[0].schema.examples.toSorted(), Object.keys(SIGNS).toSorted());
});

for (const [id, sign] of Object.entries(SIGNS)) {
  test(`the panel ${id} stands alone`, async () => {
    const { page, clean } = await stage.page('?preset=case-1&speed=2', {
      path: `embed/${id}`,
      sign,
      viewport: { width: 480, height: 360 },
    });
    assert.deepEqual(
      await page.evaluate(() => [
        document.documentElement.scrollWidth - innerWidth,
        document.documentElement.scrollHeight - innerHeight,
      ]),
      [0, 0],
    );
    assert.equal(await page.locator('.card').count(), 1);
    assert.deepEqual(await violations(page, 'html', { rules: { 'page-has-heading-one': { enabled: false } } }), []);
    clean();
  });
}

test('a frame of another origin holds a panel, and not the page', async () => {
  const host = createServer((_, response) => {
    response.setHeader('content-type', 'text/html');
    response.end(
      `<iframe name="panel" src="${stage.url}embed/plane-angle?preset=case-1"></iframe><iframe name="whole" src="${stage.url}"></iframe>`,
    );
  }).listen(0, '127.0.0.1');
  await new Promise((resolve) => host.once('listening', resolve));
  const { page } = await stage.page('', { path: 'health/live', sign: 'body' });
  await page.goto(`http://127.0.0.1:${host.address().port}/`);
  await page.frame('panel').locator('.readout', { hasText: 'n 2' }).waitFor();
  assert.equal(await page.frame('whole').locator('#case').count(), 0);
  host.close();
});

test('the copied frame shows the run of the page', async () => {
  const { page, clean } = await changedRun(stage);
  await showChart(page, 'plane-angle');
  await page.click('#plane-angle .enlarge');
  await page.locator('dialog.large').getByRole('button', { name: 'Copy embed' }).click();
  const code = await page.evaluate(() => navigator.clipboard.readText());
  const source = await page.evaluate(
    (html) => new DOMParser().parseFromString(html, 'text/html').querySelector('iframe').src,
    code,
  );
  await page.keyboard.press('Escape');
  const shown = await numbers(page, 'plane-angle');
  const other = await stage.page(source.slice(stage.url.length), { sign: '.readout:has-text("n ")' });
  await reachImpact(other.page, shown.length);
  assert.deepEqual(await numbers(other.page, 'plane-angle'), shown);
  clean();
  other.clean();
});

test('a panel that there is not, and an address that is not whole, are told', async () => {
  const { page, clean } = await stage.page('?preset=case-99&colour=blue', { path: 'embed/rocket', sign: '.card' });
  assert.match(await page.locator('.card').innerText(), /no panel “rocket”.*plane-angle/s);
  assert.match(await page.locator('.notice').innerText(), /case-99.*colour/s);
  clean();
});
