// Writes contract.d.ts, the types of the answers that the page uses, from openapi.yaml. With --check it only says whether the file is current.

import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { load } from 'js-yaml';
import openapiTS, { astToString } from 'openapi-typescript';

const FILE = new URL('contract.d.ts', import.meta.url);
const WEB = new URL('../../web/', import.meta.url);
const HEAD =
  '// The shapes of requests and answers that the page uses. Written by `node tests/browser/contract.js` from openapi.yaml; not to be edited.\n\n';

/** The names of the schemas that the page imports. */
function imported() {
  const scripts = readdirSync(WEB, { recursive: true }).filter((name) => /^(?!vendor).*\.js$/.test(name));
  const files = [new URL('page.d.ts', import.meta.url), ...scripts.map((name) => new URL(name, WEB))];
  const text = files.map((file) => readFileSync(file, 'utf8')).join('\n');
  const imports = text.matchAll(/import\('contract'\)\.(\w+)|@import \{ (.+) \} from 'contract'/g);
  return [...imports].flatMap(([, one, several]) => one ?? several.split(', ').map((name) => name.split(' ')[0]));
}

/** The schemas that are named, and those in them, without prose: that is in the contract. */
function schemasOf({ openapi, info, components: { schemas } }, names) {
  const used = new Set(names);
  const bare = (node) => {
    if (Array.isArray(node)) return node.map(bare);
    if (node === null || typeof node !== 'object') return node;
    if (node.$ref) used.add(node.$ref.replace('#/components/schemas/', ''));
    // A property may have one of these names too; then it is a schema and no text.
    const kept = Object.entries(node).filter(([key, value]) => !(key === 'description' && typeof value === 'string'));
    return Object.fromEntries(kept.map(([key, value]) => [key, bare(value)]));
  };
  const found = {};
  // The set grows on the way.
  for (const name of used) found[name] = bare(schemas[name]);
  const sorted = Object.fromEntries(Object.entries(found).sort(([one], [other]) => (one < other ? -1 : 1)));
  return { openapi, info, paths: {}, components: { schemas: sorted } };
}

const contract = load(readFileSync(new URL('../../openapi.yaml', import.meta.url), 'utf8'));
const names = imported();
const options = { silent: true, rootTypes: true, rootTypesNoSchemaPrefix: true };
const types = astToString(await openapiTS(schemasOf(contract, names), options));
// The others have their names within these alone.
const text =
  HEAD + types.replace(/^export type (\w+) = components.*\n/gm, (line, name) => (names.includes(name) ? line : ''));
if (!process.argv.includes('--check')) writeFileSync(FILE, text);
else if (readFileSync(FILE, 'utf8') !== text) {
  console.error('contract.d.ts is not what openapi.yaml gives: run node tests/browser/contract.js');
  process.exit(1);
}
