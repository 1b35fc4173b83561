// What a first visitor meets in the window: controls, words, the smallest text, the shares of scene and map, requests before the run.

/** Counted in the page, in its window as it is. @param {import('playwright-core').Page} page */
export const firstScreen = (page) =>
  page.evaluate(() => {
    const inWindow = (/** @type {DOMRect} */ { left, top, right, bottom, width, height }) =>
      width > 2 && height > 2 && right > 0 && bottom > 0 && left < innerWidth && top < innerHeight;
    const seen = (/** @type {Element} */ element) =>
      element.checkVisibility({ visibilityProperty: true, opacityProperty: true }) &&
      !element.closest('.unseen, .skip, option');
    const controls = [
      ...document.querySelectorAll(
        'a[href], button, input, select, textarea, summary, [tabindex="0"]:not([role=tabpanel])',
      ),
    ].filter((one) => seen(one) && inWindow(one.getBoundingClientRect()));
    let words = 0;
    let smallest = Infinity;
    const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node = texts.nextNode(); node; node = texts.nextNode()) {
      const told = node.textContent?.trim();
      const parent = node.parentElement;
      if (!told || !parent || !seen(parent)) continue;
      const range = document.createRange();
      range.selectNodeContents(node);
      if (!inWindow(range.getBoundingClientRect())) continue;
      words += told.split(/\s+/).filter((word) => /[\p{L}\p{N}]/u.test(word)).length;
      smallest = Math.min(smallest, Number.parseFloat(getComputedStyle(parent).fontSize));
    }
    const share = (/** @type {string} */ selector) => {
      const box = document.querySelector(selector)?.getBoundingClientRect();
      return box ? (box.width * box.height) / (innerWidth * innerHeight) : 0;
    };
    return {
      controls: controls.map((one) => one.id || one.textContent?.trim().slice(0, 20) || one.tagName),
      words,
      smallest,
      scene: share('#scene-card'),
      map: share('#studies'),
      excess: document.documentElement.scrollWidth - innerWidth,
    };
  });

/** Files of the page, and requests in all, before its first run was asked for. @param {import('playwright-core').Page} page */
export const beforeRun = (page) =>
  page.evaluate(() => {
    const run = performance.getEntriesByName('run asked for')[0]?.startTime ?? Infinity;
    const all = performance.getEntriesByType('resource').filter(({ startTime }) => startTime <= run);
    return { run, requests: all.length + 1 };
  });
