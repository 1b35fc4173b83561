// Writes the tables that the page shares with the server, from the server's sources: the colours of maps and of pictures, and the words
// for endings. With --check it only says whether they are current.

import { readFileSync, writeFileSync } from 'node:fs';

const root = new URL('../../', import.meta.url);
const read = (path) => readFileSync(new URL(path, root), 'utf8');
const note = (source) => `// Written by \`node tests/browser/shared-tables.js\` from ${source}; not to be edited.\n\n`;

/** The part of a source that a pattern captures; a source of another form is a fault. */
function part(path, pattern) {
  const found = pattern.exec(read(path));
  if (!found) throw new Error(`${path} has no ${pattern}`);
  return found[1];
}

/** The colours from the darkest on, six hexadecimal digits each. */
function cividis() {
  const path = 'server/charts/draw/colour.rs';
  const digits = part(path, /const TABLE: &str = "\\\n([^"]*)"/).replace(/[\s\\]/g, '');
  const lines = digits.match(/.{1,96}/g).map((line) => `  "${line.match(/.{6}/g).join('", "')}"`);
  return `[\n${lines.join(',\n')}\n]\n`;
}

/** The page's colours for those of the server's pictures; a colour that is not listed stays as it is. */
const PAGE_COLOURS = {
  PAPER: 'surface',
  EDGE: 'edge',
  INK: 'ink',
  SOFT_INK: 'muted',
  AXIS: 'muted',
  ZERO: 'line',
  GRID: 'faint',
  BLUE: 'series-0',
  PALE_BLUE: 'figure-pale-blue',
  VERMILION: 'strike',
  GREEN: 'series-2',
  PURPLE: 'series-3',
  SKY: 'figure-sky',
  ORANGE: 'figure-orange',
  LIGHT_GREEN: 'figure-light',
  PALE_GREEN: 'figure-pale',
};

function figureColours() {
  const path = 'server/charts/draw/colour.rs';
  const rules = Object.entries(PAGE_COLOURS).flatMap(([name, property]) => {
    const colour = part(path, new RegExp(`const ${name}: &str = "(#[0-9a-f]{6})"`));
    return ['fill', 'stroke'].map((kind) => `.figure [${kind}='${colour}'] {\n  ${kind}: var(--${property});\n}\n`);
  });
  return `${note(path).replace('// ', '/* ').trimEnd()} */\n${rules.join('')}`;
}

/** Verb and reason for each ending but that of a run that goes through, from the headline of a run. */
function endings() {
  const path = 'server/api/shared/outcome.rs';
  const arms = part(path, /\npub fn headline\([^{]*\{([\s\S]*?)\n\}/);
  const caught = part(path, /fn caught_words\([^{]*\{([\s\S]*?)\n\}/);
  const words = [
    ...arms.matchAll(/EndingKind::(\w+) => \("([^"]+)", "([^"]+)"\)/g),
    // A run that goes beyond a limit has the same words either way.
    ...[...caught.matchAll(/CatchOutcomeKind::(\w+) => \("([^"]+)", "([^"]+)"\)/g)].filter(
      ([, variant]) => variant !== 'BeyondLimits',
    ),
  ];
  const rows = words.map(([, variant, verb, reason]) => {
    const kind = variant.replace(/\B[A-Z]/g, '_$&').toLowerCase();
    return `  "${kind}": ${JSON.stringify({ verb, reason })}`;
  });
  if (rows.length < 13) throw new Error(`${path} has ${rows.length} endings with words`);
  return `{\n${rows.join(',\n')}\n}\n`;
}

for (const [path, text] of [
  ['web/run/generated/endings.json', endings()],
  ['web/charts/generated/cividis.json', cividis()],
  ['web/charts/generated/figure-colours.css', figureColours()],
]) {
  if (!process.argv.includes('--check')) writeFileSync(new URL(path, root), text);
  else if (read(path) !== text) {
    console.error(`${path} is not what the server has: run node tests/browser/shared-tables.js`);
    process.exitCode = 1;
  }
}
