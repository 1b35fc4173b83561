// Shows /openapi.json with Swagger UI, so that every operation can be read and tried.
// Not here: any word about the API; those are all in openapi.yaml.

/* global SwaggerUIBundle */

import { arrive } from '../app/arrive.js';

/** Query parameters as a form should start with them: empty, because the viewer would fill in and send every default. */
function withoutPrefill(contract) {
  for (const parameter of Object.values(contract.components.parameters)) {
    if (parameter.in !== 'query' || parameter.name === 'preset') continue;
    const place = parameter.schema.$ref?.split('/').slice(1);
    const schema = { ...(place?.reduce((node, key) => node[key], contract) ?? parameter.schema) };
    const rest = schema.default ?? schema['x-default'];
    if (rest !== undefined)
      parameter.description += ` Unless given${'x-default' in schema ? ', by a preset too' : ''}: ${rest}.`;
    delete schema.default;
    delete parameter.example;
    parameter.schema = schema;
  }
  return contract;
}

/** The queries that run as printed, as links under their operation. */
function withLinks(contract) {
  for (const [path, item] of Object.entries(contract.paths)) {
    const queries = item.get?.['x-queries']?.filter((query) => query && !path.includes('{'));
    if (!queries?.length) continue;
    const links = queries.map((query) => `- [${path}?${query}](${path}?${query})`);
    item.get.description = `${item.get.description ?? ''}\n\n${links.join('\n')}\n`;
  }
  return contract;
}

/** Requests go to the server that serves the page; the browser lets it ask no other. */
function onThisServer(contract) {
  contract.servers = contract.servers.filter(({ url }) => !url.includes('://'));
  return contract;
}

function showProblem() {
  // The viewer, which keeps its own place in the hash, puts a slash before what it does not know.
  const id = location.hash.replace(/^#\/?/, '');
  if (!id.startsWith('problem')) return;
  document.querySelector('.target')?.classList.remove('target');
  const target = document.getElementById(id);
  target?.classList.add('target');
  target?.scrollIntoView();
}

async function show() {
  const state = document.getElementById('state');
  try {
    const answer = await fetch('openapi.json');
    if (!answer.ok) throw new Error(`/openapi.json answered ${answer.status}`);
    const contract = onThisServer(withLinks(withoutPrefill(await answer.json())));
    SwaggerUIBundle({
      spec: contract,
      domNode: document.getElementById('contract'),
      validatorUrl: null,
      deepLinking: true,
      defaultModelsExpandDepth: 0,
      displayRequestDuration: true,
      showExtensions: true,
      syntaxHighlight: { activated: true, theme: 'agate' },
      supportedSubmitMethods: ['get', 'head', 'post'],
    });
    arrive(document.getElementById('contract'), showProblem);
    addEventListener('hashchange', showProblem);
  } catch (error) {
    state.textContent = `The contract could not be read: ${error.message}`;
  }
}

show();
