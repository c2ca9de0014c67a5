// A growing tree: its segments on the graphics card are those of its nodes and parents, whatever has happened to it.

import assert from "node:assert/strict";
import { test } from "node:test";
import { GrowingTree, KeptRows } from "mp/growing.js";

/** A set of rows as the graphics card would keep it. @param {number} floats */
function fakeSet(floats) {
  return {
    floats,
    rows: [],
    append(numbers) { for (let i = 0; i < numbers.length; i += floats) this.rows.push([...numbers.subarray(i, i + floats)]); },
    replace(row, numbers) { this.rows[row] = [...numbers]; },
    clear() { this.rows = []; },
    free() {},
  };
}
const renderer = { lineSet: () => fakeSet(6), pointSet: () => fakeSet(3) };

/** What should be drawn. */
function expected(nodes, parents) {
  const at = (i) => nodes.slice(3 * i, 3 * i + 3);
  return parents.map((p, i) => [...at(p < 0 ? i : p), ...at(i)]);
}

test("appended, rewired and pruned nodes have the right segments", () => {
  const tree = new GrowingTree(renderer, "start");
  let nodes = [];
  let parents = [];
  for (let step = 0; step < 200; step++) {
    const more = Array.from({ length: 1 + (step % 5) }, (_, i) => (parents.length + i ? (step * 7 + i) % (parents.length + i) : -1));
    const places = more.flatMap((_, i) => [step, i, step * i]);
    tree.append(new Float32Array(places), new Int32Array(more));
    nodes.push(...places);
    parents.push(...more);
    if (step % 3 === 0 && parents.length > 10) {
      tree.rewire(new Uint32Array([9, 5]), new Int32Array([2, 1]));
      [parents[9], parents[5]] = [2, 1];
    }
    if (step % 50 === 49) {
      // The last nodes go: those of which no other is a child that stays.
      const survivors = parents.map((_, i) => i).filter((i) => i < parents.length / 2);
      tree.prune(new Uint32Array(survivors));
      nodes = nodes.slice(0, 3 * survivors.length);
      parents = parents.slice(0, survivors.length);
    }
  }
  assert.equal(tree.count, parents.length);
  assert.deepEqual([...tree.tree().parents], parents);
  assert.deepEqual(tree.lines.rows, expected(nodes, parents));
  assert.deepEqual(tree.roots.rows, [nodes.slice(0, 3)]);
  // After the graphics card was lost, all is written again.
  tree.restart(renderer);
  assert.deepEqual(tree.lines.rows, expected(nodes, parents));
});

test("a node whose parent was pruned waits for its new parent, and is no root", () => {
  const tree = new GrowingTree(renderer, "start");
  tree.append(new Float32Array([0, 0, 0, 1, 0, 0, 2, 0, 0]), new Int32Array([-1, 0, 1]));
  tree.prune(new Uint32Array([0, 2]));
  assert.deepEqual(tree.roots.rows, [[0, 0, 0]]);
  tree.rewire(new Uint32Array([1]), new Int32Array([0]));
  assert.deepEqual(tree.lines.rows, [[0, 0, 0, 0, 0, 0], [0, 0, 0, 2, 0, 0]]);
});

test("edges of a roadmap join its nodes", () => {
  const nodes = new KeptRows(fakeSet(3));
  nodes.append(new Float32Array([0, 0, 0]));
  nodes.append(new Float32Array([1, 2, 3]));
  assert.deepEqual([...nodes.join(new Uint32Array([1, 0]))], [1, 2, 3, 0, 0, 0]);
  const set = fakeSet(3);
  nodes.restart(set);
  assert.deepEqual(set.rows, [[0, 0, 0], [1, 2, 3]]);
});
