// Addresses of what stood in tabs of this page and has a place of its own now.

/** Places of tabs. @type {Record<string, string>} */
const TABS = { paper: 'reading', limits: 'gallery', accuracy: 'precision', models: 'ladder' };

/**
 * Goes where the address of this page leads now. False if it leads here.
 * @param {string} search
 */
export function go(search) {
  const query = new URLSearchParams(search);
  const item = query.get('reading.item');
  const failure = query.get('gallery.case');
  const part = [...query.keys()].map((key) => /^(precision|ladder)\./.exec(key)?.[1]).find(Boolean);
  const tab = query.get('tab');
  const place = item ?? (failure && `failure-${failure}`) ?? TABS[tab ?? ''] ?? (tab === null ? part : null);
  if (!place) return false;
  for (const key of ['tab', 'reading.item', 'gallery.case']) query.delete(key);
  location.replace(`paper${query.size > 0 ? `?${query}` : ''}#${encodeURIComponent(place)}`);
  return true;
}
