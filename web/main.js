// The entry of the page: makes its parts, asks for fields and cases, and brings the rest after the first plot.

import { get, server } from './api/client.js';
import { Page } from './app/page.js';
import { showRun, watchRun } from './app/run-watcher.js';
import { choose, plain, restore } from './app/scenes.js';
import { byId, h } from './dom/elements.js';
import { clearNotice, notice } from './dom/notices.js';
import { knowTitles } from './dom/typeset.js';

const page = new Page();
watchRun(page);

/** @param {string} words @param {string} label @param {() => void} again */
function failed(words, label, again) {
  // The looks of notices come late too.
  document.head.append(h('link', { rel: 'stylesheet', href: 'app/app.css' }));
  const button = h('button', { type: 'button', click: again }, label);
  notice('server', [words, button], { dismissible: false, caution: true });
}

async function begin() {
  try {
    const [table, list] = await Promise.all([get('v1/fields'), get('v1/scenes')]);
    clearNotice('server');
    page.fields = table.items;
    knowTitles(page.fields);
    page.cases = list.items;
  } catch {
    byId('verdict').textContent = 'The server does not answer.';
    return failed('The server does not answer. ', 'Try again', begin);
  }
  offerCases();
  byId('build').textContent = server.build;
  restore(page, location.search);
  showRun(page);
  // The first look is drawn in the next frame; what nobody sees yet comes after.
  await new Promise((resolve) => requestAnimationFrame(resolve));
  performance.mark('first plot');
  const [following, late] = await Promise.all([
    import('./app/follow.js')
      .then(({ beginToFollow }) => beginToFollow(page))
      .then(
        () => true,
        () => false,
      ),
    import('./app/late/late-parts.js').catch(() => null),
  ]);
  if (late) await late.bringLateParts(page);
  // A browser remembers a module that it did not get, so that only a fresh page gets it.
  if (!late || !following) failed('Part of the page did not load. ', 'Load it again', () => location.reload());
}

function offerCases() {
  const { chooser, cases } = page;
  chooser.replaceChildren(
    h('option', { value: '', hidden: true }, 'A scene of your own'),
    ...cases.map(({ name, title }) => h('option', { value: name }, plain(title))),
  );
  chooser.disabled = false;
  chooser.addEventListener('change', () => {
    const one = cases.find(({ name }) => name === chooser.value);
    if (one) choose(page, one);
  });
}

addEventListener('popstate', () => {
  page.history?.record('the way back');
  restore(page, location.search);
});
showRun(page);
// Panels that stood in tabs once have places of their own.
if (
  /[?&](tab=(?!map|values|why|more|run|orbits|catch)|(reading|gallery|precision|ladder|survival|design|fit|measured|calls)\.)/.test(
    location.search,
  )
)
  void import('./paper/moved.js').then(({ go }) => void (go(location.search) || begin()));
else void begin();
