// The form: what is wrong is said beside its field, and what was typed stays.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, enter, reachPhase, verdict, releaseTo } from './stage.js';

const stage = await Stage.open();

test('a value outside its range is refused with the limits, and the one before it stands again', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&tab=values');
  const gain = page.locator('#field-table-tilt_gain');
  await enter(page, gain, '5000');
  const error = page.locator('#field-table-tilt_gain-error');
  assert.match(await error.innerText(), /1\.1 was put back: 5000 is outside its limits, −100 to 100/);
  assert.equal(await gain.getAttribute('aria-invalid'), null);
  assert.match(await gain.getAttribute('aria-describedby'), /field-table-tilt_gain-error/);
  assert.equal(await gain.inputValue(), '1.1');
  await enter(page, gain, '1.2');
  assert.equal(await error.innerText(), '');
  assert.match(await verdict(page), /elliptic/i);
  clean();
});

test('what is no number is said so, not sent, and the last value is put back by Enter and by leaving it', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&tab=values');
  const asked = [];
  page.on('request', (request) => asked.push(request.url()));
  const theta = page.locator('#field-release-theta');
  const error = page.locator('#field-release-theta-error');
  await enter(page, theta, 'a bit');
  await error.filter({ hasText: /“a bit” is not a number from −3\.14\d* to 3\.14\d*\srad\./ }).waitFor();
  assert.equal(await page.evaluate(() => document.activeElement.id), 'field-release-theta');
  assert.equal(await theta.inputValue(), '0.3');
  await theta.fill('a lot');
  await theta.blur();
  await error.filter({ hasText: '0.3\u202frad was put back: “a lot” is not a number' }).waitFor();
  assert.equal(await theta.inputValue(), '0.3');
  assert.equal(await theta.getAttribute('aria-invalid'), null);
  assert.match(await page.locator('#parameters > [role=status]').innerText(), /Angle: 0\.3\srad was put back/);
  assert.match(await verdict(page), /\S/);
  assert.equal(new URLSearchParams(new URL(page.url()).search).get('scene.release.theta'), null);
  assert.deepEqual(
    asked.filter((url) => /(stability|trajectories).*scene\./.test(url)),
    [],
  );
  // Out of its limits is no value either.
  await enter(page, theta, '4');
  await error.filter({ hasText: 'outside its limits' }).waitFor();
  await page.click('#run');
  await reachPhase(page, 'running');
  assert.equal(await theta.inputValue(), '0.3');
  clean();
});

test('a finger that scrolls past a slider changes nothing', async () => {
  const { page, clean } = await stage.page('?preset=case-1&scene.release.theta=0.2345&tab=values', {
    hasTouch: true,
    isMobile: true,
    viewport: { width: 390, height: 844 },
  });
  const fingers = await page.context().newCDPSession(page);
  const touch = (type, ...touchPoints) => fingers.send('Input.dispatchTouchEvent', { type, touchPoints });
  for (const slider of ['#speed', '#field-release-theta-slider']) {
    const track = page.locator(slider);
    await track.evaluate((element) => element.scrollIntoView({ block: 'center' }));
    const { x, y, width, height } = await track.boundingBox();
    const top = () => page.evaluate(() => document.scrollingElement.scrollTop);
    const [before, begin] = [await track.inputValue(), await top()];
    const way = begin > 300 ? 20 : -20;
    await touch('touchStart', { x: x + width * 0.9, y: y + height / 2, id: 1 });
    for (let step = 1; step <= 12; step += 1) {
      await touch('touchMove', { x: x + width * 0.9, y: y + height / 2 + way * step, id: 1 });
      await page.evaluate(() => new Promise((done) => requestAnimationFrame(done)));
    }
    await touch('touchEnd');
    await page.evaluate(() => new Promise((done) => setTimeout(done, 500)));
    assert.ok(Math.abs((await top()) - begin) > 50, slider);
    assert.equal(await track.inputValue(), before, slider);
  }
  assert.equal(await page.inputValue('#field-release-theta'), '0.2345');
  clean();
});

test('what the server says of a field stays while another is no number', async () => {
  const { page } = await stage.page('?preset=case-1&tab=values');
  await enter(page, '#field-release-height', '0.01');
  await page.locator('#field-release-height-error', { hasText: 'at least' }).waitFor();
  await enter(page, '#field-release-theta', 'steep');
  await page.locator('#field-release-theta-error', { hasText: 'not a number' }).waitFor();
  assert.match(await page.locator('#field-release-height-error').innerText(), /at least/);
  // The verdict has no words but the way there, from another tab and past a search for other values.
  await page.fill('#settings-search', 'gravity');
  await page.click('#tab-map');
  await page.locator('#verdict', { hasText: 'No verdict' }).getByRole('button').click();
  assert.equal(await page.evaluate(() => document.activeElement.id), 'field-release-height');
  assert.ok(await page.locator('#panel-values').isVisible());
});

test('degrees, fractions of π and a decimal comma are understood', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=values');
  for (const [text, value] of [
    ['pi/4', Math.PI / 4],
    ['45°', Math.PI / 4],
    ['1,2', 1.2],
  ]) {
    await enter(page, '#field-incline', text);
    await page.waitForFunction(
      (wanted) => Math.abs(Number(new URLSearchParams(location.search).get('scene.incline')) - wanted) < 1e-12,
      value,
    );
    assert.equal(Number(await page.inputValue('#field-incline')), value, 'in the unit beside it');
  }
  clean();
});

test('every field has a control with a name', async () => {
  const { page, clean } = await stage.page('?tab=values');
  const { items: fields } = await (await fetch(`${stage.url}v1/fields`)).json();
  await page.locator('#field-release-height').waitFor();
  for (const { field: path, title } of fields) {
    const control = page.locator(`#field-${path.replaceAll('.', '-')}`);
    assert.equal(await control.count(), 1, path);
    assert.ok((await page.getByLabel(title).count()) > 0, title);
  }
  clean();
});

test('a polygon stays with what is typed beside it, until its vertices are taken away', async () => {
  const { page, clean } = await stage.page('?preset=triangle-polygon&tab=values');
  assert.match(await verdict(page), /\S/);
  await enter(page, '#field-table-tilt_gain', '1.05');
  await page.waitForFunction(() => new URLSearchParams(location.search).get('scene.table.tilt_gain') === '1.05');
  assert.equal(new URL(page.url()).searchParams.get('preset'), 'triangle-polygon');
  await releaseTo(page, 1);
  assert.match(page.url(), /preset=triangle-polygon/);
  assert.ok(await page.locator('#field-body-contact_distance').isDisabled());
  clean();
  await enter(page, '#field-body-vertices', '');
  await enter(page, '#field-body-contact_vertex', '');
  await enter(page, '#field-body-contact_distance', '0.1');
  await enter(page, '#field-body-radius_of_gyration', '0.1');
  assert.match(await verdict(page), /\S/);
  assert.equal(await page.locator('#field-body-vertices-error').innerText(), '');
});

test('an emptied length of the body says that it is needed, with limits and unit, and is put back', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&tab=values');
  for (const [path, title, value] of [
    ['contact_distance', 'Contact distance', '0.1333'],
    ['radius_of_gyration', 'Radius of gyration', '0.09428'],
  ]) {
    const told = async () => (await page.locator(`#field-body-${path}-error`).innerText()).replace(/\s/g, ' ');
    await enter(page, `#field-body-${path}`, '');
    await page.locator(`#field-body-${path}-error`, { hasText: 'needed' }).waitFor();
    assert.equal(Number(await page.inputValue(`#field-body-${path}`)).toPrecision(4), Number(value).toPrecision(4));
    assert.equal(await told(), `${value} m was put back: ${title} is needed: 0.001 to 10 m.`);
  }
  clean();
});

test('a polygon is typed, runs, and is in the link', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&tab=values');
  const vertices = page.locator('#field-body-vertices');
  await vertices.fill('0, 0\n0.1 0.2\n-0.1');
  await vertices.blur();
  assert.match(await page.locator('#field-body-vertices-error').innerText(), /Line 3/);
  await vertices.fill('0, 0\n0,1 0,2\n-0.1; 0.2');
  await vertices.blur();
  assert.match(await page.locator('#field-body-vertices-error').innerText(), /Line 2/);
  await enter(page, vertices, '0, 0\n0.1 0.2\n-0.1; 0.2');
  await page.waitForFunction(() => /vertices\.2\.1=0\.2/.test(location.search));
  assert.match(await verdict(page), /\S/);
  const query = new URL(page.url()).searchParams;
  query.delete('tab');
  const response = await fetch(`${stage.url}v1/trajectories?${query}&bounces=5`);
  const { model, outcome } = await response.json();
  assert.deepEqual([model.name, outcome.kind], ['polygon', 'completed']);
  await releaseTo(page, 2);
  const second = await stage.page(new URL(page.url()).search);
  assert.equal(await second.page.locator('#field-body-vertices').inputValue(), '0, 0\n0.1, 0.2\n-0.1, 0.2');
  assert.equal(await second.page.locator('#notices').innerText(), '');
  clean();
  second.clean();
  // Two corners are no polygon: the server says so beside them.
  await enter(page, vertices, '0, 0\n0.1 0.2');
  await page.waitForFunction(() => /3 to 32/.test(document.querySelector('#field-body-vertices-error').textContent));
});

test('a link whose vertices are not whole drops them', async () => {
  const { page, clean } = await stage.page(
    '?preset=triangle-polygon&scene.body.vertices.0.0=0&scene.body.vertices.2.1=1',
  );
  assert.match(await page.locator('.notice').innerText(), /vertices, which are not whole/);
  clean();
});

test('an error has numbers that can be read, and its least value is accepted', async () => {
  const { page } = await stage.page('?preset=case-1&tab=values');
  const height = page.locator('#field-release-height');
  await height.fill('0.1');
  await height.press('Tab');
  const error = page.locator('.field:has(#field-release-height) .error');
  await error.filter({ hasText: 'at least' }).waitFor();
  const words = await error.innerText();
  assert.doesNotMatch(words, /\d\.\d{6,}/);
  await height.fill(/at least ([\d.]+\d)/.exec(words)[1]);
  await height.press('Tab');
  await page.waitForFunction(() => /release\.height=/.test(location.search));
  assert.match(await verdict(page), /./);
  assert.notEqual(await height.getAttribute('aria-invalid'), 'true');
});
