// The tab Catch: the server's catch in words, numbers and picture, and a live run that is caught, held, thrown and replayed.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { violations } from './axe.js';
import { Stage, enter, openPanel, openTab, reachImpact, reachPhase, verdict, plain, releaseTo } from './stage.js';

const stage = await Stage.open();
async function open(query, options) {
  const opened = await stage.page(query, options);
  await verdict(opened.page);
  await openPanel(opened.page, 'catch');
  await opened.page.locator('#catch-start').waitFor();
  return opened;
}

/** Catches on the page, and gives the server's answer to the same request. */
async function caught(page) {
  await page.click('#catch-start');
  await page.locator('#catch-sheet:not(.stale) #catch-links a').first().waitFor();
  return (await fetch(await page.locator('#catch-links a', { hasText: 'JSON' }).evaluate((link) => link.href))).json();
}

const facts = async (page) =>
  Object.fromEntries(
    await page
      .locator('#catch-facts > div')
      .evaluateAll((all) => all.map((one) => [one.children[0].textContent, one.children[1].textContent])),
  );

/** A number of the page. */
const value = (text) => Number.parseFloat(plain(text).replace(' × 10', 'e'));

/** Runs the scene until it bounces, catches it, and waits until the table holds it. */
async function hold(page, button) {
  await releaseTo(page, 3);
  await page.click(button);
  await page.locator('#catch-live-told', { hasText: 'The table holds the body' }).waitFor();
}

const interventions = (page) => {
  const query = new URL(page.url()).searchParams;
  return [...query].filter(([key]) => key.startsWith('interventions.'));
};

async function copiedLink(page) {
  if (await page.locator('#share').isHidden()) await page.click('#share-open');
  await page.click('#share');
  return new URL(await page.evaluate(() => navigator.clipboard.readText()));
}

const picture = (page) => page.locator('#scene-frame canvas').first().screenshot();

test('words, numbers, candidates and picture are the server’s', async () => {
  const { page, clean } = await open('?preset=case-1');
  const answer = await caught(page);
  assert.equal(answer.outcome.kind, 'held');
  assert.match(await page.locator('#catch-told .answer').innerText(), /^Caught: the table holds it/);
  const shown = await facts(page);
  for (const [name, number] of [
    ['strikes', answer.strikes.n.length],
    ['in contact', answer.contact_from],
    ['upright', answer.upright_within.theta_1mrad],
    ['in place', answer.upright_within.x_1mm],
    ['force', answer.demand.normal_force],
    ['reach', answer.reach.theta],
  ])
    assert.ok(Math.abs(value(shown[name]) / number - 1) < 1e-3, `${name}: ${shown[name]}, ${number}`);
  const demands = await page.locator('.demands tbody td:nth-child(2)').allInnerTexts();
  for (const [index, name] of ['tilt', 'tilt_rate', 'speed', 'stroke'].entries())
    assert.ok(Math.abs(value(demands[index]) / answer.demand[name] - 1) < 1e-2, `${name}: ${demands[index]}`);
  const candidates = await page.locator('.candidates tbody tr').allInnerTexts();
  assert.equal(candidates.length, answer.candidates.length);
  assert.match(candidates[answer.candidates.findIndex(({ taken }) => taken)], /taken/);
  assert.equal(await page.locator('#catch-notes p').count(), answer.notes.length);
  assert.ok(await page.locator('#catch-sheet svg.figure').evaluate((one) => one.getBoundingClientRect().width > 300));
  await page.locator('#catch-box').focus();
  await page.keyboard.press('Home');
  assert.match(plain(await page.locator('#catch-readout').innerText()), /^t 0\.122 s +strike 1 +θ 0\.3000 rad/);
  await page.keyboard.press('End');
  assert.match(plain(await page.locator('#catch-readout').innerText()), /in contact +θ -?0\.000/);
  assert.ok(await page.locator('#catch-box path.pointed').getAttribute('d'));
  for (const href of await page.locator('#catch-links a').evaluateAll((links) => links.map((link) => link.href)))
    assert.ok((await fetch(href)).ok, href);
  clean();
});

test('limits are beside the demand, what rules candidates out is told, and none that catches is a headline too', async () => {
  const { page, clean } = await open('?preset=case-1&scene.table.limits.speed=0.3');
  const answer = await caught(page);
  const ruledOut = answer.candidates.filter(({ outcome }) => outcome.kind === 'beyond_limits');
  assert.ok(ruledOut.length > 0);
  const words = await page.locator('.candidates').innerText();
  assert.equal(words.match(/more of the table than its limits allow \(speed\)/g)?.length, ruledOut.length);
  const limit = await page.locator('.demands tbody tr').nth(2).innerText();
  assert.match(plain(limit), /0\.3 m\/s/);
  await openTab(page, 'values');
  await enter(page, '#field-table-limits-speed', '0.01');
  await openPanel(page, 'catch');
  await page.locator('#catch-sheet.stale').waitFor();
  await caught(page);
  assert.match(await page.locator('#catch-told .answer').innerText(), /^Not caught: .*limits allow/);
  clean();
});

test('settings are in the address, and what is wrong is marked', async () => {
  const { page, clean } = await open('?preset=case-1');
  await page.selectOption('#catch-strategy', 'plan');
  await page.fill('#catch-strikes', '10');
  await page.fill('#catch-ratio', '0.7');
  const answer = await caught(page);
  assert.deepEqual(
    [answer.settings.strategy, answer.settings.strikes, answer.settings.ratio],
    ['plan', 10, 0.7],
    'as asked',
  );
  await page.waitForFunction(() => /catch\.strikes=10/.test(location.search));
  const second = await open(new URL(page.url()).search);
  assert.equal(await second.page.inputValue('#catch-strategy'), 'plan');
  assert.equal(await second.page.inputValue('#catch-strikes'), '10');
  assert.equal(await second.page.locator('#notices').innerText(), '');
  second.clean();
  // A page behind another one paints nothing, and waits for no frame.
  await page.bringToFront();
  await page.fill('#catch-ratio', '7');
  await page.click('#catch-start');
  await page.locator('#catch-ratio-error', { hasText: '0.05' }).waitFor();
  assert.equal(await page.getAttribute('#catch-ratio', 'aria-invalid'), 'true');
  await page.fill('#catch-ratio', 'much');
  await page.click('#catch-start');
  await page.locator('#catch-ratio-error', { hasText: 'not a number' }).waitFor();
  await page.waitForFunction(() => document.activeElement.id === 'catch-ratio');
  clean(/422/);
  const third = await stage.page('?preset=case-1&catch.strategy=net&catch.hold=long');
  await third.page.locator('.notice', { hasText: 'strategy “net”' }).waitFor();
});

test('a live run is caught, held and drawn; its link replays it', async () => {
  const { page, clean } = await open('?preset=case-1&catch.strategy=bounce_down&catch.ratio=0.6&catch.hold=30');
  assert.ok(await page.locator('#catch-run').isDisabled());
  await hold(page, '#catch-run');
  const [before, readout] = [await picture(page), await page.locator('#scene-readout').innerText()];
  await page.waitForTimeout(400);
  assert.notDeepEqual(await picture(page), before, 'the scene moves while the table holds the body');
  assert.notEqual(await page.locator('#scene-readout').innerText(), readout);
  assert.match(plain(await page.locator('#scene-readout').innerText()), /y 0\.13\d m/);
  assert.ok(await page.locator('#catch-run').isDisabled());
  const link = await copiedLink(page);
  assert.equal(link.searchParams.get('interventions.0.catch.strategy'), 'bounce_down');
  assert.equal(link.searchParams.get('interventions.0.catch.ratio'), '0.6');
  const second = await stage.page(`${link.search}&tab=catch`, { autorun: true });
  await second.page.locator('#catch-live-told', { hasText: 'The table holds the body' }).waitFor();
  assert.equal(await second.page.locator('#notices').innerText(), '');
  assert.deepEqual(
    interventions(second.page).filter(([key]) => key.includes('catch')),
    interventions(page).filter(([key]) => key.includes('catch')),
  );
  second.clean();
  clean();
});

test('from the hold a throw goes on, and juggling strikes to two heights in turn', async () => {
  // What the law leaves out grows with the square of the angle.
  const { page, clean } = await open('?preset=case-1&scene.release.theta=0.1&catch.hold=60');
  await hold(page, '#catch-it');
  const struck = await page.evaluate(() => document.querySelector('#plane-angle .readout').textContent);
  const n = Number(/^n\s(\d+)/.exec(struck)[1]);
  await page.fill('#catch-height', '0.4');
  await page.click('#catch-throw');
  await page.waitForFunction(
    () => new URLSearchParams(location.search).get('interventions.1.throw.apex.height') === '0.4',
  );
  await reachImpact(page, n + 2);
  await page.locator('#catch-live-told', { hasText: 'next strike' }).waitFor();
  await page.click('#catch-juggle');
  await page.waitForFunction(() => /energy_law=one_strike/.test(location.search));
  assert.equal(await page.inputValue('#field-table-program'), '0.2, 0.3');
  const from = await page.evaluate(() => Number(new URLSearchParams(location.search).get('interventions.2.impact')));
  await reachImpact(page, from + 4);
  const link = await copiedLink(page);
  const replay = new URLSearchParams(
    [...link.searchParams].filter(([key]) => /^(preset|scene|interventions)/.test(key)),
  );
  const replayed = await (await fetch(`${stage.url}v1/trajectories?${replay}&bounces=${from + 4}`)).json();
  const { y_dot: down, theta } = replayed.impacts;
  // The top of the flight before each of the last strikes; the law leaves out the drop of the centre of gravity by the angle.
  const apexes = [-3, -2, -1].map((at) => (0.4 / 3) * Math.cos(theta.at(at)) + down.at(at) ** 2 / (2 * 9.81));
  for (const [index, apex] of apexes.entries())
    assert.ok(Math.min(Math.abs(apex - 0.2), Math.abs(apex - 0.3)) < 5e-3, `apex ${index}: ${apex}`);
  assert.ok(Math.abs(apexes[0] - apexes[1]) > 0.09, 'in turn');
  // The orbits below have no family under this law.
  clean(/422/);
});

test('a throw to below the body is refused beside its field’s row, an undo takes a catch back, and a held run ends as caught', async () => {
  const { page } = await open('?preset=case-1&catch.hold=0.5');
  await releaseTo(page, 3);
  await page.fill('#catch-height', '0.01');
  await page.click('#catch-throw');
  await page.locator('#catch-live-error', { hasText: 'not above' }).waitFor();
  await page.fill('#catch-height', 'high');
  await page.click('#catch-throw');
  await page.locator('#catch-height-error', { hasText: 'not a number' }).waitFor();
  await page.click('#catch-run');
  await page.waitForFunction(() => /interventions\.\d\.catch/.test(location.search));
  await page.keyboard.press('Control+z');
  await page.waitForFunction(() => !/interventions\.\d\.catch/.test(location.search));
  await reachImpact(page, 2);
  await page.click('#catch-run');
  await reachPhase(page, 'ended');
  // A success in its colour: no fall, and nothing to see once more.
  assert.match(await page.locator('.ending.kept').innerText(), /^Was caught at bounce \d+/);
  assert.ok(await page.locator('#slow').isHidden());
  await page.locator('#verdict .headline.kept').waitFor();
  assert.equal(await page.locator('#run-state').getAttribute('data-fate'), 'kept');
  assert.equal(await page.locator('#to-now').innerText(), 'Now');
  assert.doesNotMatch(await page.locator('#timeline-told').innerText(), /tenth of the speed/);
  assert.ok(await page.locator('#catch-throw').isDisabled());
});

test('the reach is a map of the same settings', async () => {
  const { page, clean } = await open('?preset=case-1&catch.strategy=plan&catch.strikes=4&map.columns=48');
  await page.click('#catch-reach');
  await page.locator('.map-legend .caught').waitFor();
  const request = new URL(await page.locator('#map-links a', { hasText: 'JSON' }).evaluate((link) => link.href));
  const asked = ['quantity', 'x.field', 'y.field', 'catch.strategy', 'catch.strikes'].map((key) =>
    request.searchParams.get(key),
  );
  assert.deepEqual(asked, ['caught', 'release.theta', 'release.theta_dot', 'plan', '4']);
  clean();
});

for (const width of [320, 1280])
  test(`axe finds nothing at ${width} px in both schemes, and all of it works by keys`, async () => {
    const { page } = await open('?preset=case-1', { viewport: { width, height: 800 } });
    await page.locator('#catch-strategy').focus();
    await page.keyboard.press('b');
    await page.keyboard.press('Tab');
    assert.equal(await page.evaluate(() => document.activeElement.id), 'catch-ratio');
    await page.keyboard.type('0.6');
    await page.keyboard.press('Enter');
    await page.locator('#catch-links a').first().waitFor();
    await page.locator('#catch-sheet details').evaluateAll((all) => {
      for (const one of all) one.open = true;
    });
    assert.deepEqual(await violations(page, '#studies'), []);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth), 0);
    await page.fill('#catch-ratio', '?');
    await page.click('#catch-start');
    assert.deepEqual(await violations(page, '#studies'), [], 'with an error');
  });
