// Builds scenes: what is selected, the commands that change the document, undo and redo, and what the handles move.

import { ask, brief } from "mp/dom.js";
import * as doc from "mp/document.js";
import { changedPose, changedSix, fromAngles, niceStep, poseOfSix, tidy } from "mp/gizmo.js";
import { Handles } from "mp/handles.js";
import { mayDiscard, setUnsaved } from "mp/unsaved.js";

/** @import { Document, DocumentShape, Environment, Part, Six, Three } from "mp/document.js" */
/** @import { End, Verdict } from "mp/ends.js" */
/** @import { Change, HandleMode, Quaternion } from "mp/gizmo.js" */
/** @import { Target } from "mp/handles.js" */
/** @import { Role } from "mp/renderer.js" */
/** @import { Scene } from "mp/scene.js" */
/** @import { Workbench } from "mp/workbench.js" */
/** @typedef {{end: End} | {obstacle: number}} Selection  the robot at its start or at a goal, or an obstacle */

/** @type {[HandleMode, string][]} */
export const HANDLE_MODES = [["move", "Move"], ["turn", "Turn"], ["scale", "Scale"]];

/** @type {[string, string][]} */
export const HELP = [
  ["Click, [ and ]", "select a body; the one before, the one after"], ["H", "handles: move, turn or scale"],
  ["Drag a handle", "move, turn or scale; with Shift in steps; Esc gives it up"], ["Delete", "delete the selected obstacle"],
  ["Ctrl + D", "duplicate what is selected"], ["Ctrl + Z", "undo"], ["Ctrl + Shift + Z, Ctrl + Y", "redo"],
  ["Ctrl + O, Ctrl + S", "open files; save"],
];

/** Places of a grid in which a new body may lie, nearest first. */
const NEARBY = Array.from({ length: 41 * 41 }, (_, i) => [(i % 41) - 20, Math.floor(i / 41) - 20]).sort((a, b) => Math.hypot(...a) - Math.hypot(...b));

/** The kinds of ends that handles can move: six numbers, or x y and maybe an angle. @param {Scene} scene @returns {"rigid" | "planar" | null} */
function endKind({ columns, planar }) {
  const names = columns.map((c) => c.name).join(" ");
  if (names === "x y z alpha beta gamma") return "rigid";
  const angle = columns.length < 3 || (columns.length === 3 && columns[2].unit === "rad");
  return planar && /^x y( |$)/.test(names) && angle ? "planar" : null;
}

/** x y z α β γ of a configuration. @param {"rigid" | "planar"} kind @param {number[]} row @returns {Six} */
const sixOfRow = (kind, row) => /** @type {Six} */ (kind === "rigid" ? [...row] : [row[0], row[1], 0, row[2] ?? 0, 0, 0]);
/** @param {"rigid" | "planar"} kind @param {Six} six @param {number} columns */
const rowOfSix = (kind, six, columns) => (kind === "rigid" ? [...six] : [six[0], six[1], six[3]].slice(0, columns));

/** @param {readonly number[]} a @param {readonly number[]} b */
const same = (a, b) => a.every((x, i) => x === b[i]);

/** Whether two environments are the same but for start and goal. @param {Document} a @param {Document} b */
const sameBodies = (a, b) => a.robot && b.robot && a.name === b.name && a.space === b.space && a.bounds === b.bounds && a.robot === b.robot && a.obstacles === b.obstacles;

export class Editor {
  /** @param {Workbench} workbench */
  constructor(workbench) {
    this.workbench = workbench;
    this.viewer = workbench.viewer;
    this.ends = workbench.ends;
    /** @type {doc.History | null} */ this.history = null;
    /** The document as the session has it. @type {Document | null} */ this.sent = null;
    /** The document as it was opened. @type {Document | null} */ this.first = null;
    /** @type {Selection | null} */ this.selection = null;
    /** By which body an arm is dragged. */ this.held = 0;
    /** Called after anything changed here. @type {(() => void)[]} */ this.onchange = [];
    /** Commands wait for the ones before; how many there are. */ this.queue = Promise.resolve();
    this.waiting = 0;
    /** Whether the document moves the ends, and whether handles do. */ this.applying = this.byHandles = false;
    this.handles = new Handles(this.viewer.canvas, this.viewer.camera, () => this.viewer.changed());
    this.viewer.ondraw.push(() => this.handles.draw());
    this.viewer.onselect.push((body, role, index) => this.selectBody(body, role, index));
    this.viewer.keys.push((e) => this.key(e));
    workbench.onopened.push((_, how) => this.opened(how));
    workbench.onleft.push(() => this.opened("open"));
    this.ends.onchange.push((end, settled) => this.endChanged(end, settled));
    addEventListener("keydown", (e) => this.shortcut(e));
    if (workbench.open) this.opened("open");
  }
  get document() { return this.history?.document ?? null; }
  /** The document if it is an environment with its robot, or null. @returns {Environment | null} */
  get environment() { return this.document?.robot ? this.document : null; }

  /** @param {"open" | "edit"} how */
  opened(how) {
    // Later parts of a motion have no document.
    if (how === "open" || !this.workbench.document) {
      const document = /** @type {Document | null} */ (this.workbench.document);
      this.history = document ? new doc.History(document) : null;
      this.sent = this.first = document;
      this.selection = null;
    }
    this.held = this.workbench.links ? this.viewer.scene.robot - 1 : 0;
    // The planner may write the same pose in other angles.
    const { document } = this.workbench;
    if (document?.robot) this.moveEnds(/** @type {Environment} */ (document));
    this.refresh();
  }
  /** Shows what is selected again: in the handles and in the panel. */
  refresh() {
    if (!this.exists(this.selection)) this.selection = null;
    this.handles.setTarget(this.target());
    const s = this.selection;
    this.viewer.panels?.markBody(!s ? -1 : "obstacle" in s ? this.viewer.scene.robot + s.obstacle : this.held);
    if (this.history) setUnsaved(this.history.dirty);
    for (const listener of this.onchange) listener();
  }
  /** @param {Selection | null} s */
  exists(s) {
    if (!s) return true;
    return "obstacle" in s ? s.obstacle < (this.document?.obstacles.length ?? 0) : this.ends.at(s.end) !== null;
  }
  /** What was opened is a copy of changes that no file has. */
  changedSinceOpened() {
    if (this.history) this.history.saved = null;
    this.refresh();
  }
  /** Everything that can be selected, with its name. @returns {{name: string, selection: Selection}[]} */
  parts() {
    const { scene } = this.viewer;
    if (!this.workbench.open || !(this.document || this.workbench.links || endKind(scene))) return [];
    const goals = scene.goals.map((_, i) => ({ name: scene.goals.length > 1 ? `robot at goal ${i + 1}` : "robot at the goal", selection: { end: i } }));
    const obstacles = (this.document?.obstacles ?? []).map((o, i) => ({ name: o.name, selection: { obstacle: i } }));
    return [{ name: "robot at the start", selection: { end: /** @type {End} */ ("start") } }, ...goals, ...obstacles];
  }
  /** What the selection is in the document, or null. @returns {Part | null} */
  get part() {
    const s = this.selection;
    if (!s || !this.document) return null;
    if ("obstacle" in s) return s.obstacle;
    return !this.environment ? null : s.end === "start" ? "start" : "goal";
  }
  select(/** @type {Selection | null} */ selection) {
    this.selection = selection;
    this.refresh();
  }
  /** @param {number} body −1 for none @param {Role} role @param {number} index */
  selectBody(body, role, index) {
    if (body < 0) return this.select(null);
    const { robot } = this.viewer.scene;
    if (body >= robot) return this.select(this.document ? { obstacle: body - robot } : null);
    if (this.viewer.scene.bodies[body].role === "moving") return this.select(null);
    if (this.workbench.links) this.held = body;
    this.select(role === "goal" ? { end: index } : role === "start" ? { end: "start" } : null);
  }
  /** Selects the next or the previous part. @param {number} step */
  selectNext(step) {
    const parts = this.parts();
    if (!parts.length) return;
    const now = parts.findIndex(({ selection }) => JSON.stringify(selection) === JSON.stringify(this.selection));
    this.select(parts[(now + step + (now < 0 && step < 0 ? 1 : 0) + parts.length) % parts.length].selection);
  }

  /** Does a command, after those that are under way. @param {string} label @param {(document: Document) => Document} command
   * @param {string} [merge] commands with the same are one step of the history, one after the other */
  run(label, command, merge = "") {
    const { history } = this;
    return this.later(async () => {
      // Another scene may have been opened in the meantime.
      if (!history || history !== this.history) return;
      const next = command(history.document);
      if (await this.apply(next)) history.commit(next, label, merge);
    });
  }
  undo() { return this.later(async () => { if (this.history?.before && (await this.apply(this.history.before))) this.history.undo(); }); }

  redo() { return this.later(async () => { if (this.history?.after && (await this.apply(this.history.after))) this.history.redo(); }); }

  /** @param {() => Promise<void>} task */
  later(task) {
    const busy = (/** @type {number} */ more) => this.viewer.canvas.parentElement?.setAttribute("aria-busy", String((this.waiting += more) > 0));
    busy(1);
    this.queue = this.queue.then(() => this.workbench.opening).then(() => this.workbench.attempt(task)).then(() => {
      busy(-1);
      this.restore();
    });
    return this.queue;
  }
  /** Makes the session and the page have this document. @param {Document} next @returns {Promise<boolean>} */
  async apply(next) {
    if (next === this.document) return false;
    if (next.robot && this.sent && sameBodies(next, this.sent)) {
      this.moveEnds(next);
      return true;
    }
    const { bodies, planar } = this.viewer.scene;
    const shown = new Map(bodies.map((body, b) => [body.name, this.viewer.settings.bodies[b]]));
    if (!(await this.workbench.edit(next))) return false;
    this.viewer.scene.bodies.forEach((body, b) => Object.assign(this.viewer.settings.bodies[b], shown.get(body.name)));
    this.viewer.panels?.showBodies();
    if (this.viewer.scene.planar !== planar) this.viewer.lookAsUsual();
    this.sent = next;
    return true;
  }
  /** Start and goal are moved without a message: the planner takes them with each run. @param {Environment} next */
  moveEnds(next) {
    this.applying = true;
    for (const [end, six] of /** @type {[End, Six][]} */ ([["start", next.start], [0, next.goal]])) {
      if (!same(this.ends.at(end)?.row ?? [], six)) this.ends.set(end, six, { poses: poseOfSix(six) });
    }
    this.applying = false;
  }
  /** Puts what was dragged where the document has it, and shows everything again. */
  restore() {
    const { scene } = this.viewer;
    this.document?.obstacles.forEach((o, i) => {
      const body = scene.bodies[scene.robot + i];
      if (body) body.pose = poseOfSix(o.pose);
    });
    for (const body of scene.bodies) body.stretch = [1, 1, 1];
    this.refresh();
    this.viewer.changed();
  }
  /** An end was moved, by handles or by the panel of start and goal: the document follows. @param {End} end @param {boolean} settled */
  endChanged(end, settled) {
    const { history, environment } = this;
    const row = this.ends.at(end)?.row;
    // A verdict may come while handles still drag.
    if (!settled || !row || this.handles.active) return;
    if (history && environment && !this.applying && (end === "start" || end === 0)) {
      const name = end === "start" ? "start" : "goal";
      if (!same(environment[name], row)) {
        history.commit(doc.movePart(environment, name, /** @type {Six} */ ([...row])), `move the ${name}`, this.byHandles ? "" : name);
        this.refresh();
      }
      // Without bounds of its own the room is around all bodies: it grows with them.
      const outside = this.ends.verdicts.get(end)?.in_bounds === false;
      if (outside && !environment.bounds && !this.growing) this.growRoom();
    } else if (this.selection && "end" in this.selection && this.selection.end === end) this.handles.setTarget(this.target());
  }
  growRoom() {
    this.growing = true;
    return this.later(async () => {
      const { document } = this;
      if (document && this.sent !== document && (await this.workbench.edit(document))) this.sent = document;
    }).finally(() => (this.growing = false));
  }

  /** What the handles move. @returns {Target | null} */
  target() {
    const s = this.selection;
    if (!s || !this.workbench.open) return null;
    return "obstacle" in s ? this.obstacleTarget(s.obstacle) : this.endTarget(s.end);
  }
  /** @param {number} index @returns {Target | null} */
  obstacleTarget(index) {
    const { scene } = this.viewer;
    const body = scene.bodies[scene.robot + index];
    const obstacle = this.document?.obstacles[index];
    if (!obstacle || !body) return null;
    const { pose, name } = obstacle;
    return {
      frame: frameOf(pose),
      modes: ["move", "turn", "scale"],
      planar: scene.planar,
      preview: (change) => {
        body.pose = poseOfSix(changedSix(pose, change));
        body.stretch = change.factor;
        this.preview(changedSix(pose, change), scaled(doc.scaleOf(obstacle), change));
      },
      done: (change) => {
        if (!change) return this.restore();
        const label = changeLabel(change, name);
        this.run(label, (d) => changePart(d, index, changedSix(pose, change), scaled(doc.scaleOf(obstacle), change)));
      },
    };
  }
  /** @param {End} end @returns {Target | null} */
  endTarget(end) {
    const { scene } = this.viewer;
    const kind = endKind(scene);
    const first = this.ends.at(end);
    if (this.workbench.links) return this.linkTarget(end);
    if (!kind || !first) return null;
    const six = sixOfRow(kind, first.row);
    const document = this.environment;
    /** @type {HandleMode[]} */ const modes = scene.columns.length > 2 ? ["move", "turn"] : ["move"];
    if (document) modes.push("scale");
    const frame = frameOf(six);
    let words = "";
    /** @param {Change} change @param {boolean} settled */
    const set = (change, settled) => {
      const poses = Array.from({ length: scene.robot }, (_, b) => changedPose(first.poses, 7 * b, frame.origin, change)).flat();
      this.byHandles = true;
      this.ends.set(end, rowOfSix(kind, changedSix(six, change), scene.columns.length), { settled, poses });
      this.byHandles = false;
    };
    return {
      frame,
      modes,
      planar: scene.planar,
      words: () => (words = verdictWords(this.ends.verdicts.get(end)) || words),
      preview: (change) => {
        if (isScaling(change)) scene.bodies.slice(0, scene.robot).forEach((body) => (body.stretch = change.factor));
        else set(change, false);
        this.preview(changedSix(six, change), document ? scaled(doc.scaleOf(document.robot), change) : null);
      },
      done: (change) => {
        if (change && document && isScaling(change)) {
          this.run("scale the robot", (d) => doc.scalePart(d, "start", scaled(doc.scaleOf(document.robot), change)));
        } else if (change) {
          set(change, true);
          this.restore();
        } else {
          this.ends.set(end, first.row, { poses: first.poses });
          this.restore();
        }
      },
    };
  }
  /** An arm is dragged by one of its bodies. @param {End} end @returns {Target | null} */
  linkTarget(end) {
    const first = this.ends.at(end);
    const pose = first?.poses.slice(7 * this.held, 7 * this.held + 7);
    if (!first || pose?.length !== 7) return null;
    const frame = { origin: /** @type {Three} */ (pose.slice(0, 3)), turn: /** @type {Quaternion} */ (pose.slice(3)) };
    const reach = (/** @type {Change} */ change) => this.workbench.attempt(() => this.ends.reach(end, this.held, changedPose(pose, 0, frame.origin, change)));
    let words = "";
    return {
      frame,
      modes: ["move", "turn"],
      planar: false,
      words: () => (words = verdictWords(this.ends.verdicts.get(end)) || words),
      preview: reach,
      done: async (change) => {
        if (change) await reach(change);
        await this.ends.reached(end, change ? null : first);
      },
    };
  }
  /** Shows the numbers of a drag. @param {Six} pose @param {Three | null} scale */
  preview(pose, scale) { for (const listener of this.onpreview) listener(pose, scale); }

  /** Called while handles are dragged. @type {((pose: Six, scale: Three | null) => void)[]} */ onpreview = [];

  /** Asks about unsaved changes, and begins a new environment. */
  async create() {
    if (!(await mayDiscard())) return;
    const document = doc.emptyDocument();
    await this.workbench.replace(async () => this.workbench.take({ document, ...(await this.workbench.session.request({ do: "edit", document })) }, "open"));
  }
  /** Adds a figure or a mesh, near to where the camera looks, and selects it. @param {string} name @param {DocumentShape} shape
   * @param {"obstacle" | "robot"} as @param {number} reach of the shape around its origin, metres */
  add(name, shape, as, reach) {
    if (as === "robot") return this.run(`make ${name} the robot`, (d) => (d.robot ? doc.replaceRobot(d, name, shape) : d)).then(() => this.select({ end: "start" }));
    const count = this.document?.obstacles.length ?? 0;
    return this.run(`add ${name}`, (d) => doc.addObstacle(d, name, shape, this.freePlace(d, reach))).then(() => this.selectNew(count));
  }
  /** A place near the middle of the picture, where the robot may be, that is clear of all bodies. @param {Document} d @param {number} reach @returns {Six} */
  freePlace(d, reach) {
    const { shapes, ofBody, scene, camera } = this.viewer;
    const step = niceStep(Math.max(reach, camera.pixel()), 0.5);
    const plane = d.robot ? d.space === "SE2" : d.plane;
    // The limits of a robot of links are not of places.
    const limits = d.robot ? scene.limits : d.plane ? scene.limits.slice(0, 2) : [0, 1, 2].map((k) => [scene.bounds[0][k], scene.bounds[1][k]]);
    const within = (/** @type {number} */ c, /** @type {number} */ k) => Math.max(limits[k]?.[0] ?? -Infinity, Math.min(limits[k]?.[1] ?? Infinity, c));
    const [x, y, z] = camera.target.map((c, k) => tidy(Math.round(within(c, k) / step) * step));
    const height = plane ? 0 : z;
    const reachOf = (/** @type {number} */ body) => {
      const { low, high } = shapes[ofBody[body]];
      return Math.hypot(...[0, 1, 2].map((k) => Math.max(-low[k], high[k])));
    };
    const ends = [scene.start, ...scene.goals].flatMap(({ poses }) => Array.from({ length: scene.robot }, (_, b) => ({ pose: poses.slice(7 * b, 7 * b + 3), reach: reachOf(b) })));
    const taken = [...ends, ...d.obstacles.map((o, i) => ({ pose: /** @type {number[]} */ (o.pose), reach: reachOf(scene.robot + i) }))];
    const inside = (/** @type {Six} */ place) => [0, 1, 2].every((k) => within(place[k], k) === place[k]);
    const clear = (/** @type {Six} */ place, among = taken) => inside(place) && among.every((o) => Math.hypot(...[0, 1, 2].map((k) => o.pose[k] - place[k])) > o.reach + reach);
    const places = NEARBY.map(([i, j]) => /** @type {Six} */ ([tidy(x + i * step), tidy(y + j * step), height, 0, 0, 0]));
    // A room is around all places in it: then only start and goal are kept free.
    return places.find((place) => clear(place)) ?? places.find((place) => clear(place, ends)) ?? places[0];
  }
  /** Selects the obstacle that was added. @param {number} count how many there were */
  selectNew(count) {
    const now = this.document?.obstacles.length ?? 0;
    if (now > count) this.select({ obstacle: now - 1 });
  }
  duplicate() {
    const { part, document } = this;
    if (part === null || !document) return;
    const shift = niceStep(this.viewer.camera.pixel(), 60);
    const count = document.obstacles.length;
    return this.run(`duplicate ${doc.bodyOf(document, part).name}`, (d) => doc.duplicate(d, part, [shift, shift, 0])).then(() => this.selectNew(count));
  }
  remove() {
    const { part, document } = this;
    if (typeof part !== "number" || !document) return;
    return this.run(`delete ${document.obstacles[part].name}`, (d) => doc.removeObstacle(d, part));
  }

  /** Keys without Ctrl. @param {KeyboardEvent} e @returns {boolean} whether it was used */
  key(e) {
    if (e.key === "[" || e.key === "]") this.selectNext(e.key === "]" ? 1 : -1);
    else if (e.key === "h" && this.handles.target) {
      const { modes } = this.handles.target;
      this.setMode(modes[(modes.indexOf(this.handles.shownMode) + 1) % modes.length]);
    } else if ((e.key === "Delete" || e.key === "Backspace") && typeof this.part === "number") this.remove();
    else {
      if (e.key === "Escape" && this.selection) this.select(null);
      return false;
    }
    return true;
  }
  /** @param {HandleMode} mode */
  setMode(mode) {
    this.handles.setMode(mode);
    this.refresh();
  }
  /** Keys with Ctrl. @param {KeyboardEvent} e */
  shortcut(e) {
    if (!(e.ctrlKey || e.metaKey) || e.altKey || document.querySelector("dialog[open]") || !this.history) return;
    const key = e.key.toLowerCase();
    // In a field that is being typed in, the keys are the field's.
    if (e.target instanceof HTMLInputElement && /^(text|number|search)$/.test(e.target.type) && e.target.value !== e.target.defaultValue) return;
    if (key === "z" && !e.shiftKey) this.undo();
    else if (key === "y" || key === "z") this.redo();
    else if (key === "d") this.duplicate();
    else return;
    e.preventDefault();
  }
}

/** What the planner says of a configuration, in short. @param {Verdict | undefined} verdict */
function verdictWords(verdict) {
  if (!verdict) return "";
  if (verdict.touching.length) return `touches ${verdict.touching.join(", ")}`;
  if (!verdict.in_bounds) return "out of bounds";
  if (!verdict.free) return verdict.fault ?? "not free";
  return verdict.clearance === null ? "free" : `clearance ${brief(verdict.clearance)} m`;
}

/** @param {Six} six */
const frameOf = (six) => ({ origin: /** @type {Three} */ (six.slice(0, 3)), turn: fromAngles(six[3], six[4], six[5]) });

/** @param {Change} change */
const isScaling = ({ factor }) => !same(factor, [1, 1, 1]);

/** @param {Three} scale @param {Change} change @returns {Three} */
const scaled = (scale, { factor }) => [tidy(scale[0] * factor[0]), tidy(scale[1] * factor[1]), tidy(scale[2] * factor[2])];

/** @param {Document} d @param {number} index @param {Six} pose @param {Three} scale */
const changePart = (d, index, pose, scale) => doc.scalePart(doc.movePart(d, index, pose), index, scale);

/** @param {Change} change @param {string} name */
const changeLabel = (change, name) => `${isScaling(change) ? "scale" : same(change.turn, [0, 0, 0, 1]) ? "move" : "turn"} ${name}`;

/** Asks what to do with a mesh. @param {string} name @returns {Promise<"obstacle" | "robot">} */
export const askRole = async (name) => ((await ask(`What is the mesh “${name}”?`, "The robot", "An obstacle")) ? "robot" : "obstacle");
