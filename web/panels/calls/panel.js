// The panel of calls to the API that give what the page shows, for a shell, for Python and for JavaScript.

import { curl } from '../../export/save-actions.js';
import { html } from '../../vendor/preact/preact.js';
import { Code } from '../parts.js';
import { useSettings } from '../settings.js';

/** Text in quotes, as JSON, Python and JavaScript write it. @param {string} text */
const quoted = (text) => JSON.stringify(text);

/** The address without its query, the fields of the query as lines, and whether the answer is JSON. @param {string} path @param {string} indent */
function parts(path, indent) {
  const { origin, pathname, searchParams } = new URL(path, document.baseURI);
  const lines = [...searchParams].map(([name, value]) => `${indent}${quoted(name)}: ${quoted(value)},`);
  return { address: origin + pathname, fields: lines.join('\n'), isJson: !searchParams.has('format') };
}

/** @param {string} path */
function python(path) {
  const { address, fields, isJson } = parts(path, '    ');
  return `from urllib.parse import urlencode
from urllib.request import urlopen
${isJson ? 'import json\n' : ''}
query = {
${fields}
}
with urlopen(${quoted(`${address}?`)} + urlencode(query)) as answer:
    print(${isJson ? 'json.load(answer)' : 'answer.read().decode()'})`;
}

/** @param {string} path */
function javascript(path) {
  const { address, fields, isJson } = parts(path, '  ');
  return `const query = new URLSearchParams({
${fields}
});
const answer = await fetch(\`${address}?\${query}\`);
if (!answer.ok) throw new Error(await answer.text());
console.log(await answer.${isJson ? 'json' : 'text'}());`;
}

/** Languages with their names, short names, and the call of a path from where the page is. @type {Record<string, [title: string, short: string, call: (path: string) => string]>} */
const LANGUAGES = {
  curl: ['Shell (curl)', 'curl', curl],
  python: ['Python', 'Python', python],
  javascript: ['JavaScript', 'JavaScript', javascript],
};

const choices = Object.fromEntries(Object.entries(LANGUAGES).map(([name, [title]]) => [name, title]));
const SETTINGS = { language: { label: 'Language', usual: 'curl', choices } };

/** @param {{page: PanelPage}} props */
export function Calls({ page }) {
  const { values } = useSettings(page, 'calls', SETTINGS);
  const { query } = page;
  const [, short, call] = LANGUAGES[values.language];
  const calls = {
    'Verdict and eigenvalues': `v1/stability?${query}`,
    'Every bounce, as columns': `v1/trajectories?${query}&bounces=1000`,
    'The same as CSV': `v1/trajectories?${query}&bounces=1000&format=csv`,
    'Jacobian at the fixed point': `v1/jacobians?${query}`,
  };
  const choice = (/** @type {[name: string, title: string]} */ [name, title]) =>
    html`<label class="choice"><input type="radio" name="calls-language" value=${name} checked=${name === values.language}
      onChange=${() => page.part({ 'calls.language': name === 'curl' ? null : name })} /> ${title}</label>`;
  return html`<div class="calls">
    <fieldset class="choices row"><legend class="unseen">Language</legend>${Object.entries(choices).map(choice)}</fieldset>
    ${query && Object.entries(calls).map(([title, path]) => html`<${Code} key=${title} title=${title} code=${call(path)} copier=${`Copy ${short}`} open=${path} />`)}
  </div>`;
}
