// Reads a scene file (.mpv, version 1) into a typed model. A file that is not as specified gives an error in plain words.

import { hexColor } from "mp/colors.js";
import { decode } from "mp/message.js";

/** @import { Color } from "mp/colors.js" */
/** @import { Bends } from "mp/growing.js" */
/** @import { Vec3 } from "mp/math.js" */
/** @typedef {{name: string, unit: string}} Column */
/** @typedef {{positions: Float32Array, triangles: Uint32Array}} Mesh */
/** @typedef {{rings: Float32Array[]}} Area */
/** @typedef {{name: string, role: "robot" | "moving" | "obstacle", mesh: number, area: number, lines: number[], pose: number[],
 *  color: Color | null, stretch: Vec3}} Body
 *  `mesh` and `area` are -1 where the body has none. `stretch` is 1, 1, 1 but while handles scale the body. */
/** @typedef {{row: number[], poses: number[], refused?: boolean}} Configuration  `refused`: the planner said that it is not free */
/** @typedef {{duration: number, velocities: Float64Array, accelerations: Float64Array, limits: [number, number][], curve: string, knots: object,
 *  words: string[]}} Trajectory  configurations are at equal times; `limits`: of velocity and acceleration of each column */
/** @typedef {{name: string, count: number, rows: Float64Array, poses: Float32Array, trace: Float32Array,
 *  clearance: Float32Array | null, travel: Float32Array | null, verified: boolean, length: number, ofRun: boolean,
 *  written: number[][] | null, trajectory: Trajectory | null}} Path  `ofRun`: made by a run of this page; `written`: the path's own configurations, where they are
 *  known: `rows` are more, for the animation; `travel`: how far the robot has moved until each, metres, or of a `trajectory` seconds */
/** @typedef {{name: string, nodes: Float32Array, parents: Int32Array, bends: Bends | null}} Tree */
/** @typedef {{nodes: Float32Array, edges: Uint32Array, component: Uint32Array, kind: Uint8Array}} Roadmap */
/** @typedef {{name: string, space: string, planar: boolean, columns: Column[], limits: ([number, number] | null)[],
 *  bounds: [number[], number[]], meshes: Mesh[], areas: Area[], lines: Float32Array[], bodies: Body[], robot: number,
 *  start: Configuration, goals: Configuration[], paths: Path[], trees: Tree[], roadmap: Roadmap | null,
 *  report: Record<string, unknown> | null, notes: string[]}} Scene
 *  `robot` is the number of bodies whose poses come with configurations: robot bodies and obstacles that move; they are the first of `bodies`. `notes` are what the planner says of the scene. */

/** @typedef {Record<string, unknown>} Json */
/** @typedef {{f32: Float32Array, f64: Float64Array, u32: Uint32Array, i32: Int32Array, u8: Uint8Array}} Arrays */

const KINDS = { f32: Float32Array, f64: Float64Array, u32: Uint32Array, i32: Int32Array, u8: Uint8Array };

/** @param {boolean} holds @param {string} sentence @returns {asserts holds} */
function check(holds, sentence) { if (!holds) throw new Error(sentence); }

/** @param {unknown} value @param {string} what @returns {Json} */
function object(value, what) {
  check(typeof value === "object" && value !== null && !Array.isArray(value), `The scene file has no ${what}, or it is not an object.`);
  return /** @type {Json} */ (value);
}

/** @param {unknown} value @param {string} what @returns {unknown[]} */
function list(value, what) {
  check(Array.isArray(value), `The scene file has no ${what}, or it is not a list.`);
  return value;
}

/** A list that may be left out. @param {unknown} value @param {string} what */
const maybeList = (value, what) => (value == null ? [] : list(value, what));

/** @param {unknown} value @param {string} what */
function text(value, what) {
  check(typeof value === "string", `The scene file has no ${what}, or it is not text.`);
  return value;
}

/** @param {unknown} value @param {string} what @param {number} count @returns {number[]} */
function numbers(value, what, count) {
  const all = list(value, what);
  check(all.length === count && all.every((x) => Number.isFinite(x)), `In the scene file, ${what} must be ${count} numbers.`);
  return /** @type {number[]} */ (all);
}

/** @param {unknown} value @param {number} end @param {string} what @returns {number} */
function index(value, end, what) {
  check(Number.isInteger(value), `In the scene file, ${what} must be a whole number.`);
  const i = /** @type {number} */ (value);
  check(i >= 0 && i < end, `In the scene file, ${what} is ${i}, but only ${end} are there.`);
  return i;
}

/** An array of the file. @template {keyof Arrays} K @param {unknown} value @param {K} type @param {string} what
 * @param {number} group entries that belong together @returns {Arrays[K]} */
function array(value, type, what, group = 1) {
  check(value instanceof KINDS[type], `In the scene file, the array of ${what} must have the type ${type}.`);
  const found = /** @type {Arrays[K]} */ (value);
  check(found.length % group === 0, `In the scene file, the array of ${what} must have a multiple of ${group} entries.`);
  return found;
}

/** An array of finite numbers. @template {"f32" | "f64"} K @param {unknown} value @param {K} type @param {string} what
 * @param {number} group @returns {Arrays[K]} */
function finite(value, type, what, group) {
  const found = array(value, type, what, group);
  let all = true;
  for (let i = 0; i < found.length; i++) all = all && Number.isFinite(found[i]);
  check(all, `In the scene file, the array of ${what} has an entry that is no number.`);
  return found;
}

/** @param {ArrayLike<number>} indices @param {number} end @param {string} what @param {number} [low] */
function checkIndices(indices, end, what, low = 0) {
  for (let i = 0; i < indices.length; i++) {
    // The sentence is made only when it is needed: there may be millions of indices.
    if (!(indices[i] >= low && indices[i] < end)) throw new Error(`In the scene file, ${what} names number ${indices[i]}, but only ${end} are there.`);
  }
}

/** @param {unknown} entry @returns {Mesh} */
function readMesh(entry) {
  const mesh = object(entry, "mesh");
  const positions = finite(mesh.positions, "f32", "positions of a mesh", 3);
  const triangles = array(mesh.triangles, "u32", "triangles of a mesh", 3);
  checkIndices(triangles, positions.length / 3, "a triangle");
  return { positions, triangles };
}

/** @param {unknown} value @param {string} name @returns {Color | null} */
function readColor(value, name) {
  if (value == null) return null;
  check(/^#[0-9a-f]{6}$/i.test(String(value)), `In the scene file, the colour of the body “${name}” must be written as #rrggbb.`);
  return hexColor(String(value));
}

/** @param {unknown} entry @param {number} i @param {{meshes: unknown[], areas: unknown[], lines: unknown[]}} parts @returns {Body} */
function readBody(entry, i, parts) {
  const body = object(entry, "body");
  const name = text(body.name, "name of a body");
  const role = body.role;
  check(role === "robot" || role === "moving" || role === "obstacle", `In the scene file, the body “${name}” is neither robot nor obstacle.`);
  const mesh = body.mesh == null ? -1 : index(body.mesh, parts.meshes.length, `the mesh of the body “${name}”`);
  const area = body.area == null ? -1 : index(body.area, parts.areas.length, `the area of the body “${name}”`);
  const lines = maybeList(body.lines, "lines of a body").map((l) => index(l, parts.lines.length, `a line of the body “${name}”`));
  check(mesh >= 0 || area >= 0 || Array.isArray(body.lines), `In the scene file, the body “${name}” has no mesh, no area and no lines.`);
  const pose = role === "obstacle" ? numbers(body.pose, `the pose of the body “${name}”`, 7) : [];
  return { name, role, mesh, area, lines, pose, color: readColor(body.color, name), stretch: [1, 1, 1] };
}

/** @param {unknown} entry @param {string} what @param {number} columns @param {number} robot @returns {Configuration} */
function readConfiguration(entry, what, columns, robot) {
  const value = object(entry, what);
  return {
    row: numbers(value.row, `the row of the ${what}`, columns),
    poses: numbers(value.poses, `the poses of the ${what}`, 7 * robot),
  };
}

/** @param {unknown} entry @param {number} columns @param {number} robot @returns {Path} */
export function readPath(entry, columns, robot) {
  const path = object(entry, "path");
  const name = text(path.name, "name of a path");
  const rows = finite(path.rows, "f64", `rows of the path “${name}”`, Math.max(1, columns));
  const poses = finite(path.poses, "f32", `poses of the path “${name}”`, 7);
  const trace = finite(path.trace, "f32", `trace of the path “${name}”`, 3);
  const clearance = path.clearance == null ? null : array(path.clearance, "f32", `clearance of the path “${name}”`);
  const travel = path.travel == null ? null : finite(path.travel, "f32", `travel of the path “${name}”`, 1);
  const count = trace.length / 3;
  const corners = path.corners == null ? null : array(path.corners, "u32", `corners of the path “${name}”`);
  checkIndices(corners ?? [], count, `a corner of the path “${name}”`);
  const written = corners && Array.from(corners, (i) => [...rows.subarray(i * columns, (i + 1) * columns)]);
  const equal = rows.length === count * columns && poses.length === count * robot * 7 && [clearance, travel].every((known) => !known || known.length === count);
  check(equal, `In the scene file, the arrays of the path “${name}” do not have the same number of configurations.`);
  const length = typeof path.length === "number" ? path.length : NaN;
  return { name, count, rows, poses, trace, clearance, travel, verified: path.verified === true, length, ofRun: false, written, trajectory: null };
}

/** @param {unknown} entry @returns {Tree} */
function readTree(entry) {
  const tree = object(entry, "tree");
  const name = text(tree.name, "name of a tree");
  const nodes = finite(tree.nodes, "f32", `nodes of the tree “${name}”`, 3);
  const parents = array(tree.parents, "i32", `parents of the tree “${name}”`);
  check(parents.length === nodes.length / 3, `In the scene file, the tree “${name}” must have one parent for each node.`);
  checkIndices(parents, parents.length, `a parent in the tree “${name}”`, -1);
  return { name, nodes, parents, bends: tree.bent == null ? null : readBends(tree, parents.length, name) };
}

/** @param {Json} tree @param {number} count of nodes @param {string} name @returns {Bends} */
function readBends(tree, count, name) {
  const bent = array(tree.bent, "u32", `bent edges of the tree “${name}”`, 2);
  const through = finite(tree.through, "f32", `bends of the tree “${name}”`, 3);
  checkIndices(bent.filter((_, i) => i % 2 === 0), count, `a bent edge of the tree “${name}”`);
  const points = bent.reduce((sum, n, i) => sum + (i % 2 ? n : 0), 0);
  const some = bent.every((n, i) => i % 2 === 0 || n > 0);
  check(some && through.length === 3 * points, `In the scene file, the tree “${name}” must have as many bends as its bent edges say.`);
  return { bent, through };
}

/** @param {unknown} entry @returns {Roadmap | null} */
function readRoadmap(entry) {
  if (entry == null) return null;
  const value = object(entry, "roadmap");
  const nodes = finite(value.nodes, "f32", "nodes of the roadmap", 3);
  const edges = array(value.edges, "u32", "edges of the roadmap", 2);
  const component = array(value.component, "u32", "components of the roadmap");
  const kind = array(value.kind, "u8", "kinds of the roadmap's nodes");
  const count = nodes.length / 3;
  check(component.length === count && kind.length === count, "In the scene file, the roadmap must have one component and one kind for each node.");
  checkIndices(edges, count, "an edge of the roadmap");
  return { nodes, edges, component, kind };
}

/** @param {unknown} entry @param {number} i @returns {[number, number] | null} */
function readLimit(entry, i) {
  return entry == null ? null : /** @type {[number, number]} */ (numbers(entry, `the limits of column ${i + 1}`, 2));
}

/** @param {Json} head @returns {[number[], number[]]} */
function readBounds(head) {
  const corners = list(head.bounds, "bounds");
  check(corners.length === 2, "In the scene file, the bounds must be two corners.");
  return [numbers(corners[0], "the lower corner of the bounds", 3), numbers(corners[1], "the upper corner of the bounds", 3)];
}

/** @param {unknown[]} columns @returns {Column[]} */
const readColumns = (columns) =>
  columns.map((entry) => {
    const column = object(entry, "column");
    return { name: text(column.name, "name of a column"), unit: typeof column.unit === "string" ? column.unit : "" };
  });

/** A scene with nothing in it. @returns {Scene} */
export const emptyScene = () => ({
  name: "", space: "", planar: false, columns: [], limits: [], bounds: [[-1, -1, -1], [1, 1, 1]], meshes: [], areas: [], lines: [], bodies: [],
  robot: 0, start: { row: [], poses: [] }, goals: [], paths: [], trees: [], roadmap: null, report: null, notes: [],
});

/** Reads and checks a scene file. @param {Uint8Array} given @returns {Scene} */
export function readScene(given) {
  const head = decode(given);
  check(head.version === 1, `This page reads scene files of version 1; this one says ${String(head.version)}.`);
  const meshes = maybeList(head.meshes, "list of meshes").map((m) => readMesh(m));
  const areas = maybeList(head.areas, "list of areas").map((a) => ({
    rings: list(object(a, "area").rings, "rings of an area").map((r) => finite(r, "f32", "points of a ring", 2)),
  }));
  const lines = maybeList(head.lines, "list of lines").map((l) => finite(object(l, "line").points, "f32", "points of a line", 3));
  const bodies = list(head.bodies, "list of bodies").map((b, i) => readBody(b, i, { meshes, areas, lines }));
  const robot = bodies.filter((b) => b.role !== "obstacle").length;
  check(bodies.slice(0, robot).every((b) => b.role !== "obstacle"), "In the scene file, the robot's bodies must come first.");
  const columns = readColumns(list(head.columns, "list of columns"));
  const limits = maybeList(head.limits, "list of limits").map(readLimit);
  return {
    name: text(head.name, "name"),
    space: text(head.space, "space"),
    planar: head.planar === true,
    columns,
    limits,
    bounds: readBounds(head),
    meshes,
    areas,
    lines,
    bodies,
    robot,
    start: readConfiguration(head.start, "start", columns.length, robot),
    goals: maybeList(head.goals, "list of goals").map((g) => readConfiguration(g, "goal", columns.length, robot)),
    paths: maybeList(head.paths, "list of paths").map((p) => readPath(p, columns.length, robot)),
    trees: maybeList(head.trees, "list of trees").map((t) => readTree(t)),
    roadmap: readRoadmap(head.roadmap),
    report: head.report == null ? null : object(head.report, "report"),
    notes: [],
  };
}
