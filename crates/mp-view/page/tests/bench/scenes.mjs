// Large scenes as scene files, for the benchmark of the page.

import { encode } from "mp/message.js";

/** Numbers that look random and are the same each time. @param {number} seed */
function random(seed) {
  let state = seed >>> 0 || 1;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

/** An obstacle: a ring with waves. @param {number} triangles about so many @param {number} [place] of several rings, which all differ */
export function ring(triangles, place = 0) {
  const [rows, columns] = [Math.round(Math.sqrt(triangles)), Math.round(Math.sqrt(triangles) / 2)];
  const positions = new Float32Array(3 * rows * columns);
  const corners = new Uint32Array(6 * rows * columns);
  for (let i = 0; i < rows; i++) {
    for (let j = 0; j < columns; j++) {
      const [a, b] = [(2 * Math.PI * i) / rows, (2 * Math.PI * j) / columns];
      const r = 0.3 + 0.03 * Math.sin(9 * a + place) * Math.cos(7 * b);
      const at = i * columns + j;
      positions.set([(1 + r * Math.cos(b)) * Math.cos(a), (1 + r * Math.cos(b)) * Math.sin(a), r * Math.sin(b)], 3 * at);
      const [down, right] = [((i + 1) % rows) * columns + j, i * columns + ((j + 1) % columns)];
      const across = ((i + 1) % rows) * columns + ((j + 1) % columns);
      corners.set([at, down, across, at, across, right], 6 * at);
    }
  }
  return { positions, triangles: corners, pose: [3 * (place % 10), 3 * (Math.floor(place / 10) % 10), Math.floor(place / 100), 0, 0, 0, 1] };
}

/** A small box. */
export function box() {
  const positions = new Float32Array([...Array(8).keys()].flatMap((i) => [i & 1, (i >> 1) & 1, i >> 2].map((x) => 0.1 * x)));
  const quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  return { positions, triangles: new Uint32Array(quads.flatMap(([a, b, c, d]) => [a, b, c, a, c, d])), pose: [0, 0, 0, 0, 0, 0, 1] };
}

/** A path that winds around the ring. @param {number} count configurations */
export function path(count) {
  const [rows, poses] = [new Float64Array(6 * count), new Float32Array(7 * count)];
  const [trace, clearance] = [new Float32Array(3 * count), new Float32Array(count)];
  for (let i = 0; i < count; i++) {
    const a = (20 * Math.PI * i) / count;
    const at = [1.6 * Math.cos(a), 1.6 * Math.sin(a), (0.8 * i) / count];
    rows.set([...at, a, 0, 0], 6 * i);
    poses.set([...at, 0, 0, Math.sin(a / 2), Math.cos(a / 2)], 7 * i);
    trace.set(at, 3 * i);
    clearance[i] = 0.1 + 0.05 * Math.sin(a);
  }
  return { name: "path", rows, poses, trace, clearance, verified: true, length: 1 };
}

/** A tree that grows by small steps from random nodes. @param {number} edges @param {number} seed */
export function grownTree(edges, seed) {
  const next = random(seed);
  const nodes = new Float32Array(3 * (edges + 1));
  const parents = new Int32Array(edges + 1).fill(-1);
  for (let i = 1; i <= edges; i++) {
    parents[i] = Math.floor(next() * i);
    for (let k = 0; k < 3; k++) nodes[3 * i + k] = nodes[3 * parents[i] + k] + 0.2 * (next() - 0.5);
  }
  return { name: seed === 1 ? "from the start" : "from the goal", nodes, parents };
}

/** The bytes of a scene file with these obstacles, and a box as robot. @param {ReturnType<typeof ring>[]} obstacles
 * @param {{paths?: object[], trees?: object[]}} [more] */
export function scene(obstacles, { paths = [], trees = [] } = {}) {
  const robot = box();
  const meshes = [robot, ...obstacles].map(({ positions, triangles }) => ({ positions, triangles }));
  const bodies = obstacles.map(({ pose }, i) => ({ name: `ring ${i + 1}`, role: "obstacle", mesh: i + 1, pose }));
  const end = (x) => ({ row: [x, 0, 1, 0, 0, 0], poses: [x, 0, 1, 0, 0, 0, 1] });
  const far = Math.max(2, ...obstacles.map(({ pose }) => 2 + Math.max(pose[0], pose[1])));
  const columns = ["x", "y", "z", "alpha", "beta", "gamma"].map((name, i) => ({ name, unit: i < 3 ? "m" : "rad" }));
  return encode({
    version: 1, name: "large", space: "SE3", planar: false, columns, limits: columns.map(() => null), bounds: [[-2, -2, -1], [far, far, 2]],
    meshes, areas: [], lines: [], bodies: [{ name: "robot", role: "robot", mesh: 0 }, ...bodies], start: end(-1.5), goals: [end(1.5)],
    paths, trees, roadmap: null, report: null,
  });
}
