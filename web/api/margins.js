// Margins of the gains in answers: a list of fields, each with its limits below and above.

/** @typedef {import('contract').Margin} Margin */

/** The margins of a field for small deviations. @param {{margins: Margin[]}} answer @param {Margin['field']} field */
export const marginOf = ({ margins }, field) => margins.find((one) => one.field === field && one.of === 'small');

/** The critical gain, where there is one. @param {{margins: Margin[]} | undefined} answer */
export const criticalGain = (answer) => (answer && marginOf(answer, 'table.tilt_gain')?.above?.limit) ?? null;
