// Says what is drawn: the bodies, copies, trees and traces that the settings ask for.

import { componentColor, obstacleColor, palette } from "mp/colors.js";
import { GrowingTree } from "mp/growing.js";
import { lerpPose } from "mp/math.js";
import { KIND_SIZES } from "mp/picking.js";
import { segmentsOf } from "mp/shapes.js";

/** @import { Color, Palette } from "mp/colors.js" */
/** @import { Numbers, Vec3 } from "mp/math.js" */
/** @import { Item, Mode, Picture, Renderer, Role } from "mp/renderer.js" */
/** @import { Path, Scene, Tree } from "mp/scene.js" */
/** @import { Layer } from "mp/viewer.js" */
/** @typedef {"all" | "step" | "auto"} Animation the three ways to show a path */
/** @typedef {{mode: Mode, bodies: {visible: boolean, mode: Mode | ""}[], edges: boolean, path: number, animation: Animation,
 *  time: number, other: number, copies: number, copyMode: Mode, start: boolean, goals: boolean, trace: boolean, frames: boolean, trees: boolean[],
 *  roadmap: boolean, growth: number, section: {axis: number, at: number, flipped: boolean}, dark: boolean,
 *  marked: Vec3 | null}} Settings
 *  `other` is a second path to compare with, or −1; `time` counts configurations of the path; `growth` and the section's `at` are between 0 and 1. */

/** The share of light that transparent things keep. */
const ALPHA = 0.3;
/** What is seen where two things are at the same place. @type {Record<Role, number>} */
const LAYERS = { obstacle: 0, goal: 1, start: 2, copy: 3, compared: 4, robot: 4 };

/** The configurations of a path that are shown as copies: evenly spaced, first and last always.
 * @param {number} count @param {number} copies @returns {number[]} */
export function copyIndices(count, copies) {
  const shown = Math.min(count, Math.max(2, copies));
  if (count < 2) return count ? [0] : [];
  return Array.from({ length: shown }, (_, i) => Math.round((i * (count - 1)) / (shown - 1)));
}

/** The poses of the robot's bodies at a time of a path. @param {Path} path @param {number} robot @param {number} time
 * @param {Float32Array} out @returns {Float32Array} */
export function posesAt(path, robot, time, out) {
  const i = Math.min(Math.floor(time), path.count - 1);
  const next = Math.min(i + 1, path.count - 1);
  for (let b = 0; b < robot; b++) lerpPose(path.poses, 7 * (i * robot + b), path.poses, 7 * (next * robot + b), time - i, out, 7 * b);
  return out;
}

/** The colour of a tree: blue when it grows from the start, red from a goal. @param {string} name @param {number} i @param {Palette} p @returns {Color} */
export function treeColor(name, i, p) {
  if (/goal/i.test(name)) return p.fromGoal;
  if (/start/i.test(name) || i === 0) return p.fromStart;
  return i === 1 ? p.fromGoal : p.other;
}

/** Makes pictures of a scene with a renderer, which holds its lines and points. */
export class PictureMaker {
  /** @param {Scene} scene @param {number[]} ofBody the shape of each body @param {Renderer} renderer @param {Layer[]} layers */
  constructor(scene, ofBody, renderer, layers) {
    this.scene = scene; this.ofBody = ofBody; this.renderer = renderer; this.layers = layers;
    this.robotPoses = new Float32Array(7 * scene.robot);
    this.otherPoses = new Float32Array(7 * scene.robot);
    this.trees = scene.trees.map((tree) => this.treeLines(tree));
    this.traces = scene.paths.map((path) => this.traceLines(path));
    this.roadmap = scene.roadmap ? this.roadmapLines() : null;
    this.marker = renderer.pointSet();
  }
  treeLines(/** @type {Tree} */ { name, nodes, parents, bends }) {
    const tree = new GrowingTree(this.renderer, name);
    tree.append(nodes, parents, bends);
    return tree;
  }
  addPath(/** @type {Path} */ path) { this.traces.push(this.traceLines(path)); }

  /** Another path takes the place of one. @param {number} i @param {Path} path */
  setPath(i, path) {
    this.traces[i].free();
    this.traces[i] = this.traceLines(path);
  }
  /** Frees the memory on the graphics card. */
  free() {
    for (const set of [...this.trees, ...this.traces, this.marker]) set.free();
    this.roadmap?.lines.free();
    this.roadmap?.points.free();
  }
  traceLines(/** @type {Path} */ path) {
    const lines = this.renderer.lineSet();
    lines.append(segmentsOf([path.trace]), () => [1, 1, 1, 1]);
    return lines;
  }
  roadmapLines() {
    const { nodes, edges, component, kind } = /** @type {NonNullable<Scene["roadmap"]>} */ (this.scene.roadmap);
    const segments = new Float32Array(3 * edges.length);
    edges.forEach((node, i) => segments.set(nodes.subarray(3 * node, 3 * node + 3), 3 * i));
    // The colour of a component is that of its first milestone, as while a roadmap grows.
    /** @type {Map<number, number>} */ const first = new Map();
    component.forEach((c, i) => { if (!first.has(c)) first.set(c, i); });
    const color = (/** @type {number} */ i) => componentColor(first.get(component[i]) ?? 0);
    const lines = this.renderer.lineSet();
    lines.append(segments, (i) => [...color(edges[2 * i]), 1]);
    const points = this.renderer.pointSet();
    points.append(nodes, (i) => [...color(i), KIND_SIZES[Math.min(kind[i], 3)]]);
    return { lines, points };
  }
  /** @param {Settings} s @returns {Picture} */
  make(s) {
    const colors = palette(s.dark);
    const items = [...this.obstacles(s, colors), ...this.ends(s, colors), ...this.moving(s, colors)];
    const lines = this.lines(s, colors);
    const points = this.points(s, colors);
    /** @type {Picture["images"]} */ const images = [];
    for (const layer of this.layers) {
      images.push(...(layer.images?.(s, colors) ?? []));
      items.push(...(layer.items?.(s, colors) ?? []));
      lines.push(...(layer.lines?.(s, colors) ?? []));
      points.push(...(layer.points?.(s, colors) ?? []));
    }
    return { items, images, lines, points, plane: this.plane(s), edges: s.edges, flat: this.scene.planar };
  }
  /** @param {number} body */
  linesOnly(body) { return this.scene.bodies[body].mesh < 0 && this.scene.bodies[body].area < 0; }
  /** @param {Settings} s @param {number} body */
  modeOf(s, body) { return s.bodies[body].mode || s.mode; }
  /** @param {Settings} s @param {Palette} colors @returns {Item[]} */
  obstacles(s, colors) {
    /** @type {Item[]} */ const items = [];
    for (let b = this.scene.robot; b < this.scene.bodies.length; b++) {
      if (!s.bodies[b].visible) continue;
      const mode = this.modeOf(s, b);
      const alpha = mode === "transparent" ? ALPHA : 1;
      const { pose, stretch, color: own } = this.scene.bodies[b];
      const usual = this.scene.planar ? colors.obstacle : obstacleColor(b - this.scene.robot);
      const color = own ?? (mode === "wire" || this.linesOnly(b) ? colors.wire : usual);
      items.push({ shape: this.ofBody[b], pose, at: 0, color, alpha, mode, cut: s.section.axis >= 0, layer: 0, stretch, body: b, role: "obstacle", index: 0 });
    }
    return items.sort((a, b) => a.shape - b.shape);
  }
  /** The robot in one configuration. @param {Settings} s @param {Numbers} poses @param {number} at @param {Color} color
   * @param {Role} role @param {number} index @param {Mode} [given] @returns {Item[]} */
  robot(s, poses, at, color, role, index, given) {
    /** @type {Item[]} */ const items = [];
    for (let b = 0; b < this.scene.robot; b++) {
      if (!s.bodies[b].visible) continue;
      const mode = given ?? this.modeOf(s, b);
      const alpha = mode === "transparent" ? ALPHA : 1;
      const { stretch, color: own, role: part } = this.scene.bodies[b];
      // What moves by itself is drawn where it is now: on the path that is shown, or at the start.
      if (part === "moving" && (role === "goal" || (role === "start" && this.scene.paths[s.path]?.count))) continue;
      const shown = part === "robot" && (role === "start" || role === "goal") ? color : (own ?? color);
      items.push({ shape: this.ofBody[b], pose: poses, at: at + 7 * b, color: shown, alpha, mode, cut: false, layer: LAYERS[role], stretch, body: b, role, index });
    }
    return items;
  }
  /** Start and goals. @param {Settings} s @param {Palette} colors @returns {Item[]} */
  ends(s, colors) {
    const start = s.start ? this.robot(s, this.scene.start.poses, 0, this.scene.start.refused ? colors.refused : colors.start, "start", 0) : [];
    const goals = s.goals ? this.scene.goals.flatMap((g, i) => this.robot(s, g.poses, 0, g.refused ? colors.refused : colors.goal, "goal", i)) : [];
    return [...goals, ...start];
  }
  /** The robot on its path, and its copies. @param {Settings} s @param {Palette} colors @returns {Item[]} */
  moving(s, colors) {
    const path = this.scene.paths[s.path];
    if (!path?.count) return [];
    const now = this.robot(s, posesAt(path, this.scene.robot, s.time, this.robotPoses), 0, colors.robot, "robot", Math.round(s.time));
    const other = this.scene.paths[s.other];
    if (other?.count) {
      // The second robot is at the same share of its own path.
      const time = (s.time / Math.max(1, path.count - 1)) * (other.count - 1);
      now.push(...this.robot(s, posesAt(other, this.scene.robot, time, this.otherPoses), 0, colors.compared, "compared", Math.round(time)));
    }
    if (s.animation !== "all") return now;
    // Start and goal stand at the ends already.
    const copies = copyIndices(path.count, s.copies).filter((i) => !(i === 0 && s.start) && !(i === path.count - 1 && s.goals));
    const poses = copies.flatMap((i) => this.robot(s, path.poses, 7 * this.scene.robot * i, colors.robot, "copy", i, s.copyMode));
    return [...poses.sort((a, b) => a.shape - b.shape), ...now];
  }
  /** @param {Settings} s @param {Palette} colors @returns {Picture["lines"]} */
  lines(s, colors) {
    const trees = this.trees.flatMap((tree, i) =>
      s.trees[i] ? tree.drawn(s.growth).map((part) => ({ ...part, width: 1, color: treeColor(tree.name, i, colors), alpha: 0.6, over: false })) : []);
    const roadmap = this.roadmap && s.roadmap ? [{ set: this.roadmap.lines, count: this.roadmap.lines.count, width: 1, color: null, alpha: 1, over: false }] : [];
    const traces = this.traces.flatMap((set, i) => {
      const chosen = i === s.path || i === s.other;
      // Of runs only the chosen paths are drawn.
      if (!s.trace || (this.scene.paths[i].ofRun && !chosen)) return [];
      const color = i === s.path ? colors.path : i === s.other ? colors.compared : colors.other;
      return [{ set, count: set.count, width: chosen ? 3 : 1, color, alpha: 1, over: true }];
    });
    return [...roadmap, ...trees, ...traces];
  }
  /** @param {Settings} s @param {Palette} colors @returns {Picture["points"]} */
  points(s, colors) {
    const marks = this.trees.flatMap(({ name, roots }, i) => (s.trees[i] && roots ? [{ set: roots, count: roots.count, color: treeColor(name, i, colors), over: false }] : []));
    const roadmap = this.roadmap && s.roadmap ? [{ set: this.roadmap.points, count: this.roadmap.points.count, color: null, over: false }] : [];
    this.marker.clear();
    if (s.marked) this.marker.append(new Float32Array(s.marked), () => [1, 1, 1, 1]);
    return [...roadmap, ...marks, { set: this.marker, count: this.marker.count, color: colors.picked, over: true }];
  }
  /** The section plane: what lies on its positive side is cut away. @param {Settings} s @returns {Picture["plane"]} */
  plane(s) {
    const { axis, at, flipped } = s.section;
    if (axis < 0) return null;
    const [low, high] = this.scene.bounds;
    const sign = flipped ? -1 : 1;
    const where = low[axis] + (high[axis] - low[axis]) * at;
    /** @type {[number, number, number, number]} */ const plane = [0, 0, 0, sign * where];
    plane[axis] = sign;
    return plane;
  }
}
