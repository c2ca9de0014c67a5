// The mathematics of the handles: where they are, which one a pixel hits, and what dragging one does. Nothing is drawn here.

import { add, dot, normalize, rotate, scale, sub } from "mp/math.js";

/** @import { Ray } from "mp/camera.js" */
/** @import { Numbers, Vec3 } from "mp/math.js" */
/** @typedef {[number, number, number, number]} Quaternion x y z w */
/** @typedef {[number, number]} Pixel */
/** @typedef {"move" | "turn" | "scale"} HandleMode */
/** @typedef {{mode: HandleMode, axis: 0 | 1 | 2 | 3, points: Vec3[]}} Handle
 *  A polyline of the world. `axis` 3 is the handle in the middle: it moves along the screen, or scales all axes. */
/** @typedef {{origin: Vec3, turn: Quaternion}} Frame where the handles are, and how the body is turned */
/** @typedef {{shift: Vec3, turn: Quaternion, factor: Vec3}} Change
 *  Metres, a turn about the world's axes, and a factor for each of the body's own axes. */
/** @typedef {(point: Vec3) => Pixel | null} Project */

export const NO_CHANGE = Object.freeze({
  shift: /** @type {Vec3} */ ([0, 0, 0]), turn: /** @type {Quaternion} */ ([0, 0, 0, 1]), factor: /** @type {Vec3} */ ([1, 1, 1]),
});

/** The angle that a turn snaps to: 15 degrees. */
export const ANGLE_STEP = Math.PI / 12;
/** The factor that a scale snaps to. */
const FACTOR_STEP = 0.1;
/** The smallest factor. */
const FACTOR_LEAST = 0.01;
/** How near to a handle a press must be, pixels. */
const NEAR = { mouse: 9, touch: 22 };

/** @type {Vec3[]} */
export const AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/** @param {Vec3} axis of length 1 @param {number} angle radians @returns {Quaternion} */
export function turnAbout(axis, angle) {
  const s = Math.sin(angle / 2);
  return [axis[0] * s, axis[1] * s, axis[2] * s, Math.cos(angle / 2)];
}

/** First `b`, then `a`. @param {Numbers} a @param {Numbers} b @returns {Quaternion} */
export function joined(a, b) {
  const [x, y, z, w] = [0, 1, 2, 3].map((i) => a[i]);
  const [p, q, r, s] = [0, 1, 2, 3].map((i) => b[i]);
  return [w * p + x * s + y * r - z * q, w * q - x * r + y * s + z * p, w * r + x * q - y * p + z * s, w * s - x * p - y * q - z * r];
}

/** R = Rz(α)·Ry(β)·Rx(γ). @param {number} alpha @param {number} beta @param {number} gamma @returns {Quaternion} */
export const fromAngles = (alpha, beta, gamma) => joined(turnAbout(AXES[2], alpha), joined(turnAbout(AXES[1], beta), turnAbout(AXES[0], gamma)));

/** α, β and γ of a turn, with β from −π/2 to π/2; where β is at an end, γ is 0. @param {Numbers} q @returns {[number, number, number]} */
export function toAngles(q) {
  const [x, y, z] = AXES.map((axis) => rotate(q, 0, axis));
  const sine = Math.max(-1, Math.min(1, -x[2]));
  if (Math.abs(sine) > 1 - 1e-12) return [Math.atan2(-y[0], y[1]), (Math.PI / 2) * Math.sign(sine), 0];
  return [Math.atan2(x[1], x[0]), Math.asin(sine), Math.atan2(y[2], z[2])];
}

/** Seven numbers, as scene files have them, of x y z α β γ. @param {Numbers} six @returns {number[]} */
export const poseOfSix = (six) => [six[0], six[1], six[2], ...fromAngles(six[3], six[4], six[5])];

/** x y z α β γ after a change. What did not turn keeps its angles as they are written.
 * @param {Numbers} six @param {Change} change @returns {[number, number, number, number, number, number]} */
export function changedSix(six, { shift, turn }) {
  const old = /** @type {[number, number, number]} */ ([six[3], six[4], six[5]]);
  const angles = Math.abs(turn[3]) === 1 ? old : toAngles(joined(turn, fromAngles(...old)));
  return [tidy(six[0] + shift[0]), tidy(six[1] + shift[1]), tidy(six[2] + shift[2]), ...angles];
}

/** A pose (seven numbers) after a change about a point. @param {Numbers} pose @param {number} at @param {Vec3} origin @param {Change} change
 * @returns {number[]} */
export function changedPose(pose, at, origin, { shift, turn }) {
  /** @type {Vec3} */ const place = [pose[at], pose[at + 1], pose[at + 2]];
  const moved = add(add(rotate(turn, 0, sub(place, origin)), origin), shift);
  return [...moved, ...joined(turn, [pose[at + 3], pose[at + 4], pose[at + 5], pose[at + 6]])];
}

/** Removes the last digits, which come from rounding. @param {number} x */
export const tidy = (x) => Number(x.toPrecision(12));

/** A step to snap places to: 1, 2 or 5 times a power of ten, at least `pixels` wide. @param {number} pixel metres @param {number} [pixels] */
export function niceStep(pixel, pixels = 12) {
  const least = Math.max(pixel * pixels, 1e-9);
  const power = 10 ** Math.floor(Math.log10(least));
  return tidy([1, 2, 5, 10].map((k) => k * power).find((step) => step >= least * (1 - 1e-9)) ?? 10 * power);
}

/** The handles of a body. @param {HandleMode} mode @param {Frame} frame @param {number} size metres @param {boolean} planar @returns {Handle[]} */
export function handlesOf(mode, { origin, turn }, size, planar) {
  /** @type {(0 | 1 | 2)[]} */ const axes = planar && mode === "turn" ? [2] : planar && mode === "move" ? [0, 1] : [0, 1, 2];
  /** @type {Handle[]} */ const handles = axes.map((axis) => ({ mode, axis, points: mode === "turn" ? ring(origin, axis, size) : [origin, add(origin, scale(axisOf(mode, axis, turn), size))] }));
  if (mode !== "turn") handles.push({ mode, axis: 3, points: [origin] });
  return handles;
}

/** The direction of a handle: scales go along the body's own axes. @param {HandleMode} mode @param {0 | 1 | 2} axis @param {Quaternion} turn */
const axisOf = (mode, axis, turn) => (mode === "scale" ? rotate(turn, 0, AXES[axis]) : AXES[axis]);

/** A closed circle. @param {Vec3} origin @param {0 | 1 | 2} axis @param {number} radius @returns {Vec3[]} */
function ring(origin, axis, radius) {
  const [u, v] = [AXES[(axis + 1) % 3], AXES[(axis + 2) % 3]];
  return Array.from({ length: 65 }, (_, i) => {
    const angle = (i * Math.PI) / 32;
    return add(origin, add(scale(u, radius * Math.cos(angle)), scale(v, radius * Math.sin(angle))));
  });
}

/** The handle at a pixel, or null. @param {Handle[]} handles @param {Project} project @param {Pixel} pixel @param {boolean} [touch] @returns {Handle | null} */
export function handleAt(handles, project, pixel, touch = false) {
  let near = touch ? NEAR.touch : NEAR.mouse;
  /** @type {Handle | null} */ let best = null;
  // The middle comes first: the arrows begin there.
  for (const handle of [...handles].sort((a, b) => b.axis - a.axis)) {
    const away = pixelsTo(pixel, handle.points.map(project));
    if (away < near) [near, best] = [handle.axis === 3 ? 0 : away, handle];
  }
  return best;
}

/** How far a pixel is from a polyline. @param {Pixel} p @param {(Pixel | null)[]} line */
function pixelsTo(p, line) {
  let best = Infinity;
  line.forEach((b, i) => {
    const a = line[Math.max(i - 1, 0)];
    if (!a || !b) return;
    const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    const t = Math.max(0, Math.min(1, ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy || 1)));
    best = Math.min(best, Math.hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy));
  });
  return best;
}

/** Where the line through `origin` comes nearest to the ray, as metres along `axis`; NaN where the ray looks along it.
 * @param {Ray} ray @param {Vec3} origin @param {Vec3} axis of length 1 */
export function alongAxis(ray, origin, axis) {
  const cos = dot(ray.direction, axis);
  const sine = 1 - cos * cos;
  if (sine < 1e-3) return NaN;
  const to = sub(ray.origin, origin);
  return (dot(to, axis) - cos * dot(to, ray.direction)) / sine;
}

/** Where the ray meets a plane, or null. @param {Ray} ray @param {Vec3} origin @param {Vec3} normal @returns {Vec3 | null} */
export function onPlane(ray, origin, normal) {
  const cos = dot(ray.direction, normal);
  if (Math.abs(cos) < 0.15) return null;
  const t = dot(sub(origin, ray.origin), normal) / cos;
  return t > 0 ? add(ray.origin, scale(ray.direction, t)) : null;
}

/** A handle that is being dragged. It knows where it was taken, so nothing adds up while it moves. */
export class Drag {
  /** @param {Handle} handle @param {Frame} frame @param {Ray} ray where it was taken @param {Pixel} pixel @param {Project} project
   * @param {Vec3} back the direction to the viewer @param {boolean} planar */
  constructor(handle, frame, ray, pixel, project, back, planar) {
    this.handle = handle; this.frame = frame; this.pixel = pixel; this.planar = planar; this.back = back;
    this.normal = planar ? AXES[2] : back;
    this.first = this.measure(ray, pixel);
    this.tangent = handle.mode === "turn" ? this.tangentAt(pixel, project) : null;
  }
  /** The ray's place on the handle: metres along an axis, a point of a plane, or an angle. @param {Ray} ray @param {Pixel} pixel
   * @returns {number | Vec3 | null} */
  measure(ray, pixel) {
    const { mode, axis } = this.handle;
    const { origin, turn } = this.frame;
    if (axis === 3) return mode === "scale" ? pixel[0] - pixel[1] : onPlane(ray, origin, this.normal);
    if (mode !== "turn") return alongAxis(ray, origin, axisOf(mode, axis, turn));
    const point = onPlane(ray, origin, AXES[axis]);
    if (!point) return null;
    const from = sub(point, origin);
    return Math.atan2(dot(from, AXES[(axis + 2) % 3]), dot(from, AXES[(axis + 1) % 3]));
  }
  /** Of a ring seen from its edge: the way of its near half on the screen, pixels for one radian. @param {Pixel} pixel @param {Project} project @returns {Pixel} */
  tangentAt(pixel, project) {
    const { points } = this.handle;
    let [best, near] = [0, Infinity];
    points.slice(0, -1).forEach((point, i) => {
      const at = isFar(point, this.frame.origin, this.back) ? null : project(point);
      const away = at ? Math.hypot(at[0] - pixel[0], at[1] - pixel[1]) : Infinity;
      if (away < near) [best, near] = [i, away];
    });
    const [a, b] = [project(points[best]), project(points[best + 1])];
    const step = Math.PI / 32;
    return a && b ? [(b[0] - a[0]) / step, (b[1] - a[1]) / step] : [0, 0];
  }
  /** What the drag does so far. @param {Ray} ray @param {Pixel} pixel @param {number} snap step for places in metres; 0: none @returns {Change} */
  to(ray, pixel, snap) {
    const { mode, axis } = this.handle;
    const now = this.measure(ray, pixel);
    if (mode === "move") return { ...NO_CHANGE, shift: this.shift(now, snap) };
    if (mode === "scale") return { ...NO_CHANGE, factor: this.factor(/** @type {number} */ (now), snap > 0) };
    const angle = this.angle(/** @type {number | null} */ (now), pixel);
    return { ...NO_CHANGE, turn: turnAbout(AXES[axis], snap > 0 ? Math.round(angle / ANGLE_STEP) * ANGLE_STEP : angle) };
  }
  /** @param {number | Vec3 | null} now @param {number} snap @returns {Vec3} */
  shift(now, snap) {
    const { axis } = this.handle;
    const { first } = this;
    if (axis === 3) {
      if (!Array.isArray(now) || !Array.isArray(first)) return [0, 0, 0];
      return this.snapped(sub(now, first), snap);
    }
    const metres = /** @type {number} */ (now) - /** @type {number} */ (first);
    return Number.isFinite(metres) ? this.snapped(scale(AXES[axis], metres), snap) : [0, 0, 0];
  }
  /** So that the place is a multiple of the step along the axes that move. @param {Vec3} shift @param {number} snap @returns {Vec3} */
  snapped(shift, snap) {
    if (!snap) return shift;
    const { origin } = this.frame;
    const moves = (/** @type {number} */ k) => this.handle.axis === k || (this.handle.axis === 3 && !(this.planar && k === 2));
    return /** @type {Vec3} */ (shift.map((d, k) => (moves(k) ? Math.round((origin[k] + d) / snap) * snap - origin[k] : 0)));
  }
  /** @param {number | null} now @param {Pixel} pixel */
  angle(now, pixel) {
    if (now !== null && typeof this.first === "number") return now - this.first;
    const [x, y] = this.tangent ?? [0, 0];
    return ((pixel[0] - this.pixel[0]) * x + (pixel[1] - this.pixel[1]) * y) / (x * x + y * y || Infinity);
  }
  /** @param {number} now @param {boolean} snap @returns {Vec3} */
  factor(now, snap) {
    const { axis } = this.handle;
    const first = /** @type {number} */ (this.first);
    const raw = axis === 3 ? Math.exp((now - first) / 100) : now / first;
    const round = snap ? Math.max(FACTOR_STEP, Math.round(raw / FACTOR_STEP) * FACTOR_STEP) : raw;
    const factor = tidy(Math.max(FACTOR_LEAST, Number.isFinite(round) ? round : 1));
    return /** @type {Vec3} */ ([0, 1, 2].map((k) => (axis === 3 || axis === k ? factor : 1)));
  }
}

/** What a change does, in words. @param {Change} change @param {Handle} handle @param {Vec3} place after it */
export function changeWords(change, handle, place) {
  const round = (/** @type {number} */ x) => String(Number(x.toPrecision(4)));
  if (handle.mode === "move") return `${handle.axis === 3 ? place.map(round).join(", ") : `${"xyz"[handle.axis]} ${round(place[handle.axis])}`} m`;
  if (handle.mode === "scale") return `× ${round(change.factor[handle.axis === 3 ? 0 : handle.axis])}`;
  const [x, y, z, w] = change.turn;
  const sine = [x, y, z, 0][handle.axis];
  const degrees = (2 * Math.atan2(sine, w) * 180) / Math.PI;
  return `${round(degrees > 180 ? degrees - 360 : degrees < -180 ? degrees + 360 : degrees)}° about ${"xyz"[handle.axis]}`;
}

/** Whether a point of a ring is behind its centre; that half is drawn faintly.
 * @param {Vec3} point @param {Vec3} origin @param {Vec3} back */
export const isFar = (point, origin, back) => dot(normalize(sub(point, origin)), back) < -0.05;
