// The panel that catches the body of the page's scene, tells how, and catches, throws and juggles in the run under way.

import { LatestRequest } from '../../api/latest-request.js';
import { Problem, wordsOf } from '../../api/client.js';
import { h } from '../../dom/elements.js';
import { entries } from '../../dom/tables.js';
import { capitalized, marked, prose } from '../../dom/typeset.js';
import { NO_SCENE, pictured, savings, study, studyForm } from '../study.js';
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
  #told;
  #sheet;
  #latest = new LatestRequest();

  /**
   * @param {HTMLElement} root
   * @param {import('../card.js').PanelPage} page
   */
  constructor(root, page) {
    this.#page = page;
    const { told, sheet } = study(root, 'catch');
    this.#told = told;
    this.#sheet = sheet;
    const settings = new CatchSettings(() => {
      this.#voided('The settings have changed since; catch anew with them.');
      page.changed();
    });
    this.#settings = settings;
    this.#reach = new ReachMap(() => this.#request('catch.'), page.open);
    if (page.guide)
      this.#live = new LiveCatch(page.guide, {
        settings: () => settings.read(),
        blame: (errors) => settings.blame(errors),
        changed: () => page.changed(),
      });
    root.append(
      studyForm('catch', 'Catch', () => void this.ask(), [told], [settings.element]),
      sheet,
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

  /** The scene with the settings, each name after `under`; null while the scene is not whole. @param {string} under */
  #request(under) {
    const settings = this.#settings.read();
    const request = this.#page.query();
    if (!request) {
      this.#told.replaceChildren(h('p', {}, NO_SCENE));
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
      const [answer, figure] = await pictured(path, signal);
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
      catchPicture(
        figure,
        answer,
        `Angle, height and place of the body, and tilt, height and speed of the table over time. ${words[0].textContent}`,
      ),
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
        savings('catch', 'Catch the body', path),
      ),
    );
    this.#sheet.classList.remove('stale');
    this.#sheet.hidden = false;
  }
}
