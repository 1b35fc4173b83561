// The glossary: what a word or a symbol means is a click or a key away, and no pointer is needed for it.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { violations } from './axe.js';
import { Stage, openPanel, verdict } from './stage.js';

const stage = await Stage.open();
const plain = (text) => text.replace(/[\u00a0\u202f]/g, ' ');

/** Orbits have terms of the glossary in their answer. */
async function open(options) {
  const opened = await stage.page('?preset=case-1', options);
  await verdict(opened.page);
  await openPanel(opened.page, 'branch');
  await opened.page.locator('#branch-body .term').first().waitFor();
  return opened;
}
const term = (page) => page.locator('#branch-body [data-term=soft]');
const inside = (page) =>
  page.locator('#glossary').evaluate((note) => {
    const { left, top, right, bottom } = note.getBoundingClientRect();
    return left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight;
  });

test('keys open an explanation and close it, and the focus stays with the word', async () => {
  const { page, clean } = await open();
  await term(page).focus();
  await page.keyboard.press('Enter');
  await page.locator('#glossary', { hasText: 'small swing' }).waitFor();
  assert.equal(await term(page).getAttribute('aria-expanded'), 'true');
  assert.equal(await page.evaluate(() => document.activeElement.id), 'glossary', 'which is read aloud then');
  await page.keyboard.press('Escape');
  await page.locator('#glossary').waitFor({ state: 'hidden' });
  assert.equal(await page.evaluate(() => document.activeElement.dataset.term), 'soft');
  assert.equal(await term(page).getAttribute('aria-expanded'), 'false');
  clean();
});

test('a click opens one explanation at a time, and another click closes it', async () => {
  const { page, clean } = await open();
  await term(page).click();
  await page.locator('#glossary', { hasText: 'Soft boundary' }).waitFor();
  await page.locator('#branch-body [data-term=orbit]').first().click();
  await page.locator('#glossary', { hasText: 'Periodic orbit' }).waitFor();
  assert.equal(await page.locator('.glossary').count(), 1);
  assert.equal(await term(page).getAttribute('aria-expanded'), 'false');
  await page.locator('#branch-body [data-term=orbit]').first().click();
  await page.locator('#glossary').waitFor({ state: 'hidden' });
  await term(page).click();
  await page.locator('#glossary').waitFor();
  await page.mouse.click(5, 400);
  await page.locator('#glossary').waitFor({ state: 'hidden' });
  clean();
});

test('an open explanation is inside the window and accessible, on a phone as well', async () => {
  const { page, clean } = await open();
  for (const width of [1280, 320]) {
    await page.setViewportSize({ width, height: 800 });
    for (const name of ['soft', 'kappa-critical', 'orbit']) {
      await page.locator(`#branch-body [data-term=${name}]`).first().click();
      await page.locator('#glossary').waitFor();
      assert.ok(await inside(page), name);
    }
    assert.deepEqual(await violations(page, { include: ['#studies', '#glossary'] }), []);
    await page.keyboard.press('Escape');
  }
  clean();
});

test('it works in a panel at its largest too', async () => {
  const { page, clean } = await open();
  await page.click('#branch .enlarge');
  const dialog = page.locator('dialog.large');
  await dialog.waitFor();
  await dialog.locator('[data-term=soft]').click();
  await dialog.locator('#glossary', { hasText: 'small swing' }).waitFor();
  assert.match(plain(await dialog.locator('#glossary').innerText()), /^Soft boundary/);
  await page.keyboard.press('Escape');
  await page.locator('#glossary').waitFor({ state: 'hidden' });
  assert.equal(await dialog.count(), 1, 'the panel stays large');
  await page.keyboard.press('Escape');
  await dialog.waitFor({ state: 'detached' });
  clean();
});
