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
/** The note that is open. */
const NOTE = '.glossary:popover-open';
const term = (page) => page.locator('#branch-body [data-term=soft]');
const inside = (page) =>
  page.locator(NOTE).evaluate((note) => {
    const { left, top, right, bottom } = note.getBoundingClientRect();
    return left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight;
  });

test('keys open an explanation and close it, and the focus stays with the word', async () => {
  const { page, clean } = await open();
  await term(page).focus();
  await page.keyboard.press('Enter');
  await page.locator(NOTE, { hasText: 'small swing' }).waitFor();
  await page.locator('#branch-body [data-term=soft][aria-expanded=true]').waitFor();
  assert.equal(await page.evaluate(() => document.activeElement.id), 'glossary-soft', 'which is read aloud then');
  await page.keyboard.press('Escape');
  await page.locator(NOTE).waitFor({ state: 'hidden' });
  assert.equal(await page.evaluate(() => document.activeElement.dataset.term), 'soft');
  await page.locator('#branch-body [data-term=soft][aria-expanded=false]').waitFor();
  clean();
});

test('a click opens one explanation at a time, and another click closes it', async () => {
  const { page, clean } = await open();
  await term(page).click();
  await page.locator(NOTE, { hasText: 'Soft boundary' }).waitFor();
  await page.locator('#branch-body [data-term=orbit]').first().click();
  await page.locator(NOTE, { hasText: 'Periodic orbit' }).waitFor();
  assert.equal(await page.locator(NOTE).count(), 1);
  await page.locator('#branch-body [data-term=soft][aria-expanded=false]').waitFor();
  await page.locator('#branch-body [data-term=orbit]').first().click();
  await page.locator(NOTE).waitFor({ state: 'hidden' });
  await term(page).click();
  await page.locator(NOTE).waitFor();
  await page.mouse.click(5, 400);
  await page.locator(NOTE).waitFor({ state: 'hidden' });
  clean();
});

test('an open explanation is inside the window and accessible, on a phone as well', async () => {
  const { page, clean } = await open();
  for (const width of [1280, 320]) {
    await page.setViewportSize({ width, height: 800 });
    for (const name of ['soft', 'kappa-critical', 'orbit']) {
      await page.locator(`#branch-body [data-term=${name}]`).first().click();
      await page.locator(NOTE).waitFor();
      assert.ok(await inside(page), name);
    }
    assert.deepEqual(await violations(page, { include: ['#studies', NOTE] }), []);
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
  await dialog.locator(NOTE, { hasText: 'small swing' }).waitFor();
  assert.match(plain(await dialog.locator(NOTE).innerText()), /^Soft boundary/);
  await page.keyboard.press('Escape');
  await page.locator(NOTE).waitFor({ state: 'hidden' });
  assert.equal(await dialog.count(), 1, 'the panel stays large');
  await page.keyboard.press('Escape');
  await dialog.waitFor({ state: 'detached' });
  clean();
});
