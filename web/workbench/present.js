// The mode for a lecture: scene, one plane and the headline, large and on the full screen where the browser allows it.

/** @param {HTMLElement} button */
export function present(button) {
  const root = document.documentElement;
  const on = () => root.classList.contains('presenting');
  const set = async (/** @type {boolean} */ wanted) => {
    root.classList.toggle('presenting', wanted);
    button.setAttribute('aria-pressed', String(wanted));
    button.textContent = wanted ? 'End' : 'Present';
    scrollTo(0, 0);
    // A browser may refuse the full screen; the mode works in its window as well.
    if (wanted) await root.requestFullscreen?.().catch(() => {});
    else if (document.fullscreenElement === root) await document.exitFullscreen().catch(() => {});
  };
  button.addEventListener('click', () => void set(!on()));
  document.addEventListener('fullscreenchange', () => {
    if (on() && !document.fullscreenElement) void set(false);
  });
  document.addEventListener('show-desk', () => {
    if (on()) void set(false);
  });
  addEventListener('keydown', (event) => {
    if (event.key === 'Escape' && on() && !event.defaultPrevented && !document.querySelector('dialog[open]'))
      void set(false);
  });
}
