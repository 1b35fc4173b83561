// Ends of a run in contact, after its bounces.

/** The end, and the reason. @type {Partial<Record<import('contract').HoldEnd['kind'], [string, string]>>} */
const FALLS = {
  toppled: ['fell over', 'it tipped over'],
  other_vertex: ['fell over', 'another corner touched the table'],
  contact_lost: ['left the table', 'only a pull could keep its foot there'],
  slipped: ['slipped', 'its foot slipped on the table'],
  beyond_limits: ['was lost', 'the contact asks more of the table than its limits allow'],
  off_table: ['left the table', 'the table ended before it'],
  too_long: ['could not be followed', 'its motion in contact is too long to compute'],
};

/**
 * The deed of a body that fell in contact, as in “stopped bouncing and fell over”, and the reason; null if it did not.
 * @param {import('contract').Outcome & {contact?: import('contract').HoldEnd}} outcome of the connection, with its end in contact
 */
export function fallInContact({ contact }) {
  const [deed, reason] = (contact && FALLS[contact.kind]) ?? [];
  return deed ? { deed, reason } : null;
}
