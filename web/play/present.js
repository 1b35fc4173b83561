// The mode for a lecture: scene, map and verdict, large and on the full screen where the browser allows it.

/** @param {HTMLElement} button @param {(by: number) => void} walk to another story */
export function present(button, walk) {
  const root = document.documentElement;
  const on = () => root.classList.contains('presenting');
  const set = async (/** @type {boolean} */ wanted) => {
    root.classList.toggle('presenting', wanted);
    button.setAttribute('aria-pressed', String(wanted));
    button.textContent = wanted ? 'End' : 'Present';
    scrollTo(0, 0);
    // Space is for the run.
    button.blur();
    // A browser may refuse the full screen; the mode works in its window as well.
    if (wanted) await root.requestFullscreen?.().catch(() => {});
    else if (document.fullscreenElement === root) await document.exitFullscreen().catch(() => {});
  };
  button.addEventListener('click', () => void set(!on()));
  document.addEventListener('fullscreenchange', () => {
    if (on() && !document.fullscreenElement) void set(false);
  });
  addEventListener('keydown', (event) => {
    if (!on() || event.defaultPrevented || document.querySelector('dialog[open]')) return;
    if (event.key === 'Escape') return void set(false);
    // Where arrows move something, they belong to it.
    const target = event.target instanceof Element ? event.target : null;
    if (target?.closest('input, select, textarea, [role=slider], [role=application], [role=tab]')) return;
    const by = { ArrowRight: 1, PageDown: 1, ArrowLeft: -1, PageUp: -1 }[event.key];
    if (!by) return;
    event.preventDefault();
    walk(by);
  });
}
