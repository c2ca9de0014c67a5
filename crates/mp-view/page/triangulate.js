// Triangulates an area: an outer ring and holes, by ear clipping. Holes are joined to the outer ring by bridges first.

/** @typedef {[number, number]} Point */

/** Twice the signed area of a triangle; positive when it turns left. @param {Point} a @param {Point} b @param {Point} c */
const turn = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
/** @param {Point} a @param {Point} b */
const same = (a, b) => a[0] === b[0] && a[1] === b[1];

/** The points of a ring without repetitions. @param {ArrayLike<number>} ring @returns {Point[]} */
function pointsOf(ring) {
  /** @type {Point[]} */ const points = [];
  for (let i = 0; i + 1 < ring.length; i += 2) {
    /** @type {Point} */ const p = [ring[i], ring[i + 1]];
    if (!points.length || !same(points[points.length - 1], p)) points.push(p);
  }
  while (points.length > 1 && same(points[0], points[points.length - 1])) points.pop();
  return points;
}

/** The ring, counter-clockwise or clockwise. @param {Point[]} ring @param {boolean} left @returns {Point[]} */
function oriented(ring, left) {
  let area = 0;
  for (let i = 0; i < ring.length; i++) area += turn([0, 0], ring[i], ring[(i + 1) % ring.length]);
  return area > 0 === left ? ring : ring.slice().reverse();
}

/** Whether `p` is in the triangle that turns left, or on its border. @param {Point} p @param {Point} a @param {Point} b @param {Point} c */
const inside = (p, a, b, c) => turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
/** Whether two segments cross in their inside. @param {Point} a @param {Point} b @param {Point} c @param {Point} d */
const crosses = (a, b, c, d) => turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;

/** Whether the way from corner `i` to `m` begins inside the ring. @param {Point[]} ring @param {number} i @param {Point} m */
function beginsInside(ring, i, m) {
  const [a, p, b] = [ring[(i + ring.length - 1) % ring.length], ring[i], ring[(i + 1) % ring.length]];
  const [fromA, toB] = [turn(a, p, m) > 0, turn(p, b, m) > 0];
  return turn(a, p, b) >= 0 ? fromA && toB : fromA || toB;
}

/** Whether `p` is to the right of `q`, or above it. @param {Point} p @param {Point} q */
const beyond = (p, q) => p[0] > q[0] || (p[0] === q[0] && p[1] > q[1]);

/** The nearest corner of `ring` that `m`, the rightmost corner of a hole, sees to the right, or −1. @param {Point[]} ring @param {Point[][]} holes
 * @param {Point} m @returns {number} */
function visibleCorner(ring, holes, m) {
  const away = ring.map((p) => Math.hypot(p[0] - m[0], p[1] - m[1]));
  const order = ring.map((_, i) => i).filter((i) => beyond(ring[i], m)).sort((i, j) => away[i] - away[j]);
  const borders = [ring, ...holes];
  const free = (/** @type {number} */ i) => borders.every((b) => b.every((a, k) => !crosses(ring[i], m, a, b[(k + 1) % b.length])));
  return order.find((i) => beginsInside(ring, i, m) && free(i)) ?? -1;
}

/** The ring with the first of the holes joined to it. @param {Point[]} ring @param {Point[][]} holes @returns {Point[]} */
function bridged(ring, holes) {
  const hole = holes[0];
  let right = 0;
  hole.forEach((p, i) => (right = beyond(p, hole[right]) ? i : right));
  const corner = visibleCorner(ring, holes, hole[right]);
  if (corner < 0) return ring;
  const around = [...hole.slice(right), ...hole.slice(0, right + 1)];
  return [...ring.slice(0, corner + 1), ...around, ...ring.slice(corner)];
}

/** Whether the corner `at` of what is left is an ear. @param {Point[]} points @param {number[]} left @param {number} at */
function isEar(points, left, at) {
  const n = left.length;
  const [a, b, c] = [points[left[(at + n - 1) % n]], points[left[at]], points[left[(at + 1) % n]]];
  if (turn(a, b, c) <= 0) return false;
  return left.every((i) => {
    const p = points[i];
    return same(p, a) || same(p, b) || same(p, c) || !inside(p, a, b, c);
  });
}

/** @param {Point[]} points counter-clockwise @returns {number[]} */
function clipEars(points) {
  const left = points.map((_, i) => i);
  /** @type {number[]} */ const triangles = [];
  let at = 0;
  let tried = 0;
  while (left.length > 2) {
    const n = left.length;
    at %= n;
    const [a, b, c] = [left[(at + n - 1) % n], left[at], left[(at + 1) % n]];
    const flat = turn(points[a], points[b], points[c]) === 0;
    // A ring that crosses itself may have no ear: then any corner is cut, so that this ends.
    if (!flat && tried <= n && !isEar(points, left, at)) {
      at++;
      tried++;
      continue;
    }
    if (!flat) triangles.push(a, b, c);
    left.splice(at, 1);
    tried = 0;
  }
  return triangles;
}

/** Triangulates an area. @param {ArrayLike<number>[]} rings outer ring first
 * @returns {{positions: Float32Array, triangles: Uint32Array}} in the plane z = 0 */
export function triangulate(rings) {
  const [outer, ...holes] = rings.map(pointsOf);
  let ring = oriented(outer ?? [], true);
  holes
    .filter((hole) => hole.length > 2)
    .map((hole) => oriented(hole, false))
    .sort((a, b) => Math.max(...b.map((p) => p[0])) - Math.max(...a.map((p) => p[0])))
    .forEach((_, i, sorted) => (ring = bridged(ring, sorted.slice(i))));
  return {
    positions: new Float32Array(ring.flatMap((p) => [p[0], p[1], 0])),
    triangles: new Uint32Array(ring.length > 2 ? clipEars(ring) : []),
  };
}
