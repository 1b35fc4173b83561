// A canvas context that writes SVG: what is drawn on it once stands in a file with all its digits. It knows what this page draws
// with, and turns and shifts, but no scales.

/** @param {number} value */
const short = (value) => String(Math.round(value * 100) / 100);

/** @param {string} text */
const escaped = (text) => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('"', '&quot;');

const ANCHORS = { left: 'start', start: 'start', center: 'middle', right: 'end', end: 'end' };
/** Shift of text against its baseline, em. Not every reader of SVG knows `dominant-baseline`. */
const SHIFTS = { top: 0.8, hanging: 0.8, middle: 0.33, alphabetic: 0, ideographic: 0, bottom: -0.22 };

/**
 * @typedef {object} Style
 * @property {any} fillStyle
 * @property {any} strokeStyle
 * @property {number} lineWidth
 * @property {CanvasLineCap} lineCap
 * @property {number} globalAlpha
 * @property {string} font
 * @property {CanvasTextAlign} textAlign
 * @property {CanvasTextBaseline} textBaseline
 * @property {number[]} dashes
 * @property {number} turn clockwise, rad
 * @property {number} x of the origin
 * @property {number} y
 * @property {number} clip the number of its clip path; 0 is none
 */

export class Recorder {
  /** @type {any} */
  fillStyle = '#000';
  /** @type {any} */
  strokeStyle = '#000';
  lineWidth = 1;
  /** @type {CanvasLineCap} */
  lineCap = 'butt';
  globalAlpha = 1;
  font = '10px sans-serif';
  /** @type {CanvasTextAlign} */
  textAlign = 'start';
  /** @type {CanvasTextBaseline} */
  textBaseline = 'alphabetic';
  imageSmoothingEnabled = true;
  #measure;
  /** @type {number[]} */
  #dashes = [];
  #turn = 0;
  #x = 0;
  #y = 0;
  #clip = 0;
  /** @type {string[]} */
  #clips = [];
  /** @type {Style[]} */
  #kept = [];
  #path = '';
  /** Marks of one look one after another are one element. @type {{attributes: string, body: string, clip: number}[]} */
  #drawn = [];

  /** @param {CanvasRenderingContext2D} measure that knows how wide text is */
  constructor(measure) {
    this.#measure = measure;
  }

  /** The elements, with names of their own. @param {string} name */
  content(name) {
    const clips = this.#clips
      .map((path, index) => `<clipPath id="${name}-${index + 1}"><path d="${path}"/></clipPath>\n`)
      .join('');
    return (
      clips +
      this.#drawn
        .map(({ attributes, body, clip }) => {
          const element = attributes.startsWith('<') ? attributes : `<path d="${body}"${attributes}/>`;
          return clip ? `<g clip-path="url(#${name}-${clip})">${element}</g>` : element;
        })
        .join('\n')
    );
  }

  save() {
    const { fillStyle, strokeStyle, lineWidth, lineCap, globalAlpha, font, textAlign, textBaseline } = this;
    this.#kept.push({
      fillStyle,
      strokeStyle,
      lineWidth,
      lineCap,
      globalAlpha,
      font,
      textAlign,
      textBaseline,
      dashes: this.#dashes,
      turn: this.#turn,
      x: this.#x,
      y: this.#y,
      clip: this.#clip,
    });
  }

  restore() {
    const style = this.#kept.pop();
    if (!style) return;
    const { dashes, turn, x, y, clip, ...own } = style;
    Object.assign(this, own);
    [this.#dashes, this.#turn, this.#x, this.#y, this.#clip] = [dashes, turn, x, y, clip];
  }

  /** @param {number} x @param {number} y */
  translate(x, y) {
    [this.#x, this.#y] = this.#place(x, y);
  }

  /** @param {number} angle */
  rotate(angle) {
    this.#turn += angle;
  }

  /** @param {number} x @param {number} y @returns {[number, number]} */
  #place(x, y) {
    const [cos, sin] = [Math.cos(this.#turn), Math.sin(this.#turn)];
    return [this.#x + x * cos - y * sin, this.#y + x * sin + y * cos];
  }

  /** @param {number} x @param {number} y */
  #at(x, y) {
    return this.#place(x, y).map(short).join(' ');
  }

  /** @param {number[]} dashes */
  setLineDash(dashes) {
    this.#dashes = dashes;
  }

  beginPath() {
    this.#path = '';
  }

  /** @param {number} x @param {number} y */
  moveTo(x, y) {
    this.#path += `M${this.#at(x, y)}`;
  }

  /** @param {number} x @param {number} y */
  lineTo(x, y) {
    this.#path += `${this.#path ? 'L' : 'M'}${this.#at(x, y)}`;
  }

  closePath() {
    if (this.#path) this.#path += 'Z';
  }

  /** @param {number} x @param {number} y @param {number} width @param {number} height */
  rect(x, y, width, height) {
    this.#path += `M${this.#at(x, y)}L${this.#at(x + width, y)}L${this.#at(x + width, y + height)}L${this.#at(x, y + height)}Z`;
  }

  /** With round corners, whose radius does not show at this size. @param {number} x @param {number} y @param {number} width @param {number} height */
  roundRect(x, y, width, height) {
    this.rect(x, y, width, height);
  }

  /** @param {number} x @param {number} y @param {number} radius @param {number} from @param {number} to @param {boolean} [back] */
  arc(x, y, radius, from, to, back = false) {
    const r = short(radius);
    const on = (/** @type {number} */ angle) => this.#at(x + radius * Math.cos(angle), y + radius * Math.sin(angle));
    const start = `${this.#path && !this.#path.endsWith('Z') ? 'L' : 'M'}${on(from)}`;
    if (Math.abs(to - from) >= 2 * Math.PI) {
      // A whole circle is two halves: an arc from a point to itself is none.
      this.#path += `${start}A${r} ${r} 0 1 1 ${on(from + Math.PI)}A${r} ${r} 0 1 1 ${on(from)}`;
      return;
    }
    const turn = (((back ? from - to : to - from) % (2 * Math.PI)) + 2 * Math.PI) % (2 * Math.PI);
    this.#path += `${start}A${r} ${r} 0 ${turn > Math.PI ? 1 : 0} ${back ? 0 : 1} ${on(to)}`;
  }

  clip() {
    this.#clip = this.#clips.push(this.#path);
  }

  /** @param {string} attributes @param {string} body */
  #add(attributes, body) {
    const last = this.#drawn.at(-1);
    // Transparent marks add up where they overlap, so they stay apart.
    if (last && last.attributes === attributes && last.clip === this.#clip && this.globalAlpha === 1) last.body += body;
    else this.#drawn.push({ attributes, body, clip: this.#clip });
  }

  get #opacity() {
    return this.globalAlpha === 1 ? '' : ` opacity="${short(this.globalAlpha)}"`;
  }

  fill() {
    if (this.#path) this.#add(` fill="${this.fillStyle}"${this.#opacity}`, this.#path);
  }

  stroke() {
    const dashes = this.#dashes.length > 0 ? ` stroke-dasharray="${this.#dashes.join(' ')}"` : '';
    const cap = this.lineCap === 'butt' ? '' : ` stroke-linecap="${this.lineCap}"`;
    if (this.#path)
      this.#add(
        ` fill="none" stroke="${this.strokeStyle}" stroke-width="${short(this.lineWidth)}"${dashes}${cap}${this.#opacity}`,
        this.#path,
      );
  }

  /** @param {() => void} draw what is no part of the path under way */
  #apart(draw) {
    const path = this.#path;
    this.#path = '';
    draw();
    this.#path = path;
  }

  /** @param {number} x @param {number} y @param {number} width @param {number} height */
  fillRect(x, y, width, height) {
    this.#apart(() => {
      this.rect(x, y, width, height);
      this.fill();
    });
  }

  /** @param {number} x @param {number} y @param {number} width @param {number} height */
  strokeRect(x, y, width, height) {
    this.#apart(() => {
      this.rect(x, y, width, height);
      this.stroke();
    });
  }

  /** A layer is cleared as a whole. */
  clearRect() {
    this.#drawn = [];
    this.#clips = [];
  }

  /** @param {string} text */
  measureText(text) {
    this.#measure.font = this.font;
    return this.#measure.measureText(text);
  }

  /** @param {string} text @param {number} x @param {number} y @param {number} [widest] */
  fillText(text, x, y, widest) {
    const [, slant, points, family] = /^(italic )?([\d.]+)px (.+)$/.exec(this.font) ?? ['', '', '10', 'sans-serif'];
    const size = Number(points);
    const font = ` font-family="${escaped(family)}" font-size="${size}"${slant ? ' font-style="italic"' : ''}`;
    const shift = (SHIFTS[this.textBaseline] ?? 0) * size;
    const squeezed =
      widest !== undefined && this.measureText(text).width > widest
        ? ` textLength="${short(widest)}" lengthAdjust="spacingAndGlyphs"`
        : '';
    const turned =
      this.#turn === 0 ? '' : ` transform="rotate(${short((this.#turn * 180) / Math.PI)} ${this.#at(x, y)})"`;
    const [px, py] = this.#place(x, y);
    this.#drawn.push({
      clip: this.#clip,
      body: '',
      attributes: `<text x="${short(px)}" y="${short(py + shift)}" fill="${this.fillStyle}" text-anchor="${ANCHORS[this.textAlign]}"${font}${squeezed}${turned}${this.#opacity}>${escaped(text)}</text>`,
    });
  }

  /** @param {HTMLCanvasElement} image @param {number} x @param {number} y @param {number} [width] @param {number} [height] */
  drawImage(image, x, y, width = image.width, height = image.height) {
    const [px, py] = this.#place(x, y);
    this.#drawn.push({
      clip: this.#clip,
      body: '',
      attributes: `<image x="${short(px)}" y="${short(py)}" width="${short(width)}" height="${short(height)}" href="${image.toDataURL()}"${this.imageSmoothingEnabled ? '' : ' image-rendering="pixelated"'}/>`,
    });
  }
}
