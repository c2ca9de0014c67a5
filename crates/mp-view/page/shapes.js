// The shapes that are drawn and picked: a mesh, an area or polylines, with the edges that show its form.

import { triangulate } from "mp/triangulate.js";

/** @import { Body, Scene } from "mp/scene.js" */
/** @typedef {{positions: Float32Array, triangles: Uint32Array, edges: Uint32Array, wire: Uint32Array, segments: Float32Array,
 *  closed: boolean, outlined: boolean, low: number[], high: number[]}} Shape
 *  `edges` are the feature edges and `wire` all edges, as pairs of corners; `segments` are lines, six numbers each. A mesh that is not
 *  `outlined` is too large for its edges to be found. */

/** Edges are found of meshes with at most so many triangles: four million take a few seconds and half a gigabyte. */
const MOST_OUTLINED = 4_000_000;

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
    const a = 3 * triangles[t];
    const b = 3 * triangles[t + 1];
    const c = 3 * triangles[t + 2];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    const norm = Math.sqrt(x * x + y * y + z * z) || 1;
    out[t] = x / norm;
    out[t + 1] = y / norm;
    out[t + 2] = z / norm;
  }
  return out;
}

/** The edges of a mesh: the two corners of edge e are `ends[2 e]` and `ends[2 e + 1]`, and the first two triangles at it begin at
 * `pairs[2 e]` and `pairs[2 e + 1]` of the corners of triangles. `uses` counts its triangles; `turns` is the sum of +1 for each
 * triangle that runs along the edge and −1 for each against it. In tables of numbers: a mesh has millions of edges.
 * @param {Uint32Array} triangles @param {Uint32Array} first */
function edgesOf(triangles, first) {
  let size = 16;
  while (size < 1.3 * triangles.length) size *= 2;
  const table = new Int32Array(size).fill(-1);
  const ends = new Uint32Array(2 * triangles.length);
  const pairs = new Uint32Array(2 * triangles.length);
  const uses = new Uint32Array(triangles.length);
  const turns = new Int32Array(triangles.length);
  let count = 0;
  for (let i = 0; i < triangles.length; i++) {
    const t = i - (i % 3);
    const a = first[triangles[i]];
    const b = first[triangles[t + ((i + 1) % 3)]];
    if (a === b) continue;
    let h = Math.imul(a < b ? a : b, 73856093) ^ Math.imul(a < b ? b : a, 19349663);
    h = (h ^ (h >>> 15)) & (size - 1);
    let e = table[h];
    while (e >= 0 && !((ends[2 * e] === a && ends[2 * e + 1] === b) || (ends[2 * e] === b && ends[2 * e + 1] === a))) {
      h = (h + 1) & (size - 1);
      e = table[h];
    }
    if (e < 0) {
      table[h] = e = count++;
      ends[2 * e] = a;
      ends[2 * e + 1] = b;
    }
    if (uses[e] < 2) pairs[2 * e + uses[e]] = t;
    uses[e]++;
    turns[e] += a < b ? 1 : -1;
  }
  return { count, ends: ends.slice(0, 2 * count), pairs, uses, turns };
}

/** Six times the volume that the mesh holds. @param {Float32Array} p @param {Uint32Array} triangles */
function volumeOf(p, triangles) {
  let sum = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t];
    const b = 3 * triangles[t + 1];
    const c = 3 * triangles[t + 2];
    sum += p[a] * (p[b + 1] * p[c + 2] - p[b + 2] * p[c + 1]);
    sum += p[a + 1] * (p[b + 2] * p[c] - p[b] * p[c + 2]);
    sum += p[a + 2] * (p[b] * p[c + 1] - p[b + 1] * p[c]);
  }
  return sum;
}

/** Feature edges, all edges, and whether the mesh is closed and its triangles face outwards. A very large mesh has none.
 * @param {Float32Array} positions @param {Uint32Array} triangles */
function outline(positions, triangles) {
  if (triangles.length > 3 * MOST_OUTLINED) return { edges: new Uint32Array(0), wire: new Uint32Array(0), closed: false, outlined: false };
  const normals = normalsOf(positions, triangles);
  const { count, ends, pairs, uses, turns } = edgesOf(triangles, weld(positions));
  const edges = new Uint32Array(2 * count);
  let kept = 0;
  let closed = triangles.length > 0;
  for (let e = 0; e < count; e++) {
    closed &&= uses[e] % 2 === 0 && turns[e] === 0;
    const s = pairs[2 * e];
    const t = pairs[2 * e + 1];
    const cos = uses[e] === 2 ? normals[s] * normals[t] + normals[s + 1] * normals[t + 1] + normals[s + 2] * normals[t + 2] : -1;
    if (cos >= FEATURE_COS) continue;
    edges[kept++] = ends[2 * e];
    edges[kept++] = ends[2 * e + 1];
  }
  closed &&= volumeOf(positions, triangles) > 0;
  return { edges: edges.slice(0, kept), wire: ends, closed, outlined: true };
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
    for (let k = 0; k < 3; k++) {
      let least = low[k];
      let most = high[k];
      for (let i = k; i < points.length; i += 3) {
        if (points[i] < least) least = points[i];
        if (points[i] > most) most = points[i];
      }
      low[k] = least;
      high[k] = most;
    }
  }
  return { low, high };
}

/** Whether two arrays hold the same numbers. @param {Float32Array | Uint32Array} a @param {Float32Array | Uint32Array} b */
function same(a, b) {
  if (a.length !== b.length) return false;
  for (let i = 0; i < a.length; i++) if (a[i] !== b[i]) return false;
  return true;
}

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

/** For each mesh the first one with the same numbers: they are drawn together. @param {Scene["meshes"]} meshes @returns {number[]} */
function firstOfEach(meshes) {
  /** @type {Map<string, number[]>} */ const alike = new Map();
  return meshes.map(({ positions, triangles }, i) => {
    const key = [positions.length, triangles.length, positions[0], positions[positions.length >> 1], positions[positions.length - 1]].join(" ");
    const others = alike.get(key) ?? [];
    const first = others.find((j) => same(meshes[j].triangles, triangles) && same(meshes[j].positions, positions));
    if (first === undefined) alike.set(key, [...others, i]);
    return first ?? i;
  });
}

/** The shapes of a scene, each once, and for each body the index of its shape.
 * @param {Scene} scene @param {Shape[]} [before] those of another scene, which may have some of them @returns {{shapes: Shape[], ofBody: number[]}} */
export function shapesOf(scene, before = []) {
  /** @type {Map<string, number>} */ const known = new Map();
  /** @type {Shape[]} */ const shapes = [];
  const meshes = firstOfEach(scene.meshes);
  const ofBody = scene.bodies.map((body) => {
    const key = `${body.mesh < 0 ? -1 : meshes[body.mesh]} ${body.area} ${body.lines.join(",")}`;
    let i = known.get(key);
    if (i === undefined) {
      known.set(key, (i = shapes.length));
      shapes.push(shapeOf(scene, body, before));
    }
    return i;
  });
  return { shapes, ofBody };
}
