// The clearance along the path as a small plot. Press or drag in it to go to a configuration.

import { brief } from "mp/dom.js";

/** @import { Path } from "mp/scene.js" */

export class ClearancePlot {
  /** @param {HTMLCanvasElement} canvas @param {(time: number) => void} scrub */
  constructor(canvas, scrub) {
    this.canvas = canvas;
    /** @type {Path | null} */ this.path = null;
    const go = (/** @type {PointerEvent} */ e) => {
      const box = canvas.getBoundingClientRect();
      const part = Math.max(0, Math.min(1, (e.clientX - box.left) / box.width));
      if (this.path) scrub(part * (this.path.count - 1));
    };
    canvas.addEventListener("pointerdown", (e) => (canvas.setPointerCapture(e.pointerId), go(e)));
    canvas.addEventListener("pointermove", (e) => canvas.hasPointerCapture(e.pointerId) && go(e));
  }
  show(/** @type {Path | null} */ path) {
    this.path = path?.clearance ? path : null;
    // Without a path its place is kept, so that the picture does not move.
    this.canvas.hidden = path !== null && !this.path;
    this.canvas.style.visibility = this.path ? "" : "hidden";
    this.canvas.setAttribute("aria-label", this.path ? `Clearance along the path: ${this.range()}` : "");
  }
  /** The finite clearances' least and greatest. @returns {[number, number]} */
  extremes() {
    const all = [...(this.path?.clearance ?? [])].filter(Number.isFinite);
    return all.reduce(([low, high], x) => [Math.min(low, x), Math.max(high, x)], /** @type {[number, number]} */ ([Infinity, 0]));
  }
  range() {
    const [low, high] = this.extremes();
    return `${brief(low)} to ${brief(high)} m`;
  }
  draw(/** @type {number} */ time) {
    const context = this.canvas.getContext("2d");
    const clearance = this.path?.clearance;
    if (!context || !clearance || this.canvas.clientWidth === 0) return;
    const ratio = devicePixelRatio || 1;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    context.scale(ratio, ratio);
    const style = getComputedStyle(this.canvas);
    const [low, high] = this.extremes();
    const last = Math.max(1, clearance.length - 1);
    const x = (/** @type {number} */ i) => 1 + (i / last) * (width - 2);
    const y = (/** @type {number} */ c) => height - 2 - (Math.min(c, high) / (high || 1)) * (height - 16);
    this.curve(context, clearance, x, y, style.getPropertyValue("--path"));
    context.strokeStyle = style.color;
    context.beginPath();
    context.moveTo(x(time), 0);
    context.lineTo(x(time), height);
    context.stroke();
    context.fillStyle = style.color;
    context.font = "11px system-ui, sans-serif";
    const now = clearance[Math.min(Math.round(time), clearance.length - 1)];
    context.fillText(`clearance ${brief(now)} m (least ${brief(low)} m)`, 4, 11);
  }
  /** @param {CanvasRenderingContext2D} context @param {Float32Array} values @param {(i: number) => number} x
   * @param {(c: number) => number} y @param {string} color */
  curve(context, values, x, y, color) {
    context.beginPath();
    values.forEach((c, i) => context.lineTo(x(i), y(c)));
    context.strokeStyle = color;
    context.lineWidth = 1.5;
    context.stroke();
    context.lineTo(x(values.length - 1), y(0));
    context.lineTo(x(0), y(0));
    context.globalAlpha = 0.2;
    context.fillStyle = color;
    context.fill();
    context.globalAlpha = 1;
    context.lineWidth = 1;
  }
}
