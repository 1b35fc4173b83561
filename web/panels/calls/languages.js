// A request of the API as a command of a shell, and as a few lines of Python and of JavaScript.

import { curl } from '../../export/save-actions.js';

/** @typedef {keyof typeof LANGUAGES} Language */

export const LANGUAGES = {
  curl: { title: 'Shell (curl)', short: 'curl' },
  python: { title: 'Python', short: 'Python' },
  javascript: { title: 'JavaScript', short: 'JavaScript' },
};

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

/** @param {Language} language @param {string} path from where the page is */
export const call = (language, path) => ({ curl, python, javascript })[language](path);
