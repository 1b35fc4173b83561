// Links of every form that the page has ever written, and wrong ones: each restores what it named.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, reachImpact, reachPhase, tool } from './stage.js';

const stage = await Stage.open();

/** A release long enough ago for some impacts, and one that was paused then. */
const epoch = Date.now() - 3000;
const paused = `epoch=${epoch}&clock.0.wall=${epoch + 1000}&clock.0.run=1&clock.0.speed=0`;
const SQUARE = [
  [0, -0.1],
  [0.1, 0],
  [0, 0.1],
  [-0.1, 0],
];
const polygon = SQUARE.flatMap((place, index) =>
  place.map((value, axis) => `scene.body.vertices.${index}.${axis}=${value}`),
).join('&');

/**
 * Links with what they name: values of controls by id, the address after opening, what is dropped, the run.
 * @type {{link: string, values?: Record<string, string | boolean>, address?: RegExp, dropped?: RegExp, phase?: string}[]}
 */
const LINKS = [
  // Cases
  { link: '', values: { case: 'case-1', 'field-table-tilt_gain': '1.1' } },
  { link: 'preset=case-2', values: { case: 'case-2', 'field-release-theta_dot': '0.1' } },
  { link: 'preset=case-2-figure', values: { case: 'case-2-figure' } },
  { link: 'preset=point-mass', values: { case: 'point-mass', 'field-body-point': true } },
  { link: 'preset=case-4-noise', values: { case: 'case-4-noise' } },
  // Fields of a scene
  { link: 'preset=case-1&scene.table.tilt_gain=1.35', values: { case: 'case-1', 'field-table-tilt_gain': '1.35' } },
  {
    link: 'preset=case-3&scene.release.height=0.3&scene.contact.friction=0.2&scene.table.slide=matched',
    values: { 'field-release-height': '0.3', 'field-contact-friction': '0.2', 'field-table-slide': 'matched' },
  },
  { link: 'preset=case-4-noise&scene.noise.timing_sd=null', values: { 'field-noise-timing_sd': '' } },
  {
    link: 'scene.body.contact_distance=0.2&scene.body.radius_of_gyration=0.1&scene.release.height=0.25&scene.table.tilt_gain=1.2',
    values: { case: '', 'field-body-contact_distance': '0.2', 'field-table-tilt_gain': '1.2' },
  },
  {
    link: `${polygon}&scene.release.height=0.3&scene.table.tilt_gain=1.2`,
    values: { 'field-body-vertices': '0, -0.1\n0.1, 0\n0, 0.1\n-0.1, 0' },
  },
  { link: 'preset=case-1&speed=2.5', address: /speed=2\.5/ },
  // Runs to join
  {
    link: `preset=case-1&scene.release.theta=0.2&${paused}`,
    values: { 'field-release-theta': '0.2' },
    address: new RegExp(`epoch_ms=${epoch}`),
    phase: 'paused',
  },
  { link: `preset=case-1&speed=2&epoch=${epoch}`, address: new RegExp(`epoch_ms=${epoch}`), phase: 'running' },
  {
    link: `preset=case-1&${paused}&interventions.0.impact=2&interventions.0.set.table.tilt_gain=1.2&interventions.1.impact=3&interventions.1.kick.theta_dot=0.1`,
    values: { 'field-table-tilt_gain': '1.2' },
    address: /interventions\.0\.set\.table\.tilt_gain=1\.2.*interventions\.1\.kick\.theta_dot=0\.1/,
    phase: 'paused',
  },
  // Interventions without a start once were dropped; they are replayed.
  {
    link: 'preset=case-1&scene.release.theta=0.1&interventions.0.impact=2&interventions.0.kick.theta_dot=0.1',
    address: /interventions\.0\.impact=2.*kick\.theta_dot=0\.1/,
    phase: 'running',
  },
  // Panels
  {
    link: 'preset=case-1&map.x.parameter=release.height&map.x.from=0.15&map.x.to=0.4&map.quantity=max_theta&map.impacts=500&map.columns=48',
    values: {
      'map-x-from': '0.15',
      'map-x-to': '0.4',
      'map-quantity': 'max_theta',
      'map-impacts': '500',
      'map-columns': '48',
    },
  },
  {
    link: 'preset=case-1&map.y.parameter=contact.friction&map.y.from=0&map.y.to=0.5',
    values: { 'map-y': 'contact.friction', 'map-y-to': '0.5' },
  },
  // A chart that once had to be chosen is there anyway.
  {
    link: 'preset=case-1&chart=energy&brush.theta.from=-0.1&brush.theta.to=0.2',
    address: /brush\.theta\.from=-0\.1&brush\.theta\.to=0\.2/,
  },
  { link: 'preset=case-1&catch.hold=2', values: { 'catch-hold': '2' } },
  { link: 'preset=case-1&tab=orbits', values: { case: 'case-1' }, address: /tab=more/ },
  // Wrong ones keep what is right in them.
  { link: 'preset=case-99&speed=2', values: { case: 'case-1' }, address: /speed=2/, dropped: /case-99/ },
  {
    link: 'preset=case-3&scene.table.tilt_gain=steep&scene.release.theta=0.1',
    values: { case: 'case-3', 'field-release-theta': '0.1' },
    dropped: /steep/,
  },
  { link: 'preset=case-1&scene.table.wobble=3&scene.gravity=5', values: { 'field-gravity': '5' }, dropped: /wobble/ },
  { link: 'preset=case-2&epoch=yesterday', values: { case: 'case-2' }, dropped: /yesterday/, phase: 'idle' },
  { link: 'preset=case-1&clock.0.wall=5', values: { case: 'case-1' }, dropped: /pause/, phase: 'idle' },
  { link: 'preset=case-1&map.quantity=beauty&map.impacts=100', values: { 'map-impacts': '100' }, dropped: /beauty/ },
  {
    link: 'preset=case-1&scene.body.vertices.0.0=1&scene.release.theta=0.1',
    values: { 'field-release-theta': '0.1' },
    dropped: /vertices/,
  },
];

/** Waits until a page shows what a link names. */
async function restored(page, { link, values = {}, address, dropped, phase }) {
  for (const [id, value] of Object.entries(values)) {
    await page.locator(`#${id}`).waitFor({ state: 'attached' });
    await page.waitForFunction(
      ([control, wanted]) => {
        const element = document.getElementById(control);
        return (element.type === 'checkbox' ? element.checked : element.value) === wanted;
      },
      [id, value],
    );
  }
  if (phase === 'running' || phase === 'paused') await reachImpact(page, 2);
  if (phase) await reachPhase(page, phase);
  if (address) {
    // The address says the same again once something is written into it.
    await tool(page, 'units');
    await page.waitForFunction(() => /angles=deg/.test(location.search));
    assert.match(decodeURIComponent(page.url()), address);
    await tool(page, 'units');
  }
  if (dropped) await page.locator('#notices li').filter({ hasText: dropped }).first().waitFor({ state: 'attached' });
  else assert.equal(await page.locator('#notices').innerText(), '', link);
}

const ofPanels = ({ link }) => /map\.|catch\.|brush\.|tab=/.test(link);

test('scenes and runs', async () => {
  const { page, clean } = await stage.page('?preset=case-3');
  for (const one of LINKS.filter((one) => !ofPanels(one))) {
    // A connection that is given up before it is made is an error to the browser.
    await page.locator('#run-state:not([data-phase=connecting])').waitFor({ state: 'attached' });
    await page.evaluate((search) => {
      history.pushState(null, '', search);
      dispatchEvent(new PopStateEvent('popstate'));
    }, `?${one.link}`);
    await restored(page, one);
  }
  clean();
});

for (const one of LINKS.filter(ofPanels))
  test(`?${one.link.slice(0, 120)}`, async () => {
    const { page, clean } = await stage.page(`?${one.link}`);
    await restored(page, one);
    clean();
  });
