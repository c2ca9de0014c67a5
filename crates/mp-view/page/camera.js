// The camera: it looks at a target from a distance, with z upwards.

import { add, clamp, cross, dot, multiply, normalize, orthographic, perspective, scale, sub, transform, viewMatrix } from "mp/math.js";

/** @import { Mat4, Vec3 } from "mp/math.js" */
/** @typedef {"front" | "back" | "left" | "right" | "top" | "bottom" | "iso"} ViewName */
/** @typedef {{origin: Vec3, direction: Vec3}} Ray */

const FOV = (40 * Math.PI) / 180;

/** Yaw and pitch of the direction from the target to the eye. @type {Record<ViewName, [number, number]>} */
const VIEWS = {
  front: [-Math.PI / 2, 0],
  back: [Math.PI / 2, 0],
  left: [Math.PI, 0],
  right: [0, 0],
  top: [-Math.PI / 2, Math.PI / 2],
  bottom: [-Math.PI / 2, -Math.PI / 2],
  iso: [-Math.PI / 3, Math.PI / 4],
};

export class Camera {
  /** @param {[number[], number[]]} bounds of the scene */
  constructor(bounds) {
    /** @type {Vec3} */ this.center = [0, 0, 0];
    /** @type {Vec3[]} */ this.corners = [];
    this.radius = 1;
    this.setBounds(bounds);
    this.width = 1;
    this.height = 1;
    this.perspective = true;
    this.yaw = 0;
    this.pitch = 0;
    this.distance = 1;
    /** @type {Vec3} */ this.target = this.center;
    this.look("iso");
  }
  /** Takes another scene; the view stays. @param {[number[], number[]]} bounds */
  setBounds(bounds) {
    const low = /** @type {Vec3} */ (bounds[0]);
    const high = /** @type {Vec3} */ (bounds[1]);
    this.center = scale(add(low, high), 0.5);
    this.corners = [low, high];
    this.radius = Math.max(Math.hypot(...sub(high, low)) / 2, 1e-6);
  }
  /** Turns to a standard view; the target stays. @param {ViewName} name */
  look(name) { [this.yaw, this.pitch] = VIEWS[name]; }
  /** The axes of the picture in the world: to the right, upwards, and towards the viewer. @returns {{right: Vec3, up: Vec3, back: Vec3}} */
  axes() {
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    /** @type {Vec3} */ const back = [cp * cy, cp * sy, sp];
    /** @type {Vec3} */ const right = [-sy, cy, 0];
    return { right, up: cross(back, right), back };
  }
  /** @returns {Vec3} */
  eye() { return add(this.target, scale(this.axes().back, this.distance)); }
  /** Shows the whole scene from the present direction. */
  fit() {
    this.target = this.center;
    const { right, up, back } = this.axes();
    const tan = Math.tan(FOV / 2);
    const aspect = this.width / this.height;
    this.distance = this.radius * 0.01;
    for (let i = 0; i < 8; i++) {
      const p = sub([this.corners[i & 1][0], this.corners[(i >> 1) & 1][1], this.corners[i >> 2][2]], this.center);
      const half = Math.max(Math.abs(dot(p, up)), Math.abs(dot(p, right)) / aspect);
      this.distance = Math.max(this.distance, (half * 1.08) / tan + (this.perspective ? dot(p, back) : 0));
    }
  }
  /** @param {number} dx pixels @param {number} dy pixels */
  orbit(dx, dy) {
    this.yaw -= dx * 0.006;
    this.pitch = clamp(this.pitch + dy * 0.006, -Math.PI / 2, Math.PI / 2);
  }
  /** The size of a pixel at the target, metres. */
  pixel() { return (2 * this.distance * Math.tan(FOV / 2)) / this.height; }
  /** @param {number} dx pixels @param {number} dy pixels */
  pan(dx, dy) {
    const { right, up } = this.axes();
    this.target = add(this.target, add(scale(right, -dx * this.pixel()), scale(up, dy * this.pixel())));
  }
  /** Makes the distance `factor` times as long; what is under the pixel stays there.
   * @param {number} factor @param {number} x @param {number} y */
  zoom(factor, x = this.width / 2, y = this.height / 2) {
    const distance = clamp(this.distance * factor, this.radius * 1e-3, this.radius * 50);
    const moved = 1 - distance / this.distance;
    this.pan((this.width / 2 - x) * moved, (this.height / 2 - y) * moved);
    this.distance = distance;
  }
  /** Moves eye and target: to the right, upwards and forwards, metres. @param {number} x @param {number} y @param {number} z */
  fly(x, y, z) {
    const { right, up, back } = this.axes();
    this.target = add(this.target, add(scale(right, x), add(scale(up, y), scale(back, -z))));
  }
  /** @returns {{view: Mat4, projection: Mat4, both: Mat4}} */
  matrices() {
    const { right, up, back } = this.axes();
    const eye = this.eye();
    const away = dot(sub(eye, this.center), back);
    const far = Math.max(away, 0) + this.radius * 2.5;
    const aspect = this.width / this.height;
    const near = Math.max(away - this.radius * 1.5, Math.min(this.radius * 0.005, this.distance * 0.1));
    const projection = this.perspective
      ? perspective(FOV, aspect, near, Math.max(far, near * 2))
      : orthographic(this.distance * Math.tan(FOV / 2), aspect, away - this.radius * 3, away + this.radius * 3);
    const view = viewMatrix(right, up, back, eye);
    return { view, projection, both: multiply(projection, view) };
  }
  /** The ray through a pixel. @param {number} x @param {number} y @returns {Ray} */
  ray(x, y) {
    const { right, up, back } = this.axes();
    const dx = (x - this.width / 2) * this.pixel();
    const dy = (this.height / 2 - y) * this.pixel();
    const through = add(this.target, add(scale(right, dx), scale(up, dy)));
    if (this.perspective) return { origin: this.eye(), direction: normalize(sub(through, this.eye())) };
    return { origin: add(through, scale(back, this.radius * 3 + this.distance)), direction: scale(back, -1) };
  }
  /** The pixel of a point, or null when it is behind the viewer. @param {Mat4} both @param {Vec3} point @returns {[number, number] | null} */
  project(both, point) {
    const [x, y, , w] = transform(both, point);
    if (w <= 0) return null;
    return [((x / w + 1) / 2) * this.width, ((1 - y / w) / 2) * this.height];
  }
}
