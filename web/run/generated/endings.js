// Written by `node tests/browser/shared-tables.js` from server/api/shared/outcome.rs; not to be edited.

/** Verb and reason, by ending. @type {Record<string, {verb: string, reason: string}>} */
export const ENDINGS = {
  toppled: { verb: 'Falls', reason: 'it had tipped over' },
  separating: { verb: 'Falls', reason: 'its foot was leaving the table already' },
  sinking: { verb: 'Falls', reason: 'the table struck too steeply' },
  settled: { verb: 'Comes to rest', reason: 'its bounces died out' },
  diverged: { verb: 'Cannot be followed', reason: 'it became too fast to compute' },
  other_vertex: { verb: 'Falls', reason: 'another corner touched the table' },
  missed: { verb: 'Falls', reason: 'it never met the table again' },
  beyond_limits: { verb: 'Falls', reason: 'the strike asks more of the table than its limits allow' },
  off_table: { verb: 'Falls', reason: 'the table ended before it' },
  held: { verb: 'Caught', reason: 'the table holds it' },
  rests_on_edge: { verb: 'Caught', reason: 'it lies still on an edge' },
  fell: { verb: 'Falls', reason: 'it tipped over while the table caught it' },
  slipped: { verb: 'Not caught', reason: 'its foot slipped on the table' },
  not_caught: { verb: 'Not caught', reason: 'the table could not follow it' },
};
