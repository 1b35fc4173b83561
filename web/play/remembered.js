// Switches that the browser remembers for later visits, if it may store anything.

/** @param {string} name @param {boolean} usual before anything was stored, or where nothing may be */
export function remembered(name, usual) {
  try {
    const stored = localStorage.getItem(name);
    return stored === null ? usual : stored === 'on';
  } catch {
    return usual;
  }
}

/** @param {string} name @param {boolean} on */
export function remember(name, on) {
  try {
    localStorage.setItem(name, on ? 'on' : 'off');
  } catch {
    /* lasts for this visit only */
  }
}
