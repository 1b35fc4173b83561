// Steps on the stability map that several tests take.

import { openPanel } from './stage.js';

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
