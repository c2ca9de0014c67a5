// Scene files: what is read, and what is refused with a sentence.

import assert from "node:assert/strict";
import { test } from "node:test";
import { encode } from "mp/message.js";
import { readScene } from "mp/scene.js";

const end = { row: [0], poses: [] };
/** A scene file with these members besides those that each has. */
const file = (more) => encode({ version: 1, name: "a", space: "R1", columns: [{ name: "x", unit: "m" }], limits: [null], bounds: [[0, 0, 0], [1, 1, 1]], bodies: [], start: end, ...more });
const tree = (more) => ({ name: "start", nodes: new Float32Array(9), parents: Int32Array.from([-1, 0, 0]), ...more });
const path = (more) => ({ name: "p", rows: new Float64Array(2), poses: new Float32Array(0), trace: new Float32Array(6), clearance: null, verified: true, ...more });

test("bent edges and travel are read; a file without them is read too", () => {
  const bends = { bent: Uint32Array.from([2, 1]), through: Float32Array.from([1, 2, 3]) };
  const [straight, bent] = readScene(file({ trees: [tree(), tree(bends)] })).trees;
  assert.equal(straight.bends, null);
  assert.deepEqual(bent.bends, bends);
  const paths = readScene(file({ paths: [path(), path({ travel: Float32Array.from([0, 3]) })] })).paths;
  assert.equal(paths[0].travel, null);
  assert.deepEqual([...paths[1].travel], [0, 3]);
});

test("bent edges and travel that do not fit are refused", () => {
  const bad = [
    { bent: Uint32Array.from([3, 1]), through: new Float32Array(3) }, { bent: Uint32Array.from([1, 2]), through: new Float32Array(3) },
    { bent: Uint32Array.from([1]), through: new Float32Array(0) }, { bent: Uint32Array.from([1, 0]), through: new Float32Array(0) },
    { bent: Uint32Array.from([1, 1]) }, { bent: Uint32Array.from([1, 1]), through: Float32Array.from([0, NaN, 0]) },
  ];
  for (const bends of bad) assert.throws(() => readScene(file({ trees: [tree(bends)] })), /In the scene file, .*ben[dt]/);
  for (const travel of [new Float32Array(3), Float32Array.from([0, NaN])]) assert.throws(() => readScene(file({ paths: [path({ travel })] })), /In the scene file/);
});
