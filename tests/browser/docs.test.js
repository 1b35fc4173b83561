// The contract's viewer: drawn and tried under the server's own content security policy, with nothing from elsewhere.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage } from './stage.js';

const stage = await Stage.open();

const viewer = (hash = '') => stage.page(hash, { path: 'docs', sign: '.opblock' });

test('every operation of the contract is drawn, and nothing comes from elsewhere', async () => {
  const { page, clean } = await viewer();
  const contract = await (await fetch(`${stage.url}openapi.json`)).json();
  const methods = ['get', 'head', 'post'];
  const operations = Object.values(contract.paths).flatMap((item) => methods.filter((method) => item[method]));
  assert.equal(await page.locator('.opblock').count(), operations.length);
  clean();
});

test('an operation is tried with nothing but what was typed', async () => {
  const { page, clean } = await viewer('#/Compute/getTrajectory');
  await page.locator('.try-out__btn').click();
  const answered = page.waitForResponse((response) => response.url().includes('/v1/trajectories'));
  await page.locator('.execute').click();
  const answer = await answered;
  assert.equal(new URL(answer.url()).search, '?preset=case-1');
  assert.equal(answer.status(), 200);
  clean();
});

test('a problem is found by the address in its type', async () => {
  const { page, clean } = await viewer('#problem-over-budget');
  const problem = page.locator('#problem-over-budget');
  await page.waitForFunction(() => scrollY > 0);
  assert.ok(await problem.isVisible());
  const box = await problem.boundingBox();
  assert.ok(box && box.y >= 0 && box.y < 860, JSON.stringify(box));
  clean();
});

test('the viewer fits a narrow screen', async () => {
  const { page, clean } = await viewer();
  await page.setViewportSize({ width: 320, height: 640 });
  const width = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(width <= 320, `${width} px wide`);
  clean();
});
