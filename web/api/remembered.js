// Choices that the browser remembers for later visits, if it may store anything; else they last for this visit.

/**
 * @template {string | boolean} T
 * @param {string} name
 * @param {T} usual before anything was stored, or where nothing may be
 * @returns {T extends boolean ? boolean : string} switches are stored as `on` and `off`
 */
export function remembered(name, usual) {
  /** @type {any} */
  let choice = usual;
  try {
    const stored = localStorage.getItem(name);
    if (stored !== null) choice = typeof usual === 'boolean' ? stored === 'on' : stored;
  } catch {
    /* the usual one */
  }
  return choice;
}

/** @param {string} name @param {string | boolean} choice */
export function remember(name, choice) {
  try {
    localStorage.setItem(name, typeof choice === 'boolean' ? (choice ? 'on' : 'off') : choice);
  } catch {
    /* lasts for this visit only */
  }
}
