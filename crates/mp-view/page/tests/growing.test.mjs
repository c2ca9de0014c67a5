// Growing trees and roadmaps: what is on the graphics card is what they are, whatever has happened to them.

import assert from "node:assert/strict";
import { test } from "node:test";
import { componentColor } from "mp/colors.js";
import { GrowingTree, KeptRows } from "mp/growing.js";
import { GrowingRoadmap } from "mp/milestones.js";

/** A set of rows as the graphics card would keep it. @param {number} floats */
function fakeSet(floats) {
  return {
    floats,
    rows: [],
    colors: [],
    written: 0,
    get count() { return this.rows.length; },
    append(numbers, color) {
      for (let i = 0; i < numbers.length; i += floats) {
        this.rows.push([...numbers.subarray(i, i + floats)]);
        this.colors.push(color(i / floats));
      }
    },
    replace(row, numbers) { this.rows[row] = [...numbers]; },
    rewrite(first, numbers, color) {
      for (let i = 0; i < numbers.length; i += floats) {
        this.rows[first + i / floats] = [...numbers.subarray(i, i + floats)];
        this.colors[first + i / floats] = color(i / floats);
        this.written++;
      }
    },
    clear() { [this.rows, this.colors] = [[], []]; },
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

/** All segments of a tree with bends, as a set of texts. */
function polylines(nodes, parents, bends) {
  return parents.flatMap((parent, i) => {
    const at = (k) => nodes.slice(3 * k, 3 * k + 3);
    const line = parent < 0 ? [at(i), at(i)] : [at(parent), ...(bends.get(i) ?? []), at(i)];
    return line.slice(1).map((point, k) => [...line[k], ...point].join(" "));
  }).sort();
}
const segmentsOfTree = (tree) => [...tree.lines.rows, ...tree.bent.rows].map((row) => row.join(" ")).sort();
/** Bends of nodes as events have them. */
const packedBends = (list) => ({ bent: new Uint32Array(list.flatMap(([node, points]) => [node, points.length])), through: new Float32Array(list.flatMap(([, points]) => points.flat())) });

test("bent edges are drawn as they are bent, also after rewiring, pruning and a loss of the graphics card", () => {
  const tree = new GrowingTree(renderer, "start");
  tree.append(new Float32Array([0, 0, 0, 9, 0, 0]), new Int32Array([-1, 0]), packedBends([[1, [[3, 1, 0], [6, 2, 0]]]]));
  tree.append(new Float32Array([9, 9, 0, 9, 9, 9]), new Int32Array([1, 2]), packedBends([[3, [[8, 8, 4]]]]));
  let nodes = [0, 0, 0, 9, 0, 0, 9, 9, 0, 9, 9, 9];
  const bends = new Map([[1, [[3, 1, 0], [6, 2, 0]]], [3, [[8, 8, 4]]]]);
  assert.deepEqual(segmentsOfTree(tree), polylines(nodes, [-1, 0, 1, 2], bends));
  // Growth shows the bends of the nodes that it shows, and no others.
  assert.deepEqual([0, 0.25, 0.5, 0.75, 1].map((growth) => tree.drawn(growth).map(({ count }) => count)), [[0, 0], [1, 0], [2, 2], [3, 2], [4, 3]]);
  // A new edge is straight, or bends elsewhere. What is left of the old one is points at its node.
  tree.rewire(new Uint32Array([3, 1]), new Int32Array([0, 0]), packedBends([[3, [[1, 1, 1], [2, 2, 2]]]]));
  bends.delete(1);
  bends.set(3, [[1, 1, 1], [2, 2, 2]]);
  const lines = segmentsOfTree(tree).filter((line) => line.split(" ").slice(0, 3).join() !== line.split(" ").slice(3).join());
  assert.deepEqual(lines, polylines(nodes, [-1, 0, 1, 0], bends).slice(1));
  assert.equal(tree.drawn(1)[1].count, tree.bent.rows.length);
  tree.restart(renderer);
  assert.deepEqual(segmentsOfTree(tree), polylines(nodes, [-1, 0, 1, 0], bends));
  tree.prune(new Uint32Array([0, 3]));
  nodes = [0, 0, 0, 9, 9, 9];
  assert.deepEqual(segmentsOfTree(tree), polylines(nodes, [-1, 0], new Map([[1, [[1, 1, 1], [2, 2, 2]]]])));
});

test("milestones and edges of a roadmap have the colour of their component while it grows", () => {
  const map = new GrowingRoadmap(renderer);
  const [count, ends] = [400, []];
  let random = 1;
  const next = (below) => (random = (random * 48271) % 2147483647) % below;
  const component = Array.from({ length: count }, (_, i) => i);
  for (let from = 0; from < count; from += 40) {
    const edges = Array.from({ length: 30 }, () => [next(from + 40), next(from + 40)]).filter(([a, b]) => a !== b);
    const places = Array.from({ length: 120 }, (_, i) => from + i);
    map.append({ nodes: new Float32Array(places), edges: new Uint32Array(edges.flat()), kind: new Uint8Array(40).fill((from / 40) % 3) });
    for (const [a, b] of edges) {
      const [old, now] = [component[a], component[b]];
      component.forEach((c, i) => { if (c === old) component[i] = now; });
      ends.push([a, b]);
    }
    // Two milestones have one colour exactly when they are connected.
    const color = (i) => map.nodes.set.colors[i].slice(0, 3).join(" ");
    const known = new Map();
    for (let i = 0; i < from + 40; i++) {
      if (!known.has(component[i])) known.set(component[i], color(i));
      assert.equal(color(i), known.get(component[i]), `milestone ${i} of ${from + 40}`);
    }
    assert.equal(new Set(known.values()).size, known.size);
    assert.equal(map.components.count, known.size);
    // It is the colour of the first milestone.
    known.forEach((c, of) => assert.deepEqual(c, componentColor(component.slice(0, from + 40).indexOf(of)).join(" ")));
    ends.forEach(([a], e) => assert.deepEqual(map.edges.set.colors[e].slice(0, 3).join(" "), color(a)));
  }
  assert.deepEqual(map.nodes.set.colors.slice(0, 1)[0].slice(3), [0.3], "a sampled milestone");
  assert.deepEqual(map.nodes.set.colors[40].slice(3), [0.65], "a guard");
  assert.match(JSON.stringify(map.describe(40).facts), /guard/);
  assert.notDeepEqual(componentColor(0), componentColor(1));
});

test("joining components writes only the one with the later first milestone again", () => {
  const map = new GrowingRoadmap(renderer);
  const chain = (from, count) => Array.from({ length: count - 1 }, (_, i) => [from + i, from + i + 1]).flat();
  const nodes = (count) => ({ nodes: new Float32Array(3 * count), kind: new Uint8Array(count) });
  map.append({ ...nodes(1000), edges: new Uint32Array(chain(0, 1000)) });
  map.append({ ...nodes(10), edges: new Uint32Array(chain(1000, 10)) });
  [map.nodes.set.written, map.edges.set.written] = [0, 0];
  map.append({ ...nodes(1), edges: new Uint32Array([1003, 500]) });
  assert.deepEqual([map.nodes.set.written, map.edges.set.written], [10, 9]);
});

test("edges that turn out to be blocked are taken away, and components fall apart", () => {
  const map = new GrowingRoadmap(renderer);
  const places = Array.from({ length: 15 }, (_, i) => i);
  const color = (i) => map.nodes.set.colors[i].slice(0, 3).join();
  const groups = () => [0, 1, 2, 3, 4].map((i) => [0, 1, 2, 3, 4].findIndex((k) => color(k) === color(i)));
  map.append({ nodes: new Float32Array(places), edges: new Uint32Array([0, 1, 2, 1, 2, 3, 3, 4]), kind: new Uint8Array(5), unlinked: new Uint32Array(0) });
  assert.deepEqual(groups(), [0, 0, 0, 0, 0]);
  map.append({ nodes: new Float32Array(0), edges: new Uint32Array(0), kind: new Uint8Array(0), unlinked: new Uint32Array([2, 1]) });
  assert.deepEqual(groups(), [0, 0, 2, 2, 2]);
  assert.deepEqual([map.components.count, [...map.degrees.subarray(0, 5)]], [2, [1, 1, 1, 2, 1]]);
  assert.deepEqual(map.edges.set.rows[1], [6, 7, 8, 6, 7, 8], "a point instead of the edge");
  assert.deepEqual(map.edges.set.colors.map((c) => c.slice(0, 3).join()), [0, 2, 2, 3].map(color));
  // Edges that come later can be taken away too, by the same event.
  map.append({ nodes: new Float32Array(0), edges: new Uint32Array([0, 4, 1, 2]), kind: new Uint8Array(0), unlinked: new Uint32Array([0, 4]) });
  assert.deepEqual(groups(), groups().map(() => 0));
  map.restart(renderer);
  assert.deepEqual(map.edges.set.rows[4], [0, 1, 2, 0, 1, 2]);
  assert.equal(map.components.count, 1);
});
