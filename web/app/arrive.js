// Keeps what the address names in view while the page above it grows, until the reader acts.

function showNamed() {
  if (location.hash) document.getElementById(location.hash.slice(1))?.scrollIntoView();
}

/** @param {Element} root that grows @param {() => void} [show] brings the place into view */
export function arrive(root, show = showNamed) {
  const watch = new ResizeObserver(show);
  watch.observe(root);
  for (const act of ['wheel', 'pointerdown', 'keydown', 'touchstart'])
    addEventListener(act, () => watch.disconnect(), { once: true, passive: true });
}
