// Shapes of a scene that comes back changed.

import assert from "node:assert/strict";
import { test } from "node:test";
import { shapesOf } from "mp/shapes.js";

const body = (mesh, lines = []) => ({ name: "b", role: "obstacle", mesh, area: -1, lines, pose: [0, 0, 0, 0, 0, 0, 1], color: null, stretch: [1, 1, 1] });
const triangle = (x) => ({ positions: new Float32Array([0, 0, 0, x, 0, 0, 0, 1, 0]), triangles: new Uint32Array([0, 1, 2]) });
const scene = (meshes, bodies) => ({ meshes, areas: [], lines: [new Float32Array([0, 0, 0, 1, 1, 1])], bodies });

test("a mesh that did not change keeps its shape, wherever it is now", () => {
  const first = shapesOf(scene([triangle(1), triangle(2)], [body(0), body(1), body(0)]));
  assert.deepEqual(first.ofBody, [0, 1, 0]);
  const second = shapesOf(scene([triangle(2), triangle(3), triangle(1)], [body(0), body(1), body(2)]), first.shapes);
  assert.equal(second.shapes[0], first.shapes[1]);
  assert.equal(second.shapes[2], first.shapes[0]);
  assert.ok(!first.shapes.includes(second.shapes[1]));
  assert.deepEqual([...second.shapes[1].high], [3, 1, 0]);
});

test("meshes with the same numbers are one shape", () => {
  const { shapes, ofBody } = shapesOf(scene([triangle(1), triangle(2), triangle(1)], [body(0), body(1), body(2)]));
  assert.deepEqual([shapes.length, ...ofBody], [2, 0, 1, 0]);
});

test("lines of a body are not lost", () => {
  const first = shapesOf(scene([triangle(1)], [body(0)]));
  const second = shapesOf(scene([triangle(1)], [body(0, [0])]), first.shapes);
  assert.equal(second.shapes[0].segments.length, 6);
  const third = shapesOf(scene([triangle(1)], [body(0)]), second.shapes);
  assert.equal(third.shapes[0].segments.length, 0);
});

/** The corners of a unit cube; each triangle has corners of its own, as in STL files. */
function cube() {
  const quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  const corners = quads.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]);
  return { positions: new Float32Array(corners.flatMap((i) => [i & 1, (i >> 1) & 1, i >> 2])), triangles: new Uint32Array(corners.keys()) };
}

test("a cube has twelve feature edges, and eighteen with its diagonals", () => {
  const { shapes: [shape] } = shapesOf(scene([cube()], [body(0)]));
  assert.equal(shape.edges.length, 2 * 12);
  assert.equal(shape.wire.length, 2 * 18);
  assert.equal(shape.closed, true);
  const at = (i) => [...shape.positions.subarray(3 * i, 3 * i + 3)];
  for (let e = 0; e < shape.edges.length; e += 2) {
    const [a, b] = [at(shape.edges[e]), at(shape.edges[e + 1])];
    assert.equal(a.filter((x, k) => x !== b[k]).length, 1, "no diagonal is a feature edge");
  }
});

test("a cube without a side, or turned inside out, is not closed", () => {
  const open = cube();
  open.triangles = open.triangles.slice(3);
  const inside = cube();
  inside.triangles.reverse();
  const { shapes } = shapesOf(scene([open, inside], [body(0), body(1)]));
  assert.deepEqual(shapes.map((shape) => shape.closed), [false, false]);
  assert.equal(shapes[0].wire.length, 2 * 18);
  // The diagonal of the open side has one triangle.
  assert.equal(shapes[0].edges.length, 2 * 13);
});

test("three triangles at an edge make it a feature edge, and the mesh is not closed", () => {
  const positions = new Float32Array([0, 0, 0, 0, 0, 1, 1, 0, 0, -1, 0, 0, 0, 1, 0]);
  const fan = { positions, triangles: new Uint32Array([0, 1, 2, 0, 1, 3, 0, 1, 4]) };
  const { shapes: [shape] } = shapesOf(scene([fan], [body(0)]));
  assert.equal(shape.wire.length, 2 * 7);
  assert.equal(shape.edges.length, 2 * 7);
  assert.equal(shape.closed, false);
});

test("a very large mesh is shown without edges", () => {
  const count = 4_000_001;
  const triangles = new Uint32Array(3 * count);
  for (let i = 0; i < triangles.length; i++) triangles[i] = i % 3;
  const { shapes: [shape] } = shapesOf(scene([{ positions: triangle(1).positions, triangles }], [body(0)]));
  assert.deepEqual([shape.outlined, shape.edges.length, shape.wire.length], [false, 0, 0]);
  assert.deepEqual([...shape.high], [1, 1, 0]);
});
