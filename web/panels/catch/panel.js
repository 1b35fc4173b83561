// The panel that catches the body of the page's scene, tells how, and catches, throws and juggles in the run under way.

import { LatestRequest } from '../../api/latest-request.js';
import { Problem, get, wordsOf } from '../../api/client.js';
import { serverFigure } from '../../charts/readable/server-figure.js';
import { h } from '../../dom/elements.js';
import { entries } from '../../dom/tables.js';
import { capitalized, marked, prose } from '../../dom/typeset.js';
import { actions } from '../../export/save-actions.js';
import { candidates, demands, facts, strikesTable, told } from './answer.js';
import { LiveCatch } from './live.js';
import { catchPicture } from './picture.js';
import { ReachMap } from './reach.js';
import { CatchSettings } from './settings.js';

/** @typedef {import('contract').Catch} Catch */

/** @type {import('../card.js').Module['mount']} */
export const mount = (root, page) => new CatchPanel(root, page);

class CatchPanel {
  #page;
  #settings;
  /** @type {LiveCatch | null} */
  #live = null;
  #reach;
  #told = h('div', { class: 'catch-told', id: 'catch-told', role: 'status' });
  #sheet = h('div', { class: 'catch-sheet', id: 'catch-sheet', hidden: true });
  #latest = new LatestRequest();

  /**
   * @param {HTMLElement} root
   * @param {import('../card.js').PanelPage} page
   */
  constructor(root, page) {
    this.#page = page;
    const settings = new CatchSettings(() => {
      this.#voided('The settings have changed since; catch anew with them.');
      page.changed();
    });
    this.#settings = settings;
    this.#reach = new ReachMap(() => this.#request('catch.'));
    if (page.guide)
      this.#live = new LiveCatch(page.guide, {
        settings: () => settings.read(),
        blame: (errors) => settings.blame(errors),
        changed: () => page.changed(),
      });
    root.append(
      h(
        'form',
        {
          novalidate: true,
          submit: (/** @type {Event} */ event) => {
            event.preventDefault();
            void this.ask();
          },
        },
        h(
          'div',
          { class: 'catch-act' },
          h('button', { type: 'submit', id: 'catch-start', class: 'primary' }, 'Catch'),
          this.#told,
        ),
        settings.element,
      ),
      this.#sheet,
      ...(this.#live ? [this.#live.element] : []),
      this.#reach.element,
    );
    this.#told.append(
      h(
        'p',
        {},
        'After a release of this scene, the table brings the body to rest and keeps it upright in lasting contact.',
      ),
    );
  }

  /** The panel's part of the address. */
  query() {
    return new URLSearchParams([...this.#settings.query(), ...(this.#live?.query() ?? [])]);
  }

  /** @param {URLSearchParams} link */
  restore(link) {
    return [...this.#settings.restore(link), ...(this.#live?.restore(link) ?? [])];
  }

  /** The scene of the page is another one. */
  sceneChanged() {
    this.#live?.show();
    this.#voided('The scene has changed since; catch anew for it.');
  }

  /** Marks the shown answer as one to another request. @param {string} words */
  #voided(words) {
    this.#latest.cancel();
    this.#reach.stale();
    if (this.#sheet.hidden) return;
    this.#told.replaceChildren(h('p', {}, words));
    this.#sheet.classList.add('stale');
  }

  retell() {
    if (!this.#sheet.hidden) void this.ask();
  }

  /** The scene with the settings, each name after `under`; null where something typed is wrong, which is marked. @param {string} under */
  #request(under) {
    const settings = this.#settings.read();
    if (!settings) return null;
    const request = this.#page.query();
    if (!request) {
      this.#told.replaceChildren(h('p', {}, 'A parameter of the scene is not a number; it is marked among them.'));
      return null;
    }
    for (const [name, value] of Object.entries(settings)) request.set(under + name, String(value));
    return request;
  }

  async ask() {
    const request = this.#request('');
    if (!request) return;
    const signal = this.#latest.next();
    const path = `v1/catches?${request}`;
    try {
      const [answer, figure] = await Promise.all([get(path, signal), serverFigure(`${path}&format=svg`, signal)]);
      if (!signal.aborted) this.#show(answer, figure, path);
    } catch (error) {
      if (signal.aborted) return;
      this.#sheet.hidden = true;
      const others =
        error instanceof Problem && error.errors.length > 0 ? this.#settings.blame(error.errors) : [wordsOf(error)];
      const words = others.join(' ') || 'A setting is out of its range; it is marked.';
      this.#told.replaceChildren(h('p', {}, ...marked(words)));
    }
  }

  /** @param {Catch} answer @param {SVGSVGElement} figure @param {string} path */
  #show(answer, figure, path) {
    const words = told(answer);
    this.#told.replaceChildren(...words);
    const { notes } = answer;
    this.#sheet.replaceChildren(
      catchPicture(figure, answer, `Angle, height, place and table speed over time. ${words[0].textContent}`),
      h(
        'div',
        { class: 'catch-numbers' },
        h('dl', { class: 'numbers', id: 'catch-facts' }, ...entries(facts(answer))),
        demands(answer),
        ...candidates(answer),
        notes.length > 0 &&
          h(
            'div',
            { id: 'catch-notes' },
            ...notes.map((note) => h('p', { class: 'muted small' }, ...prose(capitalized(note)), '.')),
          ),
        h('details', {}, h('summary', {}, 'Strikes'), strikesTable(answer)),
        h(
          'p',
          { class: 'actions', id: 'catch-links' },
          ...actions({ id: 'catch', title: 'Catch the body', path, formats: ['svg', 'png', 'csv', 'json'] }),
        ),
      ),
    );
    this.#sheet.classList.remove('stale');
    this.#sheet.hidden = false;
  }
}
