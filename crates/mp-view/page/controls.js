// Mouse, pen, fingers and keys move the camera. A press that does not move is a click.

/** @import { Camera } from "mp/camera.js" */
/** @typedef {{moved: () => void, clicked: (x: number, y: number) => void, centered: (x: number, y: number) => void}} Listener */

const FLY_KEYS = new Set(["KeyW", "KeyA", "KeyS", "KeyD", "KeyQ", "KeyE"]);
/** Whether keys belong to the control that has the focus. @param {EventTarget | null} target */
export const isTyping = (target) => target instanceof HTMLElement && target.matches("input:not([type=checkbox]), select, textarea, [contenteditable]");

export class Controls {
  /** @param {HTMLCanvasElement} canvas @param {Camera} camera @param {Listener} listener */
  constructor(canvas, camera, listener) {
    this.canvas = canvas; this.camera = camera; this.listener = listener;
    this.planar = false;
    /** @type {Map<number, {x: number, y: number}>} */ this.pointers = new Map();
    this.moved = 0;
    /** @type {Set<string>} */ this.held = new Set();
    this.lastTime = 0;
    this.listen();
  }
  listen() {
    const c = this.canvas;
    c.addEventListener("pointerdown", (e) => this.down(e));
    c.addEventListener("pointermove", (e) => this.move(e));
    c.addEventListener("pointerup", (e) => this.up(e));
    c.addEventListener("pointercancel", (e) => this.pointers.delete(e.pointerId));
    c.addEventListener("contextmenu", (e) => e.preventDefault());
    c.addEventListener("dblclick", (e) => this.listener.centered(...this.at(e)));
    c.addEventListener("wheel", (e) => this.wheel(e), { passive: false });
    addEventListener("keydown", (e) => this.key(e));
    addEventListener("keyup", (e) => this.held.delete(e.code));
    addEventListener("blur", () => this.held.clear());
  }
  /** @param {MouseEvent} e @returns {[number, number]} */
  at(e) {
    const box = this.canvas.getBoundingClientRect();
    return [e.clientX - box.left, e.clientY - box.top];
  }
  down(/** @type {PointerEvent} */ e) {
    this.canvas.setPointerCapture(e.pointerId);
    const [x, y] = this.at(e);
    if (this.pointers.size === 0) this.moved = 0;
    this.pointers.set(e.pointerId, { x, y });
  }
  move(/** @type {PointerEvent} */ e) {
    const last = this.pointers.get(e.pointerId);
    if (!last) return;
    const [x, y] = this.at(e);
    const [dx, dy] = [x - last.x, y - last.y];
    this.moved += Math.abs(dx) + Math.abs(dy);
    if (this.pointers.size === 2) this.pinch(e.pointerId, x, y);
    else if (this.moved > 4 || e.pointerType === "mouse") this.drag(e, dx, dy);
    this.pointers.set(e.pointerId, { x, y });
    this.listener.moved();
  }
  /** One pointer turns the view; with Shift or another button it moves it. In a plane it is the other way round.
   * @param {PointerEvent} e @param {number} dx @param {number} dy */
  drag(e, dx, dy) {
    const other = e.shiftKey || (e.buttons & 6) !== 0;
    if (other !== this.planar) this.camera.pan(dx, dy);
    else this.camera.orbit(dx, dy);
  }
  /** Two fingers zoom and move. @param {number} id @param {number} x @param {number} y */
  pinch(id, x, y) {
    const last = this.pointers.get(id);
    const still = [...this.pointers.entries()].find(([other]) => other !== id)?.[1];
    if (!last || !still) return;
    const before = Math.hypot(last.x - still.x, last.y - still.y);
    const now = Math.hypot(x - still.x, y - still.y);
    this.camera.pan((x - last.x) / 2, (y - last.y) / 2);
    if (now > 10) this.camera.zoom(before / now, (x + still.x) / 2, (y + still.y) / 2);
  }
  up(/** @type {PointerEvent} */ e) {
    const was = this.pointers.delete(e.pointerId);
    if (was && this.moved <= 4 && e.button === 0 && this.pointers.size === 0) this.listener.clicked(...this.at(e));
  }
  wheel(/** @type {WheelEvent} */ e) {
    e.preventDefault();
    const pixels = e.deltaY * (e.deltaMode === 1 ? 33 : e.deltaMode === 2 ? 400 : 1);
    this.camera.zoom(Math.exp(Math.max(-500, Math.min(500, pixels)) * 0.0015), ...this.at(e));
    this.listener.moved();
  }
  key(/** @type {KeyboardEvent} */ e) {
    if (isTyping(e.target) || e.ctrlKey || e.metaKey || e.altKey) return;
    if (FLY_KEYS.has(e.code)) this.held.add(e.code);
    else if (e.shiftKey && e.key.startsWith("Arrow")) this.turn(e);
    else if (e.key === "+" || e.key === "=") this.camera.zoom(0.85);
    else if (e.key === "-") this.camera.zoom(1 / 0.85);
    else return;
    this.listener.moved();
  }
  turn(/** @type {KeyboardEvent} */ e) {
    e.preventDefault();
    const step = 15;
    this.camera.orbit(e.key === "ArrowLeft" ? -step : e.key === "ArrowRight" ? step : 0, e.key === "ArrowUp" ? step : e.key === "ArrowDown" ? -step : 0);
  }
  /** Moves while keys are held; returns whether it moved. @param {number} now milliseconds */
  fly(now) {
    const seconds = Math.min(0.1, (now - this.lastTime) / 1000);
    this.lastTime = now;
    if (this.held.size === 0) return false;
    /** @param {string} plus @param {string} minus */
    const axis = (plus, minus) => (this.held.has(plus) ? 1 : 0) - (this.held.has(minus) ? 1 : 0);
    const step = this.camera.distance * 0.8 * seconds;
    this.camera.fly(axis("KeyD", "KeyA") * step, axis("KeyE", "KeyQ") * step, axis("KeyW", "KeyS") * step);
    return true;
  }
}
