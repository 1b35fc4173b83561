// Writes contract.d.ts, the types of the server's answers, from openapi.yaml. With --check it only says whether the file is current.

import { readFileSync, writeFileSync } from 'node:fs';
import { load } from 'js-yaml';
import openapiTS, { astToString } from 'openapi-typescript';

const FILE = new URL('contract.d.ts', import.meta.url);
const HEAD =
  '// The shapes of requests and answers. Written by `node tests/browser/contract.js` from openapi.yaml; not to be edited.\n\n';

/** The schemas alone, without prose: the page names a shape by its schema, and the prose is in the contract. */
function schemasOf(contract) {
  const bare = (node) => {
    if (Array.isArray(node)) return node.map(bare);
    if (node === null || typeof node !== 'object') return node;
    // A property may have one of these names too; then it is a schema and no text.
    const kept = Object.entries(node).filter(([key, value]) => !(key === 'description' && typeof value === 'string'));
    return Object.fromEntries(kept.map(([key, value]) => [key, bare(value)]));
  };
  const { openapi, info, components } = contract;
  return { openapi, info, paths: {}, components: { schemas: bare(components.schemas) } };
}

const contract = load(readFileSync(new URL('../../openapi.yaml', import.meta.url), 'utf8'));
const text =
  HEAD +
  astToString(await openapiTS(schemasOf(contract), { silent: true, rootTypes: true, rootTypesNoSchemaPrefix: true }));
if (!process.argv.includes('--check')) writeFileSync(FILE, text);
else if (readFileSync(FILE, 'utf8') !== text) {
  console.error('contract.d.ts is not what openapi.yaml gives: run node tests/browser/contract.js');
  process.exit(1);
}
