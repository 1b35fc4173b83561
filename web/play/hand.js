// You are the table: the pointer tilts it, and the run keeps what the hand did as any other change.

import { start } from '../app/run-actions.js';
import { present } from '../app/scenes.js';
import { byId, h } from '../dom/elements.js';

/** @typedef {import('../app/page.js').Page} Page */

/** The case that one tries to balance, from a small angle, slower than real time. */
const CASE = 'case-1';
const ANGLE = 0.05;
const SPEED = 0.25;
/** The body counts as fallen beyond this angle, rad: it lies no lower than the table. */
const FALLEN = 1;
/** The field by which the hand tilts the table; its tilt gain is 0. */
const TILT = 'table.errors.tilt_offset';
/** The tilt at the edge of the picture, and by a press of a key, rad. */
const WIDEST = 0.6;
const BY_KEY = 0.04;
/** A tilt is sent so long before the contact, s of wall time: as late as it may arrive in time. */
const AHEAD_S = 0.07;

export class Hand {
  #page;
  #button = h(
    'button',
    { type: 'button', id: 'you', 'aria-pressed': 'false', click: () => this.toggle() },
    'You are the table',
  );
  /** True while the hand holds the table. */
  #holds = false;
  /** The speed before. */
  #speed = 1;
  /** The bounce for which a tilt was sent last. */
  #sent = 0;

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    byId('stories').append(this.#button);
    const frame = byId('scene-frame');
    frame.addEventListener('pointermove', (event) => {
      if (!this.#holds) return;
      const { left, width } = frame.getBoundingClientRect();
      // Like a tray: to the right, its right end goes down.
      this.#tilt(-WIDEST * (2 * ((event.clientX - left) / width) - 1));
    });
    addEventListener('keydown', (event) => {
      const by = { ArrowLeft: BY_KEY, ArrowRight: -BY_KEY }[event.key];
      if (!this.#holds || !by || event.defaultPrevented) return;
      event.preventDefault();
      this.#tilt((page.view.tilt ?? 0) + by);
    });
    page.run.watch({
      changed: () => {
        if (this.#holds && page.run.phase === 'ended') this.#end();
      },
      struck: () => {
        if (this.#holds) page.verdict?.plays(`Held ${page.run.impacts.last?.n ?? 0}`);
      },
    });
  }

  /** @param {number} tilt rad */
  #tilt(tilt) {
    // The first move lets the body go.
    if (this.#page.run.phase === 'idle') {
      this.#sent = 0;
      start(this.#page);
      this.#follow();
    }
    this.#page.view.tilt = Math.min(WIDEST, Math.max(-WIDEST, Number(tilt.toFixed(3))));
    this.#page.view.redraw();
  }

  toggle() {
    if (this.#holds) return this.#end();
    const page = this.#page;
    const one = page.cases.find(({ name }) => name === CASE);
    if (!one) return;
    const scene = structuredClone(one.scene);
    scene.table = { ...scene.table, tilt_gain: 0, errors: { tilt_offset: 0 } };
    scene.release = { ...scene.release, theta: ANGLE };
    scene.topple_angle = FALLEN;
    this.#speed = page.speed;
    page.speed = SPEED;
    page.history?.record('the table in your hand');
    page.chosen = null;
    page.run.reset();
    present(page, scene);
    this.#holds = true;
    this.#button.setAttribute('aria-pressed', 'true');
    const how = matchMedia('(pointer: coarse)').matches
      ? 'Slide a finger over the scene'
      : 'Move the pointer over the scene, or press ← and →';
    byId('case-shows').textContent = `${how}: the table tilts. Keep the rod up.`;
    page.verdict?.plays('You hold the table');
    this.#hint(false);
    byId('scene-card').scrollIntoView({ block: 'nearest' });
    page.view.tilt = 0;
  }

  /** The hint to drag the rod, which a hand at the table cannot. @param {boolean} shown */
  #hint(shown) {
    for (const hint of document.querySelectorAll('.intro .how')) hint.toggleAttribute('hidden', !shown);
  }

  /** Sends the tilt of each bounce just before it. */
  #follow() {
    if (!this.#holds) return;
    const { run, view } = this.#page;
    const arc = run.phase === 'running' ? run.arcAt(Infinity) : null;
    const next = (run.impacts.last?.n ?? 0) + 1;
    if (arc && next > this.#sent && (arc.t + arc.duration - run.clock.runTime()) / run.clock.speed < AHEAD_S) {
      this.#sent = next;
      run.send({ type: 'set', [TILT]: view.tilt ?? 0 });
    }
    requestAnimationFrame(() => this.#follow());
  }

  #end() {
    const { run, view, cases } = this.#page;
    this.#holds = false;
    this.#button.setAttribute('aria-pressed', 'false');
    view.tilt = null;
    this.#page.verdict?.plays(null);
    this.#hint(true);
    this.#page.speed = this.#speed;
    if (run.phase !== 'ended') return;
    const held = Math.max(0, (run.outcome?.bounces ?? 0) - 1);
    const gain = cases.find(({ name }) => name === CASE)?.scene.table?.tilt_gain;
    byId('case-shows').textContent =
      `You held ${held} ${held === 1 ? 'bounce' : 'bounces'}. A table with κ = ${gain} holds 2000.`;
  }

  /** The address opens the challenge. */
  query() {
    return new URLSearchParams(this.#holds ? [['you', 'table']] : []);
  }

  /** @param {URLSearchParams} link @returns {string[]} */
  restore(link) {
    if (link.get('you') === 'table' && !this.#holds) this.toggle();
    return [];
  }
}
