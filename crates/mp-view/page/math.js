// Vectors, quaternions (x y z w), poses (x y z and a quaternion) and 4×4 matrices (column by column, as WebGL has them).

/** @typedef {[number, number, number]} Vec3 */
/** @typedef {Float32Array} Mat4 */
/** @typedef {ArrayLike<number>} Numbers */

/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
/** @param {Vec3} a @param {number} s @returns {Vec3} */
export const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
/** @param {Vec3} a @param {Vec3} b */
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/** @param {Vec3} a */
export const length = (a) => Math.hypot(a[0], a[1], a[2]);
/** @param {Vec3} a @returns {Vec3} */
export const normalize = (a) => scale(a, 1 / (length(a) || 1));
/** @param {number} x @param {number} low @param {number} high */
export const clamp = (x, low, high) => Math.min(high, Math.max(low, x));
/** The point with index `i` of x y z triples. @param {Numbers} points @param {number} i @returns {Vec3} */
export const pointAt = (points, i) => [points[3 * i], points[3 * i + 1], points[3 * i + 2]];

/** Turns `v` by the quaternion at `at` of `q`. @param {Numbers} q @param {number} at @param {Vec3} v @returns {Vec3} */
export function rotate(q, at, v) {
  /** @type {Vec3} */ const axis = [q[at], q[at + 1], q[at + 2]];
  const t = add(cross(axis, v), scale(v, q[at + 3]));
  return add(v, scale(cross(axis, t), 2));
}

/** A point of the body in the world. @param {Numbers} pose @param {number} at @param {Vec3} p @returns {Vec3} */
export const place = (pose, at, p) => add(rotate(pose, at + 3, p), [pose[at], pose[at + 1], pose[at + 2]]);

/** A direction of the world in the frame of the body. @param {Numbers} pose @param {number} at @param {Vec3} v @returns {Vec3} */
export const unrotate = (pose, at, v) =>
  rotate([-pose[at + 3], -pose[at + 4], -pose[at + 5], pose[at + 6]], 0, v);

/** A point of the world in the frame of the body. @param {Numbers} pose @param {number} at @param {Vec3} p @returns {Vec3} */
export const unplace = (pose, at, p) => unrotate(pose, at, sub(p, [pose[at], pose[at + 1], pose[at + 2]]));
/** The pose that moves nothing. */
export const IDENTITY = Object.freeze([0, 0, 0, 0, 0, 0, 1]);

/** Interpolates poses: places linearly, quaternions linearly on the shorter way and then normalised.
 * @param {Numbers} from @param {number} a where the first pose begins
 * @param {Numbers} to @param {number} b where the second pose begins
 * @param {number} t between 0 and 1
 * @param {Float32Array | number[]} out @param {number} at */
export function lerpPose(from, a, to, b, t, out, at) {
  for (let k = 0; k < 3; k++) out[at + k] = from[a + k] + (to[b + k] - from[a + k]) * t;
  let same = 0;
  for (let k = 3; k < 7; k++) same += from[a + k] * to[b + k];
  const sign = same < 0 ? -1 : 1;
  let norm = 0;
  for (let k = 3; k < 7; k++) {
    out[at + k] = from[a + k] + (sign * to[b + k] - from[a + k]) * t;
    norm += out[at + k] * out[at + k];
  }
  norm = Math.sqrt(norm) || 1;
  for (let k = 3; k < 7; k++) out[at + k] /= norm;
}

/** @param {Mat4} a @param {Mat4} b @returns {Mat4} a·b */
export function multiply(a, b) {
  const out = new Float32Array(16);
  for (let c = 0; c < 4; c++) {
    for (let r = 0; r < 4; r++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += a[4 * k + r] * b[4 * c + k];
      out[4 * c + r] = sum;
    }
  }
  return out;
}

/** @param {number} fov of the height, radians @param {number} aspect @param {number} near @param {number} far @returns {Mat4} */
export function perspective(fov, aspect, near, far) {
  const f = 1 / Math.tan(fov / 2);
  const d = near - far;
  return new Float32Array([f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / d, -1, 0, 0, (2 * far * near) / d, 0]);
}

/** @param {number} halfHeight @param {number} aspect @param {number} near @param {number} far @returns {Mat4} */
export function orthographic(halfHeight, aspect, near, far) {
  const d = near - far;
  const h = 1 / halfHeight;
  return new Float32Array([h / aspect, 0, 0, 0, 0, h, 0, 0, 0, 0, 2 / d, 0, 0, 0, (far + near) / d, 1]);
}

/** The matrix from the world to an eye with these axes. @param {Vec3} right @param {Vec3} up @param {Vec3} back @param {Vec3} eye @returns {Mat4} */
export function viewMatrix(right, up, back, eye) {
  return new Float32Array([
    right[0], up[0], back[0], 0,
    right[1], up[1], back[1], 0,
    right[2], up[2], back[2], 0,
    -dot(right, eye), -dot(up, eye), -dot(back, eye), 1,
  ]);
}

/** Multiplies a matrix and the point (p, 1). @param {Mat4} m @param {Vec3} p @returns {[number, number, number, number]} */
export function transform(m, p) {
  const row = (/** @type {number} */ r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r];
  return [row(0), row(1), row(2), row(3)];
}
