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

test("lines of a body are not lost", () => {
  const first = shapesOf(scene([triangle(1)], [body(0)]));
  const second = shapesOf(scene([triangle(1)], [body(0, [0])]), first.shapes);
  assert.equal(second.shapes[0].segments.length, 6);
  const third = shapesOf(scene([triangle(1)], [body(0)]), second.shapes);
  assert.equal(third.shapes[0].segments.length, 0);
});
