// Checks the layout of web/: no circle of imports, no crowded folder, no long file.

import { readFileSync, readdirSync } from 'node:fs';
import { dirname, join, relative, resolve } from 'node:path';

const ROOT = new URL('../../web', import.meta.url).pathname;
const MOST_FILES = 12;
const MOST_LINES = 800;
/** Static, dynamic and type imports of a path. */
const IMPORT = /(?:from|import\()\s*'(\.{1,2}\/[^']+)'/g;

const faults = [];
/** The imports of each module, by path. @type {Map<string, string[]>} */
const imports = new Map();

function walk(folder) {
  const entries = readdirSync(folder, { withFileTypes: true });
  const files = entries.filter((entry) => entry.isFile()).map(({ name }) => join(folder, name));
  if (files.length > MOST_FILES)
    faults.push(`${relative(ROOT, folder)} has ${files.length} files, limit ${MOST_FILES}`);
  for (const file of files) {
    if (!/\.(js|css|html)$/.test(file)) continue;
    const text = readFileSync(file, 'utf8');
    const lines = text.split('\n').length - 1;
    if (lines > MOST_LINES) faults.push(`${relative(ROOT, file)} has ${lines} lines, limit ${MOST_LINES}`);
    if (file.endsWith('.js')) {
      imports.set(
        file,
        [...text.matchAll(IMPORT)].map(([, path]) => resolve(dirname(file), path)),
      );
    }
  }
  for (const entry of entries) if (entry.isDirectory() && entry.name !== 'vendor') walk(join(folder, entry.name));
}

/** The first circle of imports reached from a module. @returns {string[] | null} */
function circleFrom(module, way = [], done = new Set()) {
  const begin = way.indexOf(module);
  if (begin >= 0) return [...way.slice(begin), module];
  if (done.has(module)) return null;
  for (const next of imports.get(module) ?? []) {
    const circle = circleFrom(next, [...way, module], done);
    if (circle) return circle;
  }
  done.add(module);
  return null;
}

walk(ROOT);
const done = new Set();
for (const module of imports.keys()) {
  const circle = circleFrom(module, [], done);
  if (!circle) continue;
  faults.push(`circle of imports: ${circle.map((file) => relative(ROOT, file)).join(' → ')}`);
  for (const file of circle) done.add(file);
}
for (const fault of faults) console.error(fault);
process.exitCode = faults.length > 0 ? 1 : 0;
