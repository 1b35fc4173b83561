// Addresses of what stood in tabs of the first page and has a place of its own now.

import MOVED from './moved.json' with { type: 'json' };

/** Pages and places of tabs, and of panels by the beginning of their parts of the address. @type {Record<string, string[]>} */
const PLACES = MOVED;

/** Goes where the address of this page leads now. False if it leads here. @param {string} search */
export function go(search) {
  const query = new URLSearchParams(search);
  const item = query.get('reading.item');
  const failure = query.get('gallery.case');
  const part = [...query.keys()].map((key) => key.split('.')).find(([panel, of]) => of && panel in PLACES);
  const named = item ?? (failure && `failure-${failure}`);
  const [page, place] = named ? ['paper', named] : (PLACES[query.get('tab') ?? part?.[0] ?? ''] ?? []);
  if (!page) return false;
  for (const key of ['tab', 'reading.item', 'gallery.case']) query.delete(key);
  location.replace(`${page}${query.size > 0 ? `?${query}` : ''}#${encodeURIComponent(place)}`);
  return true;
}
