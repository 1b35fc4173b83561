// Steps on the stability map that several tests take.

import { drawn, openPanel } from './stage.js';

/** Opens the page and goes down to the map. */
export async function openMap(stage, query, options) {
  const opened = await stage.page(query, options);
  await openPanel(opened.page, 'map');
  await opened.page.locator('#map-box canvas').first().waitFor();
  return opened;
}

/** Waits until the map is whole. */
export async function whole(page) {
  await page.locator('#map-told', { hasText: /cells[:,] \w/ }).waitFor();
  await page.locator('#map-box[aria-busy=false]').waitFor();
}

/** The rectangle of the cells on the screen. The margins of axes and colour bar are known. */
export async function place(page, across, upwards) {
  const box = await page.locator('#map-box').boundingBox();
  return [box.x + 52 + (box.width - 52 - 18) * across, box.y + 24 + (box.height - 24 - 96) * (1 - upwards)];
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
            Math.round(52 * ratio + (canvas.width - 70 * ratio) * right),
            Math.round(24 * ratio + (canvas.height - 120 * ratio) * (1 - up)),
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
    if (isColour(await colourAt(page, across + right / (width - 70), upwards + up / (height - 120)), colour))
      found += 1;
  return found >= 2;
}
export const LIGHTEST = [254, 232, 56];
export const DARKEST = [0, 34, 78];
