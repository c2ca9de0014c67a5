// Reads a scene file (.mpv, version 1) into a typed model. A file that is not as specified gives an error in plain words.

import { hexColor } from "mp/colors.js";

/** @import { Color } from "mp/colors.js" */
/** @import { Vec3 } from "mp/math.js" */
/** @typedef {{name: string, unit: string}} Column */
/** @typedef {{positions: Float32Array, triangles: Uint32Array}} Mesh */
/** @typedef {{rings: Float32Array[]}} Area */
/** @typedef {{name: string, role: "robot" | "obstacle", mesh: number, area: number, lines: number[], pose: number[],
 *  color: Color | null, stretch: Vec3}} Body
 *  `mesh` and `area` are -1 where the body has none. `stretch` is 1, 1, 1 but while handles scale the body. */
/** @typedef {{row: number[], poses: number[]}} Configuration */
/** @typedef {{name: string, count: number, rows: Float64Array, poses: Float32Array, trace: Float32Array,
 *  clearance: Float32Array | null, verified: boolean, length: number}} Path */
/** @typedef {{name: string, nodes: Float32Array, parents: Int32Array}} Tree */
/** @typedef {{nodes: Float32Array, edges: Uint32Array, component: Uint32Array, kind: Uint8Array}} Roadmap */
/** @typedef {{name: string, space: string, planar: boolean, columns: Column[], limits: ([number, number] | null)[],
 *  bounds: [number[], number[]], meshes: Mesh[], areas: Area[], lines: Float32Array[], bodies: Body[], robot: number,
 *  start: Configuration, goals: Configuration[], paths: Path[], trees: Tree[], roadmap: Roadmap | null,
 *  report: Record<string, unknown> | null}} Scene
 *  `robot` is the number of robot bodies; they are the first of `bodies`. */

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

/** The array parts of a file. */
class Blob {
  /** @param {Uint8Array} bytes @param {number} begin where the arrays begin */
  constructor(bytes, begin) {
    this.bytes = bytes; this.begin = begin;
  }
  /** The array that a head entry names, without copying it. @template {keyof Arrays} K
   * @param {unknown} entry @param {K} type @param {string} what @param {number} group entries that belong together
   * @returns {Arrays[K]} */
  array(entry, type, what, group = 1) {
    const { type: given, offset, count } = /** @type {{type: unknown, offset: number, count: number}} */ (
      /** @type {unknown} */ (object(entry, `array of ${what}`))
    );
    check(given === type, `In the scene file, the array of ${what} must have the type ${type}.`);
    const whole = Number.isSafeInteger(offset) && Number.isSafeInteger(count) && offset >= 0 && count >= 0;
    check(whole && offset % 8 === 0, `In the scene file, the array of ${what} has an offset or a count that is not possible.`);
    const Kind = KINDS[type];
    const end = this.begin + offset + count * Kind.BYTES_PER_ELEMENT;
    check(end <= this.bytes.length, `The scene file is too short: the array of ${what} reaches beyond its end.`);
    check(count % group === 0, `In the scene file, the array of ${what} must have a multiple of ${group} entries.`);
    return /** @type {Arrays[K]} */ (new Kind(/** @type {ArrayBuffer} */ (this.bytes.buffer), this.bytes.byteOffset + this.begin + offset, count));
  }
  /** An array of finite numbers. @template {"f32" | "f64"} K
   * @param {unknown} entry @param {K} type @param {string} what @param {number} group @returns {Arrays[K]} */
  finite(entry, type, what, group) {
    const array = this.array(entry, type, what, group);
    for (let i = 0; i < array.length; i++) check(Number.isFinite(array[i]), `In the scene file, the array of ${what} has an entry that is no number.`);
    return array;
  }
}

/** @param {ArrayLike<number>} indices @param {number} end @param {string} what @param {number} [low] */
function checkIndices(indices, end, what, low = 0) {
  for (let i = 0; i < indices.length; i++) {
    check(indices[i] >= low && indices[i] < end, `In the scene file, ${what} names number ${indices[i]}, but only ${end} are there.`);
  }
}

/** @param {Uint8Array} bytes @returns {{head: Json, blob: Blob}} */
function readHead(bytes) {
  check(bytes.length >= 8 && String.fromCharCode(...bytes.subarray(0, 3)) === "MPV", "This is not a scene file: it does not begin with MPV1.");
  check(bytes[3] === 49, `This page reads scene files of version 1; this one begins with MPV${String.fromCharCode(bytes[3])}.`);
  const size = new DataView(bytes.buffer, bytes.byteOffset).getUint32(4, true);
  check(size % 8 === 0, "The scene file is damaged: the length of its head is not a multiple of 8.");
  check(8 + size <= bytes.length, "The scene file is too short: its head reaches beyond its end.");
  const source = new TextDecoder().decode(bytes.subarray(8, 8 + size));
  /** @type {unknown} */ let head;
  try {
    // A seed may have more digits than a number holds; it is only shown, so it becomes text.
    head = JSON.parse(source.replace(/(?<!\\)"seed":\s*(\d{16,})/g, '"seed":"$1"'));
  } catch {
    throw new Error("The scene file is damaged: its head is not JSON.");
  }
  return { head: object(head, "head"), blob: new Blob(bytes, 8 + size) };
}

/** @param {unknown} entry @param {Blob} blob @returns {Mesh} */
function readMesh(entry, blob) {
  const mesh = object(entry, "mesh");
  const positions = blob.finite(mesh.positions, "f32", "positions of a mesh", 3);
  const triangles = blob.array(mesh.triangles, "u32", "triangles of a mesh", 3);
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
  check(role === "robot" || role === "obstacle", `In the scene file, the body “${name}” is neither robot nor obstacle.`);
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

/** @param {unknown} entry @param {Blob} blob @param {number} columns @param {number} robot @returns {Path} */
function readPath(entry, blob, columns, robot) {
  const path = object(entry, "path");
  const name = text(path.name, "name of a path");
  const rows = blob.finite(path.rows, "f64", `rows of the path “${name}”`, Math.max(1, columns));
  const poses = blob.finite(path.poses, "f32", `poses of the path “${name}”`, 7);
  const trace = blob.finite(path.trace, "f32", `trace of the path “${name}”`, 3);
  const clearance = path.clearance == null ? null : blob.array(path.clearance, "f32", `clearance of the path “${name}”`);
  const count = trace.length / 3;
  const equal = rows.length === count * columns && poses.length === count * robot * 7 && (!clearance || clearance.length === count);
  check(equal, `In the scene file, the arrays of the path “${name}” do not have the same number of configurations.`);
  const length = typeof path.length === "number" ? path.length : NaN;
  return { name, count, rows, poses, trace, clearance, verified: path.verified === true, length };
}

/** @param {unknown} entry @param {Blob} blob @returns {Tree} */
function readTree(entry, blob) {
  const tree = object(entry, "tree");
  const name = text(tree.name, "name of a tree");
  const nodes = blob.finite(tree.nodes, "f32", `nodes of the tree “${name}”`, 3);
  const parents = blob.array(tree.parents, "i32", `parents of the tree “${name}”`);
  check(parents.length === nodes.length / 3, `In the scene file, the tree “${name}” must have one parent for each node.`);
  checkIndices(parents, parents.length, `a parent in the tree “${name}”`, -1);
  return { name, nodes, parents };
}

/** @param {unknown} entry @param {Blob} blob @returns {Roadmap | null} */
function readRoadmap(entry, blob) {
  if (entry == null) return null;
  const value = object(entry, "roadmap");
  const nodes = blob.finite(value.nodes, "f32", "nodes of the roadmap", 3);
  const edges = blob.array(value.edges, "u32", "edges of the roadmap", 2);
  const component = blob.array(value.component, "u32", "components of the roadmap");
  const kind = blob.array(value.kind, "u8", "kinds of the roadmap's nodes");
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

/** Reads and checks a scene file. @param {Uint8Array} given @returns {Scene} */
export function readScene(given) {
  // Arrays of numbers can be read in place only where the file begins at a multiple of 8 in memory.
  const bytes = given.byteOffset % 8 === 0 ? given : given.slice();
  const { head, blob } = readHead(bytes);
  check(head.version === 1, `This page reads scene files of version 1; this one says ${String(head.version)}.`);
  const meshes = maybeList(head.meshes, "list of meshes").map((m) => readMesh(m, blob));
  const areas = maybeList(head.areas, "list of areas").map((a) => ({
    rings: list(object(a, "area").rings, "rings of an area").map((r) => blob.finite(r, "f32", "points of a ring", 2)),
  }));
  const lines = maybeList(head.lines, "list of lines").map((l) => blob.finite(object(l, "line").points, "f32", "points of a line", 3));
  const bodies = list(head.bodies, "list of bodies").map((b, i) => readBody(b, i, { meshes, areas, lines }));
  const robot = bodies.filter((b) => b.role === "robot").length;
  check(bodies.slice(0, robot).every((b) => b.role === "robot"), "In the scene file, the robot's bodies must come first.");
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
    paths: maybeList(head.paths, "list of paths").map((p) => readPath(p, blob, columns.length, robot)),
    trees: maybeList(head.trees, "list of trees").map((t) => readTree(t, blob)),
    roadmap: readRoadmap(head.roadmap, blob),
    report: head.report == null ? null : object(head.report, "report"),
  };
}
