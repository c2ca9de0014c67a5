// Plots along a path: what they show, and which configuration is at which place.

import assert from "node:assert/strict";
import { test } from "node:test";
import { curvatureOf, quantitiesOf, timeAt, wayOf } from "mp/plot.js";

/** A path with these drawn points. */
const pathOf = (points, more = {}) => ({ count: points.length, trace: Float32Array.from(points.flat()), travel: null, clearance: null, rows: new Float64Array(0), ...more });
const near = (a, b) => assert.ok(Math.abs(a - b) < 1e-5, `${a} instead of ${b}`);

test("places are by how far the robot has moved", () => {
  const path = pathOf([[0, 0, 0], [1, 0, 0], [1, 0, 0], [4, 0, 0]], { travel: Float32Array.from([0, 1, 1, 4]) });
  const way = wayOf(path);
  assert.deepEqual([...way], [0, 0.25, 0.25, 1]);
  for (const [part, time] of [[0, 0], [0.125, 0.5], [0.625, 2.5], [1, 3]]) near(timeAt(way, part), time);
  // Without lengths each step counts alike; a path of one configuration has a place too.
  assert.deepEqual([...wayOf({ ...path, travel: null })].map((x) => Math.round(3 * x)), [0, 1, 2, 3]);
  assert.equal(timeAt(wayOf(pathOf([[0, 0, 0]])), 0.7), 0);
  // A robot that turns in place, or a path that stays where it is, is no reason to divide by zero.
  assert.ok([...wayOf({ ...path, travel: new Float32Array(4) })].every(Number.isFinite));
});

test("the curvature of a circle is one over its radius, that of a line is zero", () => {
  const circle = Array.from({ length: 50 }, (_, i) => [2 * Math.cos(i / 20), 2 * Math.sin(i / 20), 7]);
  [...curvatureOf(pathOf(circle))].slice(1, -1).forEach((c) => assert.ok(Math.abs(c - 0.5) < 1e-3, String(c)));
  const line = Array.from({ length: 5 }, (_, i) => [i, 2 * i, -i]);
  assert.ok([...curvatureOf(pathOf(line))].every((c) => Math.abs(c) < 1e-5));
  assert.ok([...curvatureOf(pathOf([[1, 1, 1], [1, 1, 1], [1, 1, 1]]))].every((c) => c === 0));
});

test("each column can be plotted, and what a path has", () => {
  const scene = { columns: [{ name: "x", unit: "m" }, { name: "angle", unit: "rad" }] };
  const path = pathOf([[0, 0, 0], [1, 0, 0], [3, 0, 0]], { rows: Float64Array.from([0, 1, 2, 3, 4, 5]), travel: Float32Array.from([0, 1, 3]) });
  const all = quantitiesOf(scene);
  assert.deepEqual(all.map(({ name }) => name), ["clearance", "x", "angle", "curvature of the trace", "step"]);
  assert.deepEqual(all.map((quantity) => quantity.of(path) && [...quantity.of(path)]), [null, [0, 2, 4], [1, 3, 5], [0, 0, 0], [1, 2, 2]]);
  assert.deepEqual(all.map(({ period }) => period > 0), [false, false, true, false, false]);
});
