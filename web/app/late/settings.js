// Brings the form of the typed scene, and the switch of the unit of angles.

import { byId } from '../../dom/elements.js';
import { UNITS, angles, chooseAngles, followAddress } from '../../dom/units.js';
import { Form } from '../../form/form.js';
import { updateAddress } from '../address-bar.js';
import { edited } from '../typed/edits.js';

/** @param {import('../page.js').Page} page */
export function bringSettings(page) {
  page.join(
    new Form(byId('parameters'), page.fields, (path, final) => {
      page.take();
      edited(page, path, final);
    }),
  );
  offerUnits(page);
}

/** @param {import('../page.js').Page} page */
function offerUnits(page) {
  const button = byId('units', HTMLButtonElement);
  const show = () => {
    const degrees = angles() === 'deg';
    button.textContent = degrees ? '°' : 'rad';
    button.setAttribute(
      'aria-label',
      `Angles in ${degrees ? 'degrees' : 'radians'}; switch to ${degrees ? 'radians' : 'degrees'}`,
    );
    button.title = `Angles in ${degrees ? 'degrees' : 'radians'}`;
  };
  button.addEventListener('click', () => chooseAngles(angles() === 'deg' ? 'rad' : 'deg'));
  addEventListener('popstate', () => followAddress(location.search));
  document.addEventListener(UNITS, () => {
    show();
    page.verdict?.retell();
    page.view.redraw();
    updateAddress(page);
  });
  show();
}
