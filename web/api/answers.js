// Reads answers: their lines as they come, and the margins of gains in them.

import { asked } from './client.js';

/** @import { Margin } from 'contract' */

/** The margins of a field for small deviations. @param {{margins: Margin[]}} answer @param {Margin['field']} field */
export const marginOf = ({ margins }, field) => margins.find((one) => one.field === field && one.of === 'small');

/** The critical gain, where there is one. @param {{margins: Margin[]} | undefined} answer */
export const criticalGain = (answer) => (answer && marginOf(answer, 'table.tilt_gain')?.above?.limit) ?? null;

/** The objects of an NDJSON answer, each as soon as its line is there. @param {string} path @param {RequestInit} request @returns {AsyncGenerator<any>} */
export async function* lines(path, request) {
  const response = await asked(path, request);
  const reader = /** @type {ReadableStream<Uint8Array>} */ (response.body).getReader();
  const decoder = new TextDecoder();
  let rest = '';
  try {
    for (;;) {
      const { done, value } = await reader.read();
      const parts = (rest + decoder.decode(value, { stream: !done })).split('\n');
      rest = parts.pop() ?? '';
      for (const part of parts) if (part !== '') yield JSON.parse(part);
      if (done) return;
    }
  } finally {
    // Whoever stops early wants no more of it.
    void reader.cancel().catch(() => {});
  }
}
