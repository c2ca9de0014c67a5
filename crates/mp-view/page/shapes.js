// The shapes that are drawn and picked: a mesh, an area or polylines, with the edges that show its form.

import { triangulate } from "mp/triangulate.js";

/** @import { Body, Scene } from "mp/scene.js" */
/** @typedef {{positions: Float32Array, triangles: Uint32Array, edges: Uint32Array, wire: Uint32Array, segments: Float32Array,
 *  closed: boolean, low: number[], high: number[]}} Shape
 *  `edges` are the feature edges and `wire` all edges, as pairs of corners; `segments` are lines, six numbers each. */

/** Edges are drawn where the surface bends by more than this. */
const FEATURE_COS = Math.cos(Math.PI / 6);

/** For each corner the first corner at the same place: files may repeat corners for each triangle.
 * @param {Float32Array} positions @returns {Uint32Array} */
function weld(positions) {
  const count = positions.length / 3;
  const bits = new Int32Array(positions.map((x) => x + 0).buffer);
  let size = 16;
  while (size < 2 * count) size *= 2;
  const table = new Int32Array(size).fill(-1);
  const first = new Uint32Array(count);
  for (let i = 0; i < count; i++) {
    const [x, y, z] = [bits[3 * i], bits[3 * i + 1], bits[3 * i + 2]];
    let h = Math.imul(x, 73856093) ^ Math.imul(y, 19349663) ^ Math.imul(z, 83492791);
    h = (h ^ (h >>> 15)) & (size - 1);
    for (let j = table[h]; j >= 0 && (bits[3 * j] !== x || bits[3 * j + 1] !== y || bits[3 * j + 2] !== z); j = table[h]) h = (h + 1) & (size - 1);
    if (table[h] < 0) table[h] = i;
    first[i] = table[h];
  }
  return first;
}

/** The unit normals of all triangles. @param {Float32Array} p @param {Uint32Array} triangles @returns {Float32Array} */
function normalsOf(p, triangles) {
  const out = new Float32Array(triangles.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const [ux, uy, uz] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
    const [vx, vy, vz] = [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
    const n = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    const norm = Math.hypot(n[0], n[1], n[2]) || 1;
    for (let k = 0; k < 3; k++) out[t + k] = n[k] / norm;
  }
  return out;
}

/** The triangles at each edge of a mesh. `turns` is +1 for a triangle that runs along the edge and −1 for one against it.
 * @param {Uint32Array} triangles @param {Uint32Array} first
 * @returns {Map<number, {a: number, b: number, triangles: number[], turns: number}>} */
function edgesOf(triangles, first) {
  /** @type {Map<number, {a: number, b: number, triangles: number[], turns: number}>} */ const edges = new Map();
  for (let i = 0; i < triangles.length; i++) {
    const t = i - (i % 3);
    const a = first[triangles[i]];
    const b = first[triangles[t + ((i + 1) % 3)]];
    if (a === b) continue;
    const key = Math.min(a, b) * first.length + Math.max(a, b);
    let edge = edges.get(key);
    if (!edge) edges.set(key, (edge = { a, b, triangles: [], turns: 0 }));
    edge.triangles.push(t);
    edge.turns += a < b ? 1 : -1;
  }
  return edges;
}

/** Six times the volume that the mesh holds. @param {Float32Array} p @param {Uint32Array} triangles */
function volumeOf(p, triangles) {
  let sum = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    sum += p[a] * (p[b + 1] * p[c + 2] - p[b + 2] * p[c + 1]);
    sum += p[a + 1] * (p[b + 2] * p[c] - p[b] * p[c + 2]);
    sum += p[a + 2] * (p[b] * p[c + 1] - p[b + 1] * p[c]);
  }
  return sum;
}

/** Feature edges, all edges, and whether the mesh is closed and its triangles face outwards.
 * @param {Float32Array} positions @param {Uint32Array} triangles */
function outline(positions, triangles) {
  const normals = normalsOf(positions, triangles);
  /** @type {number[]} */ const edges = [];
  /** @type {number[]} */ const wire = [];
  let closed = triangles.length > 0;
  for (const edge of edgesOf(triangles, weld(positions)).values()) {
    wire.push(edge.a, edge.b);
    const [s, t] = edge.triangles;
    const pair = edge.triangles.length === 2;
    closed &&= edge.triangles.length % 2 === 0 && edge.turns === 0;
    const cos = pair ? normals[s] * normals[t] + normals[s + 1] * normals[t + 1] + normals[s + 2] * normals[t + 2] : -1;
    if (cos < FEATURE_COS) edges.push(edge.a, edge.b);
  }
  closed &&= volumeOf(positions, triangles) > 0;
  return { edges: new Uint32Array(edges), wire: new Uint32Array(wire), closed };
}

/** The segments of polylines. @param {Float32Array[]} polylines @returns {Float32Array} */
export function segmentsOf(polylines) {
  const count = polylines.reduce((sum, p) => sum + Math.max(0, p.length / 3 - 1), 0);
  const out = new Float32Array(6 * count);
  let at = 0;
  for (const p of polylines) {
    for (let i = 0; i + 6 <= p.length; i += 3, at += 6) out.set(p.subarray(i, i + 6), at);
  }
  return out;
}

function boxOf(/** @type {Float32Array[]} */ arrays) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const points of arrays) {
    for (let i = 0; i < points.length; i++) {
      low[i % 3] = Math.min(low[i % 3], points[i]);
      high[i % 3] = Math.max(high[i % 3], points[i]);
    }
  }
  return { low, high };
}

/** Whether two arrays hold the same numbers. @param {Float32Array | Uint32Array} a @param {Float32Array | Uint32Array} b */
const same = (a, b) => a.length === b.length && a.every((x, i) => x === b[i]);

/** @param {Scene} scene @param {Body} body @param {Shape[]} known shapes of before: finding the edges of a large mesh takes long @returns {Shape} */
function shapeOf(scene, body, known) {
  const none = { positions: new Float32Array(0), triangles: new Uint32Array(0) };
  const area = body.mesh < 0 && body.area >= 0;
  const { positions, triangles } = body.mesh >= 0 ? scene.meshes[body.mesh] : area ? triangulate(scene.areas[body.area].rings) : none;
  const before = body.mesh >= 0 && !body.lines.length ? known.find((s) => !s.segments.length && same(s.triangles, triangles) && same(s.positions, positions)) : undefined;
  if (before) return before;
  const segments = segmentsOf(body.lines.map((l) => scene.lines[l]));
  return { positions, triangles, segments, ...outline(positions, triangles), ...boxOf([positions, segments]) };
}

/** The shapes of a scene, each once, and for each body the index of its shape.
 * @param {Scene} scene @param {Shape[]} [before] those of another scene, which may have some of them @returns {{shapes: Shape[], ofBody: number[]}} */
export function shapesOf(scene, before = []) {
  /** @type {Map<string, number>} */ const known = new Map();
  /** @type {Shape[]} */ const shapes = [];
  const ofBody = scene.bodies.map((body) => {
    const key = `${body.mesh} ${body.area} ${body.lines.join(",")}`;
    let i = known.get(key);
    if (i === undefined) {
      known.set(key, (i = shapes.length));
      shapes.push(shapeOf(scene, body, before));
    }
    return i;
  });
  return { shapes, ofBody };
}
