// What a search has reached: counts of the cells, and how much work an update is.

import assert from "node:assert/strict";
import { test } from "node:test";
import { CoverageGrid, reachBox } from "mp/coverage.js";
import { fieldPixels } from "mp/field.js";

/** Points with the same numbers each time. */
function randomPoints(count) {
  let seed = 7;
  return Float32Array.from({ length: 3 * count }, () => (seed = (seed * 48271) % 2147483647) / 2147483647);
}

test("cells count the points in them, in every projection", () => {
  for (const axes of [[0, 1], [0, 2], [1, 2]]) {
    const grid = new CoverageGrid(axes, [0, -1, 10], [4, 1, 14]);
    const sides = axes.map((k) => [4, 2, 4][k]);
    assert.deepEqual([grid.width, grid.height], sides.map((side) => side / grid.cell));
    assert.equal(Math.max(grid.width, grid.height), 64);
    const points = randomPoints(5000).map((x, i) => [4 * x, 2 * x - 1, 10 + 4 * x][i % 3]);
    grid.add(points, 0, 5000);
    const expected = new Map();
    for (let p = 0; p < 5000; p++) {
      const [c, r] = axes.map((k, side) => Math.min(sides[side] / grid.cell - 1, Math.floor((points[3 * p + k] - [0, -1, 10][k]) / grid.cell)));
      expected.set(r * grid.width + c, (expected.get(r * grid.width + c) ?? 0) + 1);
    }
    assert.equal(grid.reached, expected.size);
    assert.equal(grid.most, Math.max(...expected.values()));
    grid.counts.forEach((count, i) => assert.equal(count, expected.get(i) ?? 0));
    assert.equal(grid.outside, 0);
  }
});

test("points on the border count, points beside it are told apart", () => {
  const grid = new CoverageGrid([0, 1], [0, 0, 0], [1, 0.5, 1]);
  grid.add(new Float32Array([0, 0, 0, 1, 0.5, 0, 1.1, 0, 0, 0.5, -0.1, 0, NaN, 0, 0]), 0, 5);
  assert.deepEqual([grid.reached, grid.outside], [2, 3]);
  // A box without a side has cells all the same.
  const flat = new CoverageGrid([0, 1], [0, 3, 0], [1, 3, 0]);
  flat.add(new Float32Array([0.5, 3, 0]), 0, 1);
  assert.equal(flat.reached, 1);
});

test("an update counts what is new, and all again when nodes were taken away", () => {
  const grid = new CoverageGrid([0, 1], [0, 0, 0], [1, 1, 1]);
  const [points, tree, other] = [randomPoints(100_000), {}, {}];
  let counted = 0;
  const { add } = grid;
  grid.add = (array, from, to) => {
    counted += to - from;
    add.call(grid, array, from, to);
  };
  const nodes = (count, version = 0) => [{ of: tree, version, points, count }];
  const whole = (list) => {
    const fresh = new CoverageGrid([0, 1], [0, 0, 0], [1, 1, 1]);
    fresh.update(list);
    return [...fresh.counts];
  };
  for (let count = 0; count <= 100_000; count += 5000) {
    counted = 0;
    assert.equal(grid.update(nodes(count)), count > 0);
    assert.equal(counted, count ? 5000 : 0);
  }
  assert.equal(grid.update(nodes(100_000)), false);
  assert.deepEqual([...grid.counts], whole(nodes(100_000)));
  // Growth that is turned back, nodes that were pruned, another tree.
  for (const list of [nodes(30_000), nodes(30_000, 1), [...nodes(30_000, 1), { of: other, version: 0, points, count: 500 }], [{ of: other, version: 0, points, count: 500 }], []]) {
    assert.equal(grid.update(list), true);
    assert.deepEqual([...grid.counts], whole(list));
  }
  assert.deepEqual([grid.reached, grid.most], [0, 0]);
});

test("the fuller a cell, the less transparent it is", () => {
  const grid = new CoverageGrid([0, 1], [0, 0, 0], [64, 64, 1]);
  grid.add(new Float32Array([0.5, 0.5, 0, 0.5, 0.5, 0, 0.5, 0.5, 0, 5.5, 0.5, 0]), 0, 4);
  const pixels = grid.pixels([1, 0.5, 0]);
  const at = (cell) => [...pixels.subarray(4 * cell, 4 * cell + 4)];
  assert.deepEqual(at(1), [0, 0, 0, 0]);
  assert.deepEqual(at(0).slice(0, 3), [255, 128, 0]);
  assert.ok(at(0)[3] > at(5)[3] && at(5)[3] > 0);
});

test("the grid is where limits let the robot be", () => {
  const columns = ["x", "y", "angle"].map((name, k) => ({ name, unit: k < 2 ? "m" : "rad" }));
  const scene = { bounds: [[0, 0, 0], [1, 1, 1]], columns, limits: [[-5, 5], null, [0, 1]] };
  assert.deepEqual(reachBox(scene), [[-5, 0, 0], [5, 1, 1]]);
});

test("the field is clear where nothing pushes, and full at contact and within", () => {
  const pixels = fieldPixels({ energy: Float32Array.from([0, 0.25, 0.5, 3]) }, [1, 0, 0]);
  assert.deepEqual([3, 7, 11, 15].map((i) => pixels[i]), [0, 128, 255, 255]);
});
