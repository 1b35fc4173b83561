// Text fields for numbers. Typing changes nothing: Enter or leaving the field commits, Escape and a refused entry put back what was there.

/**
 * @param {HTMLInputElement | HTMLTextAreaElement} input whose listeners of `change` then hear of accepted entries only
 * @param {(text: string) => {problem?: string, text?: string}} judge may give the text to show for an accepted entry
 * @param {(problem: string | null, refused: string) => void} say tells why an entry was refused, once the text before it stands again; null for one that was not
 * @returns {() => void} commits what is being typed
 */
export function commits(input, judge, say) {
  /** The text before typing. @type {string | null} */
  let before = null;
  let isRefused = false;
  const putBack = () => {
    if (before !== null) input.value = before;
    before = null;
  };
  /** @returns {boolean} false if the entry is refused, and the text before it stands again */
  const commit = () => {
    const typed = input.value;
    const { problem, text } = judge(typed);
    if (problem !== undefined) {
      putBack();
      isRefused = true;
      say(problem, typed);
      return false;
    }
    before = null;
    if (text !== undefined) input.value = text;
    say(null, typed);
    return true;
  };
  input.addEventListener('beforeinput', () => {
    before ??= input.value;
    // Taken away later, the words would move a button while it is pressed.
    if (isRefused) say(null, '');
    isRefused = false;
  });
  input.addEventListener(
    'change',
    (event) => {
      if (!commit()) event.stopImmediatePropagation();
    },
    { capture: true },
  );
  // A browser tells no change of a text that was put there by a script.
  const finish = () => {
    if (before !== null && input.value !== before) input.dispatchEvent(new Event('change'));
    before = null;
  };
  input.addEventListener('blur', finish);
  input.addEventListener('keydown', (event) => {
    const { key } = /** @type {KeyboardEvent} */ (event);
    if (before === null) return;
    if (key === 'Escape') {
      putBack();
      say(null, '');
      event.stopPropagation();
    } else if (key === 'Enter' && input instanceof HTMLInputElement && judge(input.value).problem !== undefined) {
      // No form is sent with another value than the typed one.
      event.preventDefault();
      commit();
      input.select();
    }
  });
  return finish;
}

/** The element that a pointer is down on. @type {Element | null} */
let pressed = null;
/** @param {Event} event */
const follow = ({ type, target }) => {
  pressed = type === 'pointerdown' && target instanceof Element ? target : null;
};
for (const type of ['pointerdown', 'pointerup', 'pointercancel']) addEventListener(type, follow, true);

/** The press of a button by which a refused entry was left does nothing: it was meant for that entry, which has the focus again, also where the button has moved since. @param {HTMLElement} input */
export function withholdPress(input) {
  if (!pressed?.closest('button')) return;
  const withhold = (/** @type {Event} */ event) => {
    event.preventDefault();
    event.stopPropagation();
    input.focus();
  };
  addEventListener('click', withhold, { capture: true, once: true });
  const after = () =>
    setTimeout(() => {
      removeEventListener('click', withhold, true);
      input.focus();
    });
  addEventListener('pointerup', after, { once: true });
}
