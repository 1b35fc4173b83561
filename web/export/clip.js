// A clip of the scene: its canvas is recorded for some seconds, over the verdict in words, and saved as a video. Loaded when a clip is asked for.

import { SANS, colourOf } from '../charts/theme.js';
import { h } from '../dom/elements.js';
import { clearNotice, notice } from '../dom/notices.js';
import { download } from './capture.js';

/** Length of a clip, s, and its frames each second. */
const SECONDS = 3;
const FRAMES = 30;

/** Bits each second: enough for thin lines to stay sharp. */
const BITS = 6_000_000;

/** Media types with their file names, the most widely played first. @type {[type: string, extension: string][]} */
const KINDS = [
  ['video/mp4;codecs=avc1.42E01F', 'mp4'],
  ['video/webm;codecs=vp9', 'webm'],
  ['video/webm', 'webm'],
];

/** Height of the line of words, and its font, px of the page. */
const LINE = { height: 40, font: 17 };

let busy = false;

/**
 * Records the view from now on and saves the clip.
 * @param {CanvasView} view
 * @param {HTMLElement} head where the progress is shown
 * @param {() => string} words the verdict
 */
export async function saveClip({ layers }, head, words) {
  if (busy) return;
  busy = true;
  try {
    const clip = await record(layers, head, words);
    clearNotice('clip');
    if (clip) download(clip.blob, `equipoise-scene.${clip.extension}`);
    else notice('clip', ['The browser recorded no picture.'], { caution: true });
  } catch {
    notice('clip', ['This browser cannot record the scene.'], { caution: true });
  } finally {
    busy = false;
  }
}

/** @param {Surface[]} layers @param {HTMLElement} head @param {() => string} words */
async function record(layers, head, words) {
  const [type, extension] = KINDS.find(([type]) => MediaRecorder.isTypeSupported(type)) ?? ['', 'webm'];
  const { canvas } = layers[0];
  // Some encoders take even sizes only.
  const ratio = canvas.width / canvas.clientWidth;
  const line = Math.round(LINE.height * ratio);
  const [width, height] = [canvas.width, canvas.height + line].map((length) => length - (length % 2));
  const sheet = h('canvas', { width, height });
  const context = /** @type {CanvasRenderingContext2D} */ (sheet.getContext('2d', { alpha: false }));
  const recorder = new MediaRecorder(sheet.captureStream(FRAMES), {
    ...(type && { mimeType: type }),
    videoBitsPerSecond: BITS,
  });
  /** @type {Blob[]} */
  const parts = [];
  recorder.addEventListener('dataavailable', ({ data }) => parts.push(data));
  const stopped = new Promise((resolve, reject) => {
    recorder.addEventListener('stop', resolve);
    recorder.addEventListener('error', reject);
  });
  const stop = () => {
    if (recorder.state !== 'inactive') recorder.stop();
  };
  // A hidden page draws nothing.
  document.addEventListener('visibilitychange', stop, { once: true });

  const bar = h('progress', { max: SECONDS, value: 0, 'aria-label': 'Recorded' });
  const told = h('p', { class: 'clip' }, 'Clip ', bar, h('button', { type: 'button', click: stop }, 'Stop and save'));
  head.prepend(told);
  const begin = performance.now();
  const copyFrame = () => {
    if (recorder.state === 'inactive') return;
    context.fillStyle = colourOf('surface');
    context.fillRect(0, 0, width, height);
    for (const layer of layers) context.drawImage(layer.canvas, 0, 0);
    context.fillStyle = colourOf('ink');
    context.font = `600 ${LINE.font * ratio}px ${SANS}`;
    context.textBaseline = 'middle';
    context.fillText(words(), 14 * ratio, height - line / 2, width - 28 * ratio);
    bar.value = (performance.now() - begin) / 1000;
    if (bar.value < SECONDS) requestAnimationFrame(copyFrame);
    else stop();
  };
  try {
    recorder.start();
    copyFrame();
    await stopped;
  } finally {
    told.remove();
    for (const track of recorder.stream.getTracks()) track.stop();
  }
  const blob = new Blob(parts, { type: recorder.mimeType || type });
  return blob.size > 0 ? { blob, extension } : null;
}
