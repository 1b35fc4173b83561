// You are the table: the pointer tilts it, and the run keeps what the hand did as any other change.

import { differences } from '../api/scene-fields.js';
import { present } from '../app/scenes.js';
import { byId, h } from '../dom/elements.js';

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

/** @param {Page} page @returns {Neighbour} */
export function bringHand(page) {
  const { run, view } = page;
  const button = h('button', { type: 'button', id: 'you', 'aria-pressed': 'false' }, 'You are the table');
  /** True while the hand holds the table. */
  let holds = false;
  /** The scene of the game. @type {Scene} */
  let scene = {};
  /** The speed before. */
  let speed = 1;
  /** The bounce for which a tilt was sent last. */
  let sent = 0;

  const hold = (/** @type {boolean} */ wanted) => {
    holds = wanted;
    button.setAttribute('aria-pressed', String(wanted));
    view.tilt = wanted ? 0 : null;
    page.verdict?.tell({ played: wanted ? 'You hold the table' : null });
    // The hint to drag the rod, which a hand at the table cannot.
    for (const hint of document.querySelectorAll('.intro .how')) hint.toggleAttribute('hidden', wanted);
  };

  /** In place of the words on the scene, until it is another one. @param {string} words */
  const say = (words) => {
    const shows = byId('case-shows');
    shows.textContent = words;
    delete shows.dataset.words;
  };

  const begin = () => {
    const one = page.cases.find(({ name }) => name === CASE);
    if (!one) return;
    scene = structuredClone(one.scene);
    scene.table = { ...scene.table, tilt_gain: 0, errors: { tilt_offset: 0 } };
    scene.release = { ...scene.release, theta: ANGLE };
    scene.topple_angle = FALLEN;
    speed = page.speed;
    page.speed = SPEED;
    page.history?.record('the table in your hand');
    page.chosen = null;
    page.game = null;
    run.reset();
    present(page, scene);
    sent = 0;
    page.game = begin;
    hold(true);
    follow();
    const how = matchMedia('(pointer: coarse)').matches
      ? 'Slide a finger over the scene'
      : 'Move the pointer over the scene, or press ← and →';
    say(`${how}: the table tilts. Keep the rod up.`);
    byId('scene-card').scrollIntoView({ block: 'nearest' });
  };

  const end = () => {
    hold(false);
    page.speed = speed;
    if (run.phase !== 'ended') {
      page.game = null;
      return;
    }
    const held = Math.max(0, (run.outcome?.bounces ?? 0) - 1);
    const gain = page.cases.find(({ name }) => name === CASE)?.scene.table?.tilt_gain;
    say(`You held ${held} ${held === 1 ? 'bounce' : 'bounces'}. A table with κ = ${gain} holds 2000.`);
  };

  /** Sends the tilt of each bounce just before it. */
  const follow = () => {
    if (!holds) return;
    const arc = run.phase === 'running' ? run.arcAt(Infinity) : null;
    const next = (run.impacts.last?.n ?? 0) + 1;
    if (arc && next > sent && (arc.t + arc.duration - run.clock.runTime()) / run.clock.speed < AHEAD_S) {
      sent = next;
      run.send({ type: 'set', [TILT]: view.tilt ?? 0 });
    }
    requestAnimationFrame(follow);
  };

  /** @param {number} wanted rad */
  const tilt = (wanted) => {
    // The first move lets the body go.
    if (run.phase === 'idle') page.start();
    view.tilt = Math.min(WIDEST, Math.max(-WIDEST, Number(wanted.toFixed(3))));
    view.redraw();
  };

  /** Ends the game where the page shows another scene. */
  const leave = () => {
    const others = () => differences(page.fields, page.typed ?? {}, scene).some(({ field }) => field !== TILT);
    if (!page.game || (page.chosen === null && !others())) return;
    page.game = null;
    if (holds) end();
  };

  button.addEventListener('click', () => (holds ? end() : begin()));
  byId('stories').append(button);
  const frame = byId('scene-frame');
  frame.addEventListener('pointermove', (event) => {
    const { left, width } = frame.getBoundingClientRect();
    // Like a tray: to the right, its right end goes down.
    if (holds) tilt(-WIDEST * (2 * ((event.clientX - left) / width) - 1));
  });
  addEventListener('keydown', (event) => {
    const by = { ArrowLeft: BY_KEY, ArrowRight: -BY_KEY }[event.key];
    if (!holds || !by || event.defaultPrevented) return;
    event.preventDefault();
    tilt((view.tilt ?? 0) + by);
  });
  run.watch({
    changed: () => {
      if (holds && run.phase === 'ended') end();
    },
    cleared: leave,
    struck: () => {
      if (holds) page.verdict?.tell({ played: `Held ${run.impacts.last?.n ?? 0}` });
    },
  });
  return {
    // The address opens the challenge.
    query: () => new URLSearchParams(page.game ? [['you', 'table']] : []),
    restore: (link) => {
      if (link.get('you') === 'table' && !holds) begin();
      return [];
    },
  };
}
