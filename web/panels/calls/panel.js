// The panel of calls to the API that give what the page shows, for a shell, for Python and for JavaScript.

import { curl } from '../../export/save-actions.js';
import { html } from '../../vendor/preact/preact.js';
import { Code } from '../parts.js';
import { useSettings } from '../settings.js';

/** Text in quotes, as JSON, Python and JavaScript write it. @param {string} text */
const quoted = (text) => JSON.stringify(text);

/** The address without its query, the fields of the query, and whether the answer is JSON. @param {string} path */
function parts(path) {
  const { origin, pathname, searchParams } = new URL(path, document.baseURI);
  const isJson = (searchParams.get('format') ?? 'json') === 'json';
  return { address: origin + pathname, fields: [...searchParams], isJson };
}

/** @param {string} path */
function python(path) {
  const { address, fields, isJson } = parts(path);
  const lines = fields.map(([name, value]) => `    ${quoted(name)}: ${quoted(value)},`);
  return [
    'from urllib.parse import urlencode',
    'from urllib.request import urlopen',
    ...(isJson ? ['import json'] : []),
    '',
    'query = {',
    ...lines,
    '}',
    `with urlopen(${quoted(`${address}?`)} + urlencode(query)) as answer:`,
    isJson ? '    print(json.load(answer))' : '    print(answer.read().decode())',
  ].join('\n');
}

/** @param {string} path */
function javascript(path) {
  const { address, fields, isJson } = parts(path);
  const lines = fields.map(([name, value]) => `  ${quoted(name)}: ${quoted(value)},`);
  return [
    'const query = new URLSearchParams({',
    ...lines,
    '});',
    `const answer = await fetch(\`${address}?\${query}\`);`,
    'if (!answer.ok) throw new Error(await answer.text());',
    `console.log(await answer.${isJson ? 'json' : 'text'}());`,
  ].join('\n');
}

/** Languages with their names, and the call of a path from where the page is. @type {Record<string, {title: string, short: string, call: (path: string) => string}>} */
const LANGUAGES = {
  curl: { title: 'Shell (curl)', short: 'curl', call: curl },
  python: { title: 'Python', short: 'Python', call: python },
  javascript: { title: 'JavaScript', short: 'JavaScript', call: javascript },
};

const SETTINGS = {
  language: {
    label: 'Language',
    usual: 'curl',
    choices: Object.fromEntries(Object.entries(LANGUAGES).map(([name, { title }]) => [name, title])),
  },
};

/** @param {{page: import('../settings.js').Page}} props */
export function Calls({ page }) {
  const { values } = useSettings(page, 'calls', SETTINGS);
  const { query } = page;
  const { short, call } = LANGUAGES[values.language];
  const calls = {
    'Verdict and eigenvalues': `v1/stability?${query}`,
    'Every bounce, as columns': `v1/trajectories?${query}&bounces=1000`,
    'The same as CSV': `v1/trajectories?${query}&bounces=1000&format=csv`,
    'Jacobian at the fixed point': `v1/jacobians?${query}`,
  };
  return html`<div class="calls"><fieldset class="choices">
      <legend class="unseen">Language</legend>
      ${Object.entries(LANGUAGES).map(([name, { title }]) => html`<label class="choice"><input type="radio" name="calls-language" value=${name} checked=${name === values.language} onChange=${() => page.part({ 'calls.language': name === 'curl' ? null : name })} /> ${title}</label>`)}
    </fieldset>
    ${query && Object.entries(calls).map(([title, path]) => html`<${Code} key=${title} title=${title} code=${call(path)} copier=${`Copy ${short}`} open=${path} />`)}</div>`;
}
