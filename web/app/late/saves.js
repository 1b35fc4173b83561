// The things to save of a chart of the page: its picture, and the request for its numbers.

import { updateAddress } from '../address-bar.js';
import { impactsPath, playedQuery, typedQuery } from '../queries.js';

/**
 * @param {import('../page.js').Page} page
 * @param {string} id
 * @param {string} title
 * @param {import('../../export/capture.js').Layered} [view] where the page draws it; else the server does
 * @returns {import('../../export/save-actions.js').Saves}
 */
export function savesOf(page, id, title, view) {
  // The frame that embeds the chart is at the page's address.
  updateAddress(page);
  const query = id === 'circle' ? (typedQuery(page) ?? playedQuery(page)) : null;
  const path = id === 'circle' ? query && `v1/stability?${query}` : impactsPath(page);
  return { id, title, view, formats: view ? ['csv', 'arrow', 'json'] : ['svg', 'png', 'csv', 'arrow', 'json'], path };
}
