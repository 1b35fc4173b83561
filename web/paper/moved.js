// Addresses of what stood in tabs of the first page and has a place of its own now.

/** Pages and places of tabs. @type {Record<string, [string, string]>} */
const TABS = {
  paper: ['paper', 'reading'],
  limits: ['paper', 'gallery'],
  accuracy: ['paper', 'precision'],
  models: ['paper', 'ladder'],
  noise: ['rig', 'noise'],
  control: ['rig', 'controller'],
  measured: ['rig', 'measurements'],
  fit: ['rig', 'measurements'],
  api: ['rig', 'watch'],
};

/** Tabs of panels by the beginning of their part of the address. @type {Record<string, keyof typeof TABS>} */
const PARTS = {
  precision: 'accuracy',
  ladder: 'models',
  survival: 'noise',
  design: 'control',
  measured: 'measured',
  fit: 'fit',
  calls: 'api',
};

/**
 * Goes where the address of this page leads now. False if it leads here.
 * @param {string} search
 */
export function go(search) {
  const query = new URLSearchParams(search);
  const item = query.get('reading.item');
  const failure = query.get('gallery.case');
  const part = [...query.keys()].map((key) => PARTS[key.split('.')[0]]).find(Boolean);
  const tab = query.get('tab') ?? part;
  const named = item ?? (failure && `failure-${failure}`);
  const [page, place] = named ? ['paper', named] : (TABS[tab ?? ''] ?? []);
  if (!page) return false;
  for (const key of ['tab', 'reading.item', 'gallery.case']) query.delete(key);
  location.replace(`${page}${query.size > 0 ? `?${query}` : ''}#${encodeURIComponent(place)}`);
  return true;
}
