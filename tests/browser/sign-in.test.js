// The page that asks for the token, of a server that has one.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { violations } from './axe.js';
import { Stage } from './stage.js';

const TOKEN = '0123456789abcdef0123456789abcdef';
const stage = await Stage.open(undefined, ['--token', TOKEN]);

for (const width of [320, 1280])
  test(`a person gives the token and comes to the address asked for, at ${width} px`, async () => {
    const address = '?preset=case-2&scene.table.tilt_gain=1.2';
    const { page, clean } = await stage.page(address, {
      sign: '#token',
      viewport: { width, height: 700 },
    });
    assert.deepEqual(await violations(page), []);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth), 0);
    assert.equal(await page.evaluate(() => document.activeElement.id), 'token');
    await page.fill('#token', TOKEN.slice(1));
    await page.keyboard.press('Enter');
    await page.locator('.wrong', { hasText: 'not the token' }).waitFor();
    assert.deepEqual(await violations(page), []);
    await page.fill('#token', TOKEN);
    await page.click('button');
    await page.locator('#case:enabled').waitFor();
    assert.equal(page.url(), stage.url + address);
    assert.doesNotMatch(JSON.stringify(await page.evaluate(() => history.length + location.href)), /0123/);
    clean(/401/);
  });

test('a panel asks as well, in a frame too', async () => {
  const { page } = await stage.page('?preset=case-1', { path: 'embed/map', sign: '#token' });
  await page.fill('#token', TOKEN);
  await page.keyboard.press('Enter');
  await page.locator('#map-box').waitFor();
  assert.equal(page.url(), `${stage.url}embed/map?preset=case-1`);
});
