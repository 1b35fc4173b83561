// The bounces of the run among the reasons: its newest impacts as a table to copy, and the demand on the table beside its limits.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, changeUnderWay, enter, openTab, pausedRun, tool } from './stage.js';

const stage = await Stage.open();

/** A run of at least so many impacts, paused; the reasons are open. */
async function paused(query, impacts) {
  const opened = await pausedRun(stage, query, impacts);
  const { page } = opened;
  await openTab(page, 'why');
  await page.locator('#impacts').scrollIntoViewIfNeeded();
  await page.waitForFunction(() => document.querySelectorAll('#impacts tbody tr').length > 0);
  return opened;
}

const cells = (page) =>
  page
    .locator('#impacts tbody tr')
    .evaluateAll((rows) => rows.map((row) => [...row.children].map((cell) => cell.textContent.replace('−', '-'))));

test('the table has the impacts of the run, the newest first, in the unit that is shown', async () => {
  const { page, clean } = await paused('?preset=case-1', 12);
  const rows = await cells(page);
  const last = Number(rows[0][0]);
  assert.ok(last >= 12);
  const { impacts } = await (await fetch(`${stage.url}v1/trajectories?preset=case-1&bounces=${last}`)).json();
  for (const [index, row] of rows.entries()) {
    const at = last - 1 - index;
    assert.equal(Number(row[0]), impacts.n[at]);
    for (const [column, name] of [
      [1, 't'],
      [3, 'theta'],
      [7, 'alpha'],
    ])
      assert.ok(Math.abs(Number(row[column]) - impacts[name][at]) < 6e-5, `${name} of impact ${impacts.n[at]}`);
  }
  await tool(page, 'units');
  await page.locator('#impacts th', { hasText: 'θ / °' }).waitFor();
  const degrees = await cells(page);
  assert.ok(Math.abs(Number(degrees[0][3]) - (impacts.theta[last - 1] * 180) / Math.PI) < 6e-4);
  clean();
});

test('rows can be copied with their units and all digits, and all impacts saved', async () => {
  const { page, clean } = await paused('?preset=case-1', 5);
  const count = (await cells(page)).length;
  await page.click('#impacts-copy');
  await page.locator('#impacts-copy', { hasText: 'Copied' }).waitFor();
  const lines = (await page.evaluate(() => navigator.clipboard.readText())).split('\n');
  assert.equal(lines.length, count + 1);
  assert.match(lines[0], /^n\tt \/ s\tx \/ m\tθ \/ rad\t/);
  const { impacts } = await (await fetch(`${stage.url}v1/trajectories?preset=case-1&bounces=${count}`)).json();
  assert.equal(Number(lines[1].split('\t')[3]), impacts.theta[count - 1]);
  const download = page.waitForEvent('download');
  await page.click('#impacts-csv');
  assert.equal((await download).suggestedFilename(), 'equipoise-impacts.csv');
  clean();
});

test('a long run keeps 200 rows', async () => {
  const { page, clean } = await paused('?preset=case-1', 260);
  const rows = await cells(page);
  assert.equal(rows.length, 200);
  assert.equal(Number(rows[0][0]) - Number(rows[199][0]), 199);
  await page.locator('#impacts-told', { hasText: /The last 200 of \d+ impacts/ }).waitFor();
  clean();
});

test('the demand on the table stands beside its limits', async () => {
  const { page, clean } = await paused('?preset=case-1&scene.table.limits.tilt=0.5', 20);
  await page.locator('#demand-told', { hasText: 'Up to bounce' }).waitFor();
  const n = await page.locator('#impacts tbody td').first().innerText();
  await page.locator('#demand-told', { hasText: `Up to bounce ${n}.` }).waitFor();
  const answer = await (
    await fetch(`${stage.url}v1/trajectories?preset=case-1&scene.table.limits.tilt=0.5&bounces=${n}`)
  ).json();
  const { tilt } = answer.demand;
  const words = await page.locator('#demand tbody tr').first().innerText();
  assert.match(words, new RegExp(`Tilt\\s+${Number(tilt.toPrecision(3))}\\srad\\s+0\\.5\\srad`));
  assert.match(words, new RegExp(`${Number((200 * tilt).toPrecision(3))}\\s%`));
  // A strike that a limit forbids is told with what it asks for.
  await changeUnderWay(page);
  await openTab(page, 'values');
  await enter(page, '#field-table-limits-tilt', '0.31');
  await page.click('#restart');
  await openTab(page, 'why');
  await page.locator('#demand tbody tr.beyond', { hasText: /Tilt\s*0\.33\srad\s*0\.31\srad\s*106\s%/ }).waitFor();
  // Another run begins anew.
  await openTab(page, 'values');
  await enter(page, '#field-table-limits-tilt', '0.5');
  await page.click('#restart');
  await page.waitForFunction(() => document.querySelectorAll('#impacts tbody tr').length < 15);
  clean();
});
