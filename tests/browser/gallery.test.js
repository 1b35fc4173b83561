// The failure gallery: its cards say what the server says, and run what they tell of.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, openPanel, reachImpact, verdict } from './stage.js';

const stage = await Stage.open();

async function open(options = {}) {
  const opened = await stage.page('?preset=case-1', options);
  await openPanel(opened.page, 'gallery');
  await opened.page.locator('article').first().waitFor();
  return opened;
}

const failures = async () => (await (await fetch(`${stage.url}v1/failures`)).json()).failures;
/** Symbols are set as such, so only the letters and digits are compared. */
const letters = (text) => text.toLowerCase().replace(/[^a-z0-9]+/g, '');

test('nothing of the gallery is loaded before it comes near', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await verdict(page);
  assert.equal(
    await page.evaluate(
      () => performance.getEntriesByType('resource').filter(({ name }) => /gallery|failures/.test(name)).length,
    ),
    0,
  );
  clean();
});

/** Unfolds every case. */
const unfold = (page) =>
  page.locator('article details').evaluateAll((all) => {
    for (const details of all) details.open = true;
  });

test('every case is a line of its own at first, all of them within a screen', async () => {
  const { page, clean } = await open();
  const all = await failures();
  const lines = page.locator('article summary');
  assert.equal(await lines.count(), all.length);
  assert.equal(await page.locator('article .says').filter({ visible: true }).count(), 0);
  for (const [index, { title, method, says }] of all.entries()) {
    const text = letters(await lines.nth(index).innerText());
    const wrong = says.filter(({ right }) => !right).length;
    for (const words of [title, method, `${wrong} of ${says.length} wrong`])
      assert.ok(text.includes(letters(words)), `${title}: ${words}`);
  }
  assert.ok((await page.locator('.failures').boundingBox()).height < 800);
  clean();
});

test('a link opens one case, and the address says which is open', async () => {
  const all = await failures();
  const { page, clean } = await stage.page(`?preset=case-1&gallery.case=${all[2].name}`);
  const wanted = page.locator(`details[data-case="${all[2].name}"]`);
  await wanted.locator('.truth').waitFor();
  assert.equal(await page.locator('article details[open]').count(), 1);
  await page.locator('article summary').first().focus();
  await page.keyboard.press('Enter');
  await page.waitForFunction((name) => location.search.includes(`gallery.case=${name}`), all[0].name);
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => !location.search.includes('gallery.case'));
  clean();
  const gone = await stage.page('?preset=case-1&gallery.case=nonsense');
  await gone.page.locator('#gallery-body', { hasText: 'the case “nonsense”' }).waitFor();
  gone.clean();
});

test('every case has its card, with right and wrong in words', async () => {
  const { page, clean } = await open();
  await unfold(page);
  const all = await failures();
  const cards = page.locator('article');
  assert.equal(await cards.count(), all.length);
  for (const [index, { title, why, says, truth }] of all.entries()) {
    const card = cards.nth(index);
    const text = letters(await card.innerText());
    for (const words of [
      title,
      why,
      truth.verdict,
      truth.detail,
      ...says.flatMap(({ method, verdict: claim, detail }) => [method, claim, detail]),
    ]) {
      assert.ok(text.includes(letters(words)), `${title}: ${words}`);
    }
    const rows = await card.locator('.says li').allInnerTexts();
    assert.deepEqual(
      rows.map((row) => (/(right|wrong)\n/.exec(row) ?? [])[1]),
      says.map(({ right }) => (right ? 'right' : 'wrong')),
    );
    assert.deepEqual(
      rows.map((row) => row[0]),
      says.map(({ right }) => (right ? '✓' : '✗')),
    );
  }
  clean();
});

for (const colorScheme of ['light', 'dark']) {
  test(`the pictures are there, ${colorScheme}`, async () => {
    const { page, clean } = await open({ colorScheme });
    await unfold(page);
    for (const image of await page.locator('article img').all()) {
      await image.scrollIntoViewIfNeeded();
      await image.evaluate((element) => element.decode());
      assert.ok(
        await image.evaluate(
          (element) =>
            element.naturalWidth > 300 &&
            Math.abs(element.naturalWidth / element.naturalHeight - element.clientWidth / element.clientHeight) < 0.02,
        ),
      );
    }
    clean();
  });
}

test('a card loads its scene and runs it, and Back returns', async () => {
  const { page, clean } = await open();
  const all = await failures();
  const index = all.findIndex(({ scene }) => scene.table.tilt_gain !== 1.1);
  await page.locator('article summary').nth(index).click();
  await page.locator('article').nth(index).getByRole('button', { name: 'Load and run' }).click();
  await reachImpact(page, 1);
  const { scene } = all[index];
  const query = new URLSearchParams(new URL(page.url()).search);
  assert.equal(Number(query.get('scene.table.tilt_gain')), scene.table.tilt_gain);
  assert.equal(Number(query.get('scene.release.theta')), scene.release.theta);
  assert.equal(await page.evaluate(() => document.activeElement.id), 'case');
  await page.focus('#field-table-tilt_gain');
  assert.equal(Number(await page.inputValue('#field-table-tilt_gain')), scene.table.tilt_gain);
  assert.ok(
    await page
      .locator('#run-state')
      .evaluate(
        (element) => element.getBoundingClientRect().top >= 0 && element.getBoundingClientRect().bottom < innerHeight,
      ),
  );
  await page.goBack();
  await page.waitForFunction(() => document.querySelector('#case').value === 'case-1');
  assert.equal(await page.inputValue('#field-table-tilt_gain'), '1.1');
  clean();
});

test('what a card asks the server is answered', async () => {
  const { page } = await open();
  for (const href of await page.locator('article .actions a').evaluateAll((links) => links.map((link) => link.href)))
    assert.ok((await fetch(href)).ok, href);
});

test('without a server the gallery says so and can be asked for again', async () => {
  const { page } = await stage.page('?preset=case-1', {
    prepare: () => {
      const real = globalThis.fetch;
      globalThis.refuse = true;
      globalThis.fetch = (input, init) =>
        globalThis.refuse && String(input).includes('failures')
          ? Promise.reject(new TypeError('no network'))
          : real(input, init);
    },
  });
  await openPanel(page, 'gallery');
  await page.locator('#gallery-body', { hasText: 'The server does not answer' }).waitFor();
  await page.evaluate(() => {
    globalThis.refuse = false;
  });
  await page.locator('#gallery-body button').click();
  await page.locator('article').first().waitFor();
});

test('a part that cannot be loaded says so and can be tried again', async () => {
  const { page, context } = await stage.page('?preset=case-1');
  await context.route('**/panels/gallery/gallery.css', (route) => route.abort());
  await openPanel(page, 'gallery');
  await page.locator('#gallery-body', { hasText: 'did not load' }).waitFor();
  await context.unroute('**/panels/gallery/gallery.css');
  await page.locator('#gallery-body button').click();
  await page.locator('article').first().waitFor();
});
