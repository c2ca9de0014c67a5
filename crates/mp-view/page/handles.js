// Handles drawn over the picture: arrows, rings and cubes that move, turn and scale what is selected, by mouse or finger.

import { el } from "mp/dom.js";
import { Drag, NO_CHANGE, changeWords, handleAt, handlesOf, isFar, joined, niceStep } from "mp/gizmo.js";
import { add, dot, sub } from "mp/math.js";

/** @import { Camera } from "mp/camera.js" */
/** @import { Change, Frame, Handle, HandleMode, Pixel } from "mp/gizmo.js" */
/** @import { Vec3 } from "mp/math.js" */
/** @typedef {{frame: Frame, modes: HandleMode[], planar: boolean, preview: (change: Change) => void, done: (change: Change | null) => void,
 *  words?: () => string}} Target
 *  What the handles belong to. `words` are shown beside them while they are dragged. `preview` is called while they are dragged; `done` at the end, with null when it was given up. */

/** The length of a handle, pixels. */
const LENGTH = 92;
/** Colours of x, y, z and the middle, readable on dark and light. */
const COLORS = ["#e5484d", "#2f9e44", "#3b82f6", "#8b8f98"];
const ACTIVE = "#f5a524";

export class Handles {
  /** @param {HTMLCanvasElement} canvas the picture @param {Camera} camera @param {() => void} changed asks for a redraw */
  constructor(canvas, camera, changed) {
    this.canvas = canvas; this.camera = camera; this.changed = changed;
    this.overlay = el("canvas", { class: "handles", "aria-hidden": "true" });
    canvas.after(this.overlay);
    /** @type {HandleMode} */ this.mode = "move";
    /** @type {Target | null} */ this.target = null;
    /** @type {{id: number, target: Target, drag: Drag, change: Change} | null} */ this.active = null;
    /** @type {Handle | null} */ this.hovered = null;
    const around = /** @type {HTMLElement} */ (canvas.parentElement);
    // Before the camera's own listeners, which are at the canvas.
    around.addEventListener("pointerdown", (e) => this.down(e), true);
    around.addEventListener("pointermove", (e) => this.move(e), true);
    around.addEventListener("pointerup", (e) => this.up(e), true);
    around.addEventListener("pointercancel", (e) => e.pointerId === this.active?.id && this.end(null), true);
    addEventListener("keydown", (e) => this.key(e), true);
  }
  /** What the handles are for, or null. A drag that is under way is given up. @param {Target | null} target */
  setTarget(target) {
    if (this.active) this.end(null);
    this.target = target;
    this.hovered = null;
    this.changed();
  }
  setMode(/** @type {HandleMode} */ mode) {
    this.mode = mode;
    this.changed();
  }
  /** The mode, or one that the target has. */
  get shownMode() { return this.target && !this.target.modes.includes(this.mode) ? this.target.modes[0] : this.mode; }

  get project() {
    const { both } = this.camera.matrices();
    return (/** @type {Vec3} */ point) => this.camera.project(both, point);
  }
  /** Where the target is now. @returns {Frame | null} */
  frame() {
    if (!this.active) return this.target?.frame ?? null;
    const { drag: { frame }, change } = this.active;
    return { origin: add(frame.origin, change.shift), turn: joined(change.turn, frame.turn) };
  }
  /** The length of the handles in metres, or 0 where they are behind the viewer. @param {Vec3} origin */
  size(origin) {
    if (!this.camera.perspective) return LENGTH * this.camera.pixel();
    const depth = dot(sub(this.camera.eye(), origin), this.camera.axes().back);
    return Math.max(0, (LENGTH * this.camera.pixel() * depth) / this.camera.distance);
  }
  /** @returns {Handle[]} */
  handles() {
    const frame = this.frame();
    const size = frame ? this.size(frame.origin) : 0;
    return this.target && frame && size > 0 ? handlesOf(this.shownMode, frame, size, this.target.planar) : [];
  }
  /** @param {PointerEvent} e @returns {Pixel} */
  at(e) {
    const box = this.canvas.getBoundingClientRect();
    return [e.clientX - box.left, e.clientY - box.top];
  }
  /** @param {PointerEvent} e */
  handleUnder(e) { return e.target === this.canvas ? handleAt(this.handles(), this.project, this.at(e), e.pointerType === "touch") : null; }

  down(/** @type {PointerEvent} */ e) {
    if (this.active) return e.stopPropagation();
    const handle = e.button === 0 ? this.handleUnder(e) : null;
    if (!handle || !this.target) return;
    e.stopPropagation();
    e.preventDefault();
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(e.pointerId);
    const [x, y] = this.at(e);
    const drag = new Drag(handle, this.target.frame, this.camera.ray(x, y), [x, y], this.project, this.camera.axes().back, this.target.planar);
    this.active = { id: e.pointerId, target: this.target, drag, change: NO_CHANGE };
    this.changed();
  }
  move(/** @type {PointerEvent} */ e) {
    if (!this.active) {
      if (e.buttons || e.pointerType === "touch") return;
      const handle = this.handleUnder(e);
      if (handle?.axis === this.hovered?.axis && handle?.mode === this.hovered?.mode) return;
      this.hovered = handle;
      this.canvas.classList.toggle("on-handle", handle !== null);
      return this.changed();
    }
    e.stopPropagation();
    if (e.pointerId !== this.active.id) return;
    const { target, drag } = this.active;
    const [x, y] = this.at(e);
    this.active.change = drag.to(this.camera.ray(x, y), [x, y], e.shiftKey ? niceStep(this.size(drag.frame.origin) / LENGTH) : 0);
    target.preview(this.active.change);
    this.changed();
  }
  up(/** @type {PointerEvent} */ e) {
    if (!this.active) return;
    e.stopPropagation();
    if (e.pointerId === this.active.id) this.end(this.active.change);
  }
  /** Escape gives a drag up. */
  key(/** @type {KeyboardEvent} */ e) {
    if (!this.active || e.key !== "Escape") return;
    e.stopPropagation();
    this.end(null);
  }
  /** @param {Change | null} change */
  end(change) {
    const active = this.active;
    this.active = null;
    active?.target.done(change === NO_CHANGE ? null : change);
    this.changed();
  }
  /** Draws the handles; the picture is drawn before. */
  draw() {
    const { overlay, canvas } = this;
    const context = overlay.getContext("2d");
    if (!context) return;
    if (overlay.width !== canvas.width) overlay.width = canvas.width;
    if (overlay.height !== canvas.height) overlay.height = canvas.height;
    const ratio = canvas.width / this.camera.width;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, overlay.width, overlay.height);
    const { project } = this;
    const frame = this.frame();
    if (!frame) return;
    for (const handle of this.handles()) {
      const chosen = this.active ? this.active.drag.handle : this.hovered;
      const active = chosen?.axis === handle.axis && chosen.mode === handle.mode;
      if (this.active && !active && handle.axis !== 3) continue;
      this.drawHandle(context, handle, project, frame, active);
    }
    if (this.active) this.drawWords(context, project(frame.origin), frame.origin);
  }
  /** @param {CanvasRenderingContext2D} context @param {Handle} handle @param {(p: Vec3) => Pixel | null} project @param {Frame} frame @param {boolean} active */
  drawHandle(context, handle, project, frame, active) {
    const color = active ? ACTIVE : COLORS[handle.axis];
    const width = active ? 4 : 3;
    if (handle.axis === 3) return drawSquare(context, project(frame.origin), color, handle.mode === "scale" ? 6 : 5, handle.mode === "scale");
    if (handle.mode === "turn") {
      const { back } = this.camera.axes();
      drawLine(context, handle.points.map(project), color, width, 0.3);
      drawLine(context, handle.points.map((p) => (isFar(p, frame.origin, back) ? null : project(p))), color, width, 1);
      return;
    }
    const ends = handle.points.map(project);
    drawLine(context, ends, color, width, 1);
    if (handle.mode === "scale") drawSquare(context, ends[1], color, 6, true);
    else drawTip(context, ends[0], ends[1], color);
  }
  /** @param {CanvasRenderingContext2D} context @param {Pixel | null} at @param {Vec3} place */
  drawWords(context, at, place) {
    if (!at || !this.active) return;
    const { change, drag, target } = this.active;
    const lines = [changeWords(change, drag.handle, place), target.words?.() ?? ""].filter((line) => line);
    context.font = "600 13px system-ui, sans-serif";
    const width = Math.max(...lines.map((line) => context.measureText(line).width));
    context.fillStyle = "#15181dd0";
    context.fillRect(at[0] + 14, at[1] + 14, width + 12, 4 + 18 * lines.length);
    context.fillStyle = "#ffffff";
    lines.forEach((line, i) => context.fillText(line, at[0] + 20, at[1] + 30 + 18 * i));
  }
}

/** A line with a light border, interrupted where there is no point. @param {CanvasRenderingContext2D} context @param {(Pixel | null)[]} points
 * @param {string} color @param {number} width @param {number} alpha */
function drawLine(context, points, color, width, alpha) {
  context.beginPath();
  points.forEach((p, i) => p && (i && points[i - 1] ? context.lineTo(...p) : context.moveTo(...p)));
  context.lineCap = "round";
  for (const [style, wide, part] of /** @type {[string, number, number][]} */ ([["#ffffff", width + 2, 0.5], [color, width, 1]])) {
    context.globalAlpha = alpha * part;
    context.strokeStyle = style;
    context.lineWidth = wide;
    context.stroke();
  }
  context.globalAlpha = 1;
}

/** @param {CanvasRenderingContext2D} context @param {Pixel | null} at @param {string} color @param {number} half pixels @param {boolean} filled */
function drawSquare(context, at, color, half, filled) {
  if (!at) return;
  context.fillStyle = filled ? color : "#ffffffb0";
  context.strokeStyle = filled ? "#ffffffc0" : color;
  context.lineWidth = filled ? 1 : 2;
  context.beginPath();
  context.rect(at[0] - half, at[1] - half, 2 * half, 2 * half);
  context.fill();
  context.stroke();
}

/** The tip of an arrow. @param {CanvasRenderingContext2D} context @param {Pixel | null} from @param {Pixel | null} to @param {string} color */
function drawTip(context, from, to, color) {
  if (!from || !to) return;
  const along = Math.hypot(to[0] - from[0], to[1] - from[1]);
  if (along < 4) return drawSquare(context, to, color, 4, true);
  const [x, y] = [(to[0] - from[0]) / along, (to[1] - from[1]) / along];
  context.fillStyle = color;
  context.strokeStyle = "#ffffff90";
  context.lineWidth = 1;
  context.beginPath();
  context.moveTo(to[0] + 11 * x, to[1] + 11 * y);
  context.lineTo(to[0] - 4 * x - 6 * y, to[1] - 4 * y + 6 * x);
  context.lineTo(to[0] - 4 * x + 6 * y, to[1] - 4 * y - 6 * x);
  context.closePath();
  context.fill();
  context.stroke();
}
