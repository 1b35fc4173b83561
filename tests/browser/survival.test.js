// Survival under noise on the page: run when asked, the server's numbers as a curve and as a table, by pointer and by keys.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, answersOf, enter, free, openPanel, reachImpact, verdict } from './stage.js';

const stage = await Stage.open();

async function open(query, options) {
  const opened = await stage.page(query, options);
  await verdict(opened.page);
  await openPanel(opened.page, 'survival');
  await opened.page.locator('#survival-start').waitFor();
  return { ...opened, answers: await answersOf(opened.page, 'v1/ensembles?') };
}

async function runAll(page, runs, impacts) {
  await page.fill('#survival-runs', String(runs));
  await page.fill('#survival-impacts', String(impacts));
  await page.click('#survival-start');
  await page.locator('#survival-told', { hasText: 'outlast' }).waitFor();
}

const plain = (text) => text.replace(/[\u00a0\u202f]/g, ' ').replaceAll('\u2212', '-');

test('a scene without noise is tried with some, by either reading', async () => {
  const { page, answers, clean } = await open('?preset=case-1');
  assert.equal((await answers()).length, 0);
  assert.ok(await page.locator('.survival-sheet').isHidden());
  assert.ok(await page.locator('#survival-offer').isVisible());
  await runAll(page, 60, 120);
  await page.selectOption('#survival-reading', 'plan');
  await page.fill('#survival-timing', '5');
  await page.click('#survival-start');
  await page.waitForFunction(() => /noise\.model=plan/.test(document.querySelector('#survival-links a').href));
  const [strike, plan] = await answers();
  assert.deepEqual(
    [strike.scene.noise.timing_sd, strike.scene.noise.model, plan.scene.noise.timing_sd, plan.scene.noise.model],
    [0.01, 'strike', 0.005, 'plan'],
  );
  assert.equal(await page.inputValue('#field-noise-timing_sd'), '', 'the scene of the page is left as it is');
  clean();
});

test('curve, numbers at risk, table and figures are the server’s', async () => {
  const { page, answers } = await open('?preset=case-1-noise');
  assert.ok(await page.locator('#survival-offer').isHidden());
  assert.match(plain(await page.locator('#survival-noise').innerText()), /10 ms/);
  await runAll(page, 80, 300);
  const { survival, quantiles, survived, counts, runs, bounces } = (await answers())[0];
  assert.ok(survived.runs > 0 && survived.runs < runs, 'a curve that falls, but not to the ground');
  assert.match(
    plain(await page.locator('#survival-told').innerText()),
    new RegExp(`^${survived.runs} of 80 runs outlast 300`),
  );
  const risk = await page.locator('#survival-box [data-row=at-risk] text').allTextContents();
  assert.equal(risk[0], String(runs));
  assert.equal(risk.at(-1), String(survival.at_risk[bounces - 1]));
  // The drawn curve ends at the last value, between the edges of its band.
  const heights = await page.locator('#survival-box').evaluate((box) => {
    const last = (path) => Number(path.getAttribute('d').split('L').at(-1).replace('Z', '').split(' ')[1]);
    const edge = box.querySelector('[data-panel=survival]');
    const [top, height] = ['y', 'height'].map((name) => Number(edge.getAttribute(name)));
    const band = box
      .querySelector('[data-curve=interval] path')
      .getAttribute('d')
      .slice(1, -1)
      .split('L')
      .map((pair) => pair.split(' ').map(Number));
    const right = Math.max(...band.map(([x]) => x));
    const share = (y) => 1 - (y - top) / height;
    return {
      curve: share(last(box.querySelector('[data-curve=survival]'))),
      band: band.filter(([x]) => x === right).map(([, y]) => share(y)),
    };
  });
  const near = (one, other) => assert.ok(Math.abs(one - other) < 0.003, `${one} is not ${other}`);
  near(heights.curve, survived.share);
  near(Math.max(...heights.band), survived.upper);
  near(Math.min(...heights.band), survived.lower);
  await page.locator('.survival-sheet summary', { hasText: 'Numbers' }).click();
  const rows = await page
    .locator('.survival-sheet tbody tr')
    .evaluateAll((all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
  assert.equal(rows.length, quantiles.n.length);
  for (const [index, row] of rows.entries()) {
    const at = quantiles.n[index] - 1;
    assert.deepEqual(row.slice(0, 3).map(Number), [quantiles.n[index], survival.at_risk[at], survival.ended[at]]);
    near(Number(row[3]), survival.survival[at]);
    if (quantiles.q50[index] !== null) near(Number(row[8]), quantiles.q50[index]);
  }
  const ends = await page.locator('#survival-numbers').innerText();
  for (const [name, count] of Object.entries(counts))
    if (name !== 'completed' && count > 0) assert.ok(ends.includes(`${count} ${name.replaceAll('_', ' ')}`), ends);
});

test('pointer and keys read the curve', async () => {
  const { page, answers, clean } = await open('?preset=case-1');
  await runAll(page, 50, 200);
  const { survival } = (await answers())[0];
  const readout = async () => plain(await page.locator('#survival-readout').innerText());
  await page.focus('#survival-box');
  await page.keyboard.press('End');
  assert.ok(
    (await readout()).startsWith('contact 200') && (await readout()).includes(`at risk ${survival.at_risk[199]}`),
    await readout(),
  );
  await page.keyboard.press('ArrowLeft');
  assert.match(await readout(), /^contact 199 /);
  await page.keyboard.press('PageDown');
  assert.match(await readout(), /^contact 179 /);
  await page.keyboard.press('Home');
  assert.match(await page.locator('.survival-sheet .unseen').innerText(), /^contact 1 /);
  await page.keyboard.press('Escape');
  assert.equal(await readout(), '');
  const box = await page.locator('#survival-box [data-panel]').first().boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  assert.match(await readout(), /^contact (99|100|101) /);
  clean();
});

test('its links answer, and the first run can be watched', async () => {
  const { page, answers, clean } = await open('?preset=case-1');
  await page.fill('#survival-timing', '8');
  await runAll(page, 20, 40);
  for (const href of await page.locator('#survival-links a').evaluateAll((links) => links.map((link) => link.href)))
    assert.ok((await fetch(href)).ok, href);
  await page.click('#survival-links button');
  const call = await page.evaluate(() => navigator.clipboard.readText());
  assert.deepEqual(await (await fetch(/^curl '(.+)'$/.exec(call)[1])).json(), (await answers())[0]);
  await page.click('#survival-first');
  await reachImpact(page, 2);
  const query = new URL(page.url()).searchParams;
  assert.equal(query.get('scene.noise.timing_sd'), '0.008');
  assert.equal(await page.inputValue('#field-noise-model'), 'strike');
  clean();
});

test('progress is counted in runs, and Cancel frees the server', async () => {
  const { page, clean } = await open('?preset=case-1');
  await runAll(page, 40, 50);
  const before = await page.locator('#survival-box [data-curve=survival]').getAttribute('d');
  // From a small angle no run ends early: the dearest there is.
  await enter(page, '#field-release-theta', '0.05');
  await page.fill('#survival-runs', '20000');
  await page.fill('#survival-impacts', '5000');
  await page.focus('#survival-start');
  await page.keyboard.press('Enter');
  const bar = page.locator('#survival-told progress');
  await page.waitForFunction(() => document.querySelector('#survival-told progress').value > 0);
  assert.equal(await bar.getAttribute('max'), '20000');
  const [value, words] = await page
    .locator('#survival-told')
    .evaluate((told) => [told.querySelector('progress').value, told.innerText]);
  assert.match(
    plain(words),
    new RegExp(`^Running… ${plain(value.toLocaleString('en').replace(',', value > 9999 ? ' ' : ''))} of 20 000 runs$`),
  );
  assert.ok(
    !(await page.locator('#survival-told [role=status]').innerText()).includes('of'),
    'the count is not spoken at every step',
  );
  assert.equal(
    await page.locator('#survival-box [data-curve=survival]').getAttribute('d'),
    before,
    'what was there stays',
  );
  assert.notEqual(await stage.running(), 0);
  assert.equal(await page.evaluate(() => document.activeElement.id), 'survival-cancel');
  await page.keyboard.press('Enter');
  await page.locator('#survival-told', { hasText: 'Cancelled. What is shown is from before.' }).waitFor();
  assert.ok(await bar.isHidden());
  assert.equal(await page.evaluate(() => document.activeElement.id), 'survival-start');
  await free(stage);
  assert.equal(await page.locator('#survival-box [data-curve=survival]').getAttribute('d'), before);
  await runAll(page, 30, 50);
  clean();
});

test('an answer that breaks off says how far it came', async () => {
  const { page } = await open('?preset=case-1', {
    prepare: () => {
      const real = globalThis.fetch;
      globalThis.cut = true;
      globalThis.fetch = (input, init) => {
        if (!globalThis.cut || !String(input).includes('v1/ensembles')) return real(input, init);
        const lines = [0, 90].map((done) => `${JSON.stringify({ progress: { done, of: 300 } })}\n`);
        return Promise.resolve(
          new Response(
            new ReadableStream({
              async pull(controller) {
                const line = lines.shift();
                if (line) return controller.enqueue(new TextEncoder().encode(line));
                await new Promise((resolve) => {
                  setTimeout(resolve, 50);
                });
                if (globalThis.cut === 'clean') controller.close();
                else controller.error(new TypeError('network error'));
              },
            }),
          ),
        );
      };
    },
  });
  for (const cut of ['clean', true]) {
    await page.evaluate((way) => {
      globalThis.cut = way;
    }, cut);
    await page.click('#survival-start');
    await page.locator('#survival-told', { hasText: 'The answer broke off at 90 of 300 runs.' }).waitFor();
    assert.ok(await page.locator('#survival-told progress').isHidden());
    assert.ok(await page.locator('.survival-sheet').isHidden());
  }
  await page.evaluate(() => {
    globalThis.cut = false;
  });
  await runAll(page, 30, 50);
});

test('its settings are in the address, and what is broken of them is dropped in words', async () => {
  const link = 'survival.runs=1000&survival.impacts=50&survival.timing_sd=0.0025&survival.model=plan';
  const { page, clean } = await open(`?preset=case-1&${link}`);
  const shown = () =>
    Promise.all(['runs', 'impacts', 'timing', 'reading'].map((name) => page.inputValue(`#survival-${name}`)));
  assert.deepEqual(await shown(), ['1000', '50', '2.5', 'plan']);
  await page.fill('#survival-runs', '300');
  await page.fill('#survival-timing', '12,5');
  await page.selectOption('#survival-reading', 'strike');
  await page.waitForFunction(() => !location.search.includes('survival.model'));
  assert.equal(
    new URL(page.url()).search,
    '?preset=case-1&tab=noise&survival.runs=300&survival.impacts=50&survival.timing_sd=0.0125',
  );
  clean();
  const broken = await open(
    '?preset=case-1&survival.runs=20001&survival.impacts=1.5&survival.timing_sd=&survival.model=toString',
  );
  const words = plain(await broken.page.locator('#notices').innerText());
  for (const said of [
    'runs “20001”: it must be a whole number from 1 to 20 000',
    'impacts “1.5”: it must be a whole number from 1 to 100 000',
    'timing_sd “”: it must be a number above 0 and up to 1000 ms',
    'model “toString”: it must be strike or plan',
  ])
    assert.ok(words.includes(`survival.${said}`), words);
  assert.deepEqual(
    await Promise.all(
      ['runs', 'impacts', 'timing', 'reading'].map((name) => broken.page.inputValue(`#survival-${name}`)),
    ),
    ['200', '400', '10', 'strike'],
  );
  broken.clean();
});

test('what is wrong is said beside it', async () => {
  const { page } = await open('?preset=case-1');
  await page.fill('#survival-runs', '20001');
  await page.click('#survival-start');
  assert.match(plain(await page.locator('#survival-runs-error').innerText()), /1 to 20 000/);
  assert.equal(await page.evaluate(() => document.activeElement.id), 'survival-runs');
  await page.fill('#survival-runs', '50');
  await page.fill('#survival-timing', 'some');
  await page.click('#survival-start');
  assert.match(await page.locator('#survival-timing-error').innerText(), /“some” is not a number/);
  await enter(page, '#survival-timing', '2 s');
  assert.match(await page.locator('#survival-timing-error').innerText(), /1000 ms/);
  await page.fill('#survival-timing', '10');
  await runAll(page, 50, 50);
  await page.fill('#survival-runs', '20000');
  await page.fill('#survival-impacts', '100000');
  await page.click('#survival-start');
  await page.locator('#survival-told', { hasText: 'limit' }).waitFor();
  await enter(page, '#field-release-theta', '0.2');
  await page.locator('#survival-told', { hasText: 'changed' }).waitFor();
});
