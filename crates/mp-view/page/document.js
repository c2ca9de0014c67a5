// What is edited: a document (docs/formats/session.md), commands that make a changed one, and its history. A document is an environment
// with its robot, or only the obstacles of a problem in a file, which keeps all else.
// Documents are never changed in place, so the history keeps them as they are.

/** @typedef {[number, number, number]} Three */
/** @typedef {[number, number, number, number, number, number]} Six x y z (m) α β γ (rad) */
/** @typedef {{sphere: {radius: number}} | {cube: {size: Three}} | {cone: {radius: number, height: number}}
 *  | {cylinder: {radius: number, height: number}} | {torus: {ring: number, tube: number}} | {tetrahedron: {edge: number}}} Figure */
/** @typedef {{rectangle: {size: [number, number]}} | {circle: {radius: number}} | {polygon: {rings: [number, number][][]}}} PlaneFigure */
/** @typedef {Figure | PlaneFigure | {mesh: {file: string, off?: string}} | {given: {of: number, kind: string}}} DocumentShape  `given`: as an obstacle of the file has it */
/** @typedef {{name: string, color?: string | null, shape: DocumentShape, scale?: Three}} DocumentBody */
/** @typedef {DocumentBody & {pose: Six, of?: number}} Obstacle */
/** @typedef {{version: 1, name: string, space: "SE3" | "SE2", bounds: [Three, Three] | null, robot: DocumentBody, start: Six,
 *  goal: Six, obstacles: Obstacle[]}} Environment */
/** @typedef {{version: 1, name: string, plane: boolean, start: number[] | null, goals: number[][] | null, obstacles: Obstacle[],
 *  robot?: undefined}} Problem  `plane`: a world in the plane */
/** @typedef {Environment | Problem} Document */
/** What a command is about: the robot at its start or its goal, or an obstacle by its index.
 * @typedef {"start" | "goal" | number} Part */

/** The figures by their names, with the sizes of a new one. @type {Record<string, Figure>} */
export const FIGURES = {
  sphere: { sphere: { radius: 1 } },
  cone: { cone: { radius: 1, height: 2 } },
  cube: { cube: { size: [2, 2, 2] } },
  cylinder: { cylinder: { radius: 1, height: 2 } },
  torus: { torus: { ring: 1, tube: 0.3 } },
  tetrahedron: { tetrahedron: { edge: 2 } },
};

/** The figures of worlds in the plane. @type {Record<string, PlaneFigure>} */
const PLANE_FIGURES = {
  rectangle: { rectangle: { size: [2, 2] } },
  circle: { circle: { radius: 1 } },
  triangle: { polygon: { rings: [[[-1, -0.75], [1, -0.75], [0, 1]]] } },
};

/** The figures that a document can have. @param {Document} d @returns {Record<string, Figure | PlaneFigure>} */
export const figuresOf = (d) => (!d.robot && d.plane ? PLANE_FIGURES : FIGURES);

/** A figure whose sizes are larger by a factor. @template {Figure | PlaneFigure} F @param {F} figure @param {number} factor @returns {F} */
export function enlarged(figure, factor) {
  const larger = (/** @type {string} */ _, /** @type {unknown} */ value) => (typeof value === "number" ? Number((value * factor).toPrecision(6)) : value);
  return JSON.parse(JSON.stringify(figure), larger);
}

/** The figure's name, or “mesh”. @param {DocumentShape} shape */
export const shapeKind = (shape) => Object.keys(shape)[0];

/** The sizes of a figure: name, value in metres, and the figure with another value. Meshes have none.
 * @param {DocumentShape} shape @returns {{name: string, value: number, set: (value: number) => DocumentShape}[]} */
export function sizesOf(shape) {
  if ("mesh" in shape || "given" in shape || "polygon" in shape) return [];
  if ("rectangle" in shape) {
    const [x, y] = shape.rectangle.size;
    /** @param {string} name @param {number} value @param {(v: number) => [number, number]} size */
    const made = (name, value, size) => ({ name, value, set: (/** @type {number} */ v) => ({ rectangle: { size: size(v) } }) });
    return [made("side x", x, (v) => [v, y]), made("side y", y, (v) => [x, v])];
  }
  if ("cube" in shape) {
    const { size } = shape.cube;
    const set = (/** @type {number} */ i) => (/** @type {number} */ v) => ({ cube: { size: /** @type {Three} */ (size.map((old, k) => (k === i ? v : old))) } });
    return ["x", "y", "z"].map((axis, i) => ({ name: `side ${axis}`, value: size[i], set: set(i) }));
  }
  const [[kind, sizes]] = Object.entries(/** @type {Record<string, Record<string, number>>} */ (shape));
  const named = (/** @type {string} */ size) => SIZE_NAMES[size] ?? size;
  return Object.entries(sizes).map(([size, value]) => ({ name: named(size), value, set: (v) => /** @type {Figure} */ ({ [kind]: { ...sizes, [size]: v } }) }));
}

/** The distance of the figure's farthest point from its origin, metres. @param {Figure | PlaneFigure} figure */
export function reachOf(figure) {
  if ("rectangle" in figure) return Math.hypot(...figure.rectangle.size) / 2;
  if ("circle" in figure) return figure.circle.radius;
  if ("polygon" in figure) return Math.max(...figure.polygon.rings.flat().map((p) => Math.hypot(...p)));
  if ("sphere" in figure) return figure.sphere.radius;
  if ("cube" in figure) return Math.hypot(...figure.cube.size) / 2;
  if ("torus" in figure) return figure.torus.ring + figure.torus.tube;
  if ("tetrahedron" in figure) return (figure.tetrahedron.edge * Math.sqrt(6)) / 4;
  const { radius, height } = "cone" in figure ? figure.cone : figure.cylinder;
  return Math.hypot(radius, height / 2);
}

/** @type {Record<string, string>} */
const SIZE_NAMES = { ring: "radius of the ring", tube: "radius of the tube" };

/** A new environment: a tetrahedron that has to cross a room. @returns {Environment} */
export const emptyDocument = () => ({
  version: 1,
  name: "environment",
  space: "SE3",
  bounds: null,
  robot: { name: "robot", color: null, shape: FIGURES.tetrahedron },
  start: [-6, 0, 0, 0, 0, 0],
  goal: [6, 0, 0, 0, 0, 0],
  obstacles: [],
});

/** An environment, which alone has the robot as a part. @param {Document} d */
function withRobot(d) {
  if (!d.robot) throw new Error("The robot of this problem is not edited here.");
  return d;
}

/** The body of a part: of start and goal the robot. @param {Document} d @param {Part} part @returns {DocumentBody} */
export const bodyOf = (d, part) => (typeof part === "number" ? d.obstacles[part] : withRobot(d).robot);

/** @param {Document} d @param {Part} part @returns {Six} */
export const poseOf = (d, part) => (typeof part === "number" ? d.obstacles[part].pose : withRobot(d)[part]);

/** @param {DocumentBody} body @returns {Three} */
export const scaleOf = (body) => body.scale ?? [1, 1, 1];

/** A name that no body has yet: with a number behind it where it must. @param {Document} d @param {string} wanted */
export function freeName(d, wanted) {
  const taken = new Set([d.robot?.name, ...d.obstacles.map((o) => o.name)]);
  if (!taken.has(wanted)) return wanted;
  const stem = wanted.replace(/ \d+$/, "");
  let number = 2;
  while (taken.has(`${stem} ${number}`)) number++;
  return `${stem} ${number}`;
}

/** Changes the body of a part. @param {Document} d @param {Part} part @param {Partial<Obstacle>} change @returns {Document} */
export function changeBody(d, part, change) {
  if (typeof part !== "number") return { ...withRobot(d), robot: { ...withRobot(d).robot, ...change } };
  return { ...d, obstacles: d.obstacles.map((o, i) => (i === part ? { ...o, ...change } : o)) };
}

/** Moves a part. In the plane z, β and γ of start and goal stay zero. @param {Document} d @param {Part} part @param {Six} pose
 * @returns {Document} */
export function movePart(d, part, pose) {
  if (typeof part === "number") return changeBody(d, part, { pose });
  const whole = withRobot(d);
  return { ...whole, [part]: whole.space === "SE2" ? flattened(pose) : pose };
}

/** @param {Document} d @param {Part} part @param {Three} scale @returns {Document} */
export const scalePart = (d, part, scale) => changeBody(d, part, { scale: scale.every((s) => s === 1) ? undefined : scale });

/** Adds an obstacle at the end. @param {Document} d @param {string} name @param {DocumentShape} shape @param {Six} pose @returns {Document} */
export const addObstacle = (d, name, shape, pose) => ({ ...d, obstacles: [...d.obstacles, { name: freeName(d, name), ...(d.robot && { color: null }), shape, pose }] });

/** Gives the robot another shape, in its own size. @param {Environment} d @param {string} name @param {DocumentShape} shape @returns {Environment} */
export const replaceRobot = (d, name, shape) => ({ ...d, robot: { name: freeName({ ...d, robot: { ...d.robot, name: "" } }, name), color: d.robot.color, shape } });

/** Deletes an obstacle. @param {Document} d @param {number} index @returns {Document} */
export const removeObstacle = (d, index) => ({ ...d, obstacles: d.obstacles.filter((_, i) => i !== index) });

/** Adds a copy at the end; of the robot it is an obstacle. @param {Document} d @param {Part} part @param {Three} shift metres @returns {Document} */
export function duplicate(d, part, shift) {
  const { name, color, shape, scale } = bodyOf(d, part);
  const [x, y, z, ...angles] = poseOf(d, part);
  /** @type {Six} */ const pose = [x + shift[0], y + shift[1], z + shift[2], ...angles];
  return { ...d, obstacles: [...d.obstacles, { name: freeName(d, name), ...(d.robot && { color }), shape, ...(scale && { scale }), pose }] };
}

/** Where start and goal may be; in the plane only with z = 0. @param {Environment} d @param {[Three, Three] | null} bounds @returns {Environment} */
export function setBounds(d, bounds) {
  if (!bounds || d.space === "SE3") return { ...d, bounds };
  const [[a, b], [c, e]] = bounds;
  return { ...d, bounds: [[a, b, 0], [c, e, 0]] };
}

/** In space, or in the plane z = 0. @param {Environment} d @param {"SE3" | "SE2"} space @returns {Environment} */
export function setSpace(d, space) {
  if (space === d.space) return d;
  if (space === "SE2") return setBounds({ ...d, space, start: flattened(d.start), goal: flattened(d.goal) }, d.bounds);
  if (!d.bounds) return { ...d, space };
  const [[a, b], [c, e]] = d.bounds;
  const half = Math.max(c - a, e - b) / 2;
  return { ...d, space, bounds: [[a, b, -half], [c, e, half]] };
}

/** @param {Six} pose @returns {Six} */
const flattened = ([x, y, , alpha]) => [x, y, 0, alpha, 0, 0];

/** The document and what can be undone and done again. */
export class History {
  /** @param {Document} document */
  constructor(document) {
    /** @type {{document: Document, label: string, merge: string}[]} the first is the oldest that is kept */
    this.steps = [{ document, label: "", merge: "" }];
    this.at = 0;
    /** @type {Document | null} */ this.saved = document;
  }
  get document() { return this.steps[this.at].document; }
  /** Whether something changed since it was opened or saved. */
  get dirty() { return this.document !== this.saved; }
  /** What an undo takes back, or null. */
  get undoLabel() { return this.at > 0 ? this.steps[this.at].label : null; }
  /** What a redo does, or null. */
  get redoLabel() { return this.steps[this.at + 1]?.label ?? null; }
  /** The document before the last command, or null. */
  get before() { return this.steps[this.at - 1]?.document ?? null; }
  /** The document that a redo gives, or null. */
  get after() { return this.steps[this.at + 1]?.document ?? null; }

  /** Takes the result of a command. Commands one after the other with the same `merge` are one step, as when a slider moves.
   * @param {Document} document @param {string} label @param {string} [merge] */
  commit(document, label, merge = "") {
    if (document === this.document) return;
    const last = this.steps[this.at];
    const joins = merge !== "" && last.merge === merge && this.at > 0 && last.document !== this.saved;
    this.steps.length = joins ? this.at : this.at + 1;
    this.steps.push({ document, label, merge });
    if (this.steps.length > KEPT) this.steps.shift();
    this.at = this.steps.length - 1;
  }
  undo() { if (this.at > 0) this.at--; }

  redo() { if (this.at + 1 < this.steps.length) this.at++; }

  /** @param {Document} document the one that was written */
  markSaved(document) { this.saved = document; }
}

/** How many steps are kept. */
const KEPT = 200;
