// Steps on the stability map that several tests take.

import { drawn, openPanel } from './stage.js';

/** Opens the page and goes down to the map. */
export async function openMap(stage, query, options) {
  const opened = await stage.page(query, options);
  await openPanel(opened.page, 'map');
  // Its settings are folded.
  await opened.page.click('#map-options > summary');
  await opened.page.locator('#map-box canvas').first().waitFor();
  return opened;
}

/** Waits until the map is whole. */
export async function whole(page) {
  await page.locator('#map-told', { hasText: /cells[:,] \w/ }).waitFor();
  await page.locator('#map-box[aria-busy=false]').waitFor();
}

/** A place of the cells on the screen, by shares. The room of the axes is known. */
export async function place(page, across, upwards) {
  const box = await page.locator('#map-box').boundingBox();
  return [box.x + 52 + (box.width - 66) * across, box.y + 26 + (box.height - 66) * (1 - upwards)];
}

/** Waits until the map has answered anew after `act`. */
export async function anew(page, act) {
  const before = await page.locator('#map-links a').first().getAttribute('href');
  await act();
  await page.waitForFunction((old) => document.querySelector('#map-links a')?.getAttribute('href') !== old, before);
  await whole(page);
}

/** The colour at a share of the map, as [r, g, b, a]. */
export async function colourAt(page, across, upwards) {
  await drawn(page);
  return page
    .locator('#map-box canvas')
    .first()
    .evaluate(
      (canvas, [right, up]) => {
        const ratio = devicePixelRatio;
        const copy = Object.assign(document.createElement('canvas'), {
          width: canvas.width,
          height: canvas.height,
        }).getContext('2d', { willReadFrequently: true });
        copy.drawImage(canvas, 0, 0);
        return [
          ...copy.getImageData(
            Math.round(52 * ratio + (canvas.width - 66 * ratio) * right),
            Math.round(26 * ratio + (canvas.height - 66 * ratio) * (1 - up)),
            1,
            1,
          ).data,
        ];
      },
      [across, upwards],
    );
}

export const isColour = ([r, g, b], [R, G, B]) => Math.abs(r - R) + Math.abs(g - G) + Math.abs(b - B) < 30;
/** True when a cell has a colour, its hatching aside. */
export async function shows(page, across, upwards, colour) {
  const { width, height } = await page.locator('#map-box').boundingBox();
  let found = 0;
  for (const [right, up] of [
    [0, 0],
    [2, 0],
    [-2, 0],
    [0, 2],
    [0, -2],
  ])
    if (isColour(await colourAt(page, across + right / (width - 66), upwards + up / (height - 66)), colour)) found += 1;
  return found >= 2;
}
/** The colours of cells that survive and that fall at once, as web/style.css has them. */
export const SURVIVES = [0x2b, 0x80, 0x6b];
export const FALLS = [0xf0, 0xeb, 0xe4];
