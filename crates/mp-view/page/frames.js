// The frames of the world, of obstacles and of the robot's bodies: x red, y green, z blue. A scene without obstacles has that of the world and a
// grid in the plane z = 0.

import { niceStep } from "mp/gizmo.js";
import { IDENTITY, place, scale } from "mp/math.js";
import { posesAt } from "mp/picture.js";

/** @import { LineSet } from "mp/buffers.js" */
/** @import { Palette } from "mp/colors.js" */
/** @import { Numbers, Vec3 } from "mp/math.js" */
/** @import { Settings } from "mp/picture.js" */
/** @import { Picture, Renderer } from "mp/renderer.js" */
/** @import { Scene } from "mp/scene.js" */
/** @import { Layer, Viewer } from "mp/viewer.js" */

/** @type {Vec3[]} */
const AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
/** @type {[number, number, number, number][]} */
const COLORS = [[0.85, 0.2, 0.2, 1], [0.15, 0.6, 0.25, 1], [0.2, 0.4, 0.9, 1]];
/** The length of an axis as a part of the scene's diagonal. */
const SIZE = 0.04;

/** The poses of the frames that are shown: of the world, the obstacles, and the robot as it is now.
 * @param {Scene} scene @param {Settings} s @returns {Numbers[]} */
function framesOf(scene, s) {
  const path = scene.paths[s.path];
  const now = path?.count ? posesAt(path, scene.robot, s.time, new Float32Array(7 * scene.robot)) : Float32Array.from(scene.start.poses);
  const robot = Array.from({ length: scene.robot }, (_, b) => now.subarray(7 * b, 7 * b + 7));
  const shown = (/** @type {number} */ b) => s.bodies[b]?.visible;
  const obstacles = scene.bodies.slice(scene.robot).filter((_, i) => shown(scene.robot + i)).map((body) => body.pose);
  return [IDENTITY, ...obstacles, ...robot.filter((_, b) => shown(b))];
}

/** About how many lines the grid has in each direction. */
const GRID = 20;

/** The lines of a grid in the plane z = 0, where the scene is: x y z of their ends. @param {Scene} scene */
function gridOf({ bounds: [low, high] }) {
  const step = niceStep(Math.max(high[0] - low[0], high[1] - low[1]) / GRID, 1);
  const [first, last] = [low.map((c) => Math.floor(c / step)), high.map((c) => Math.ceil(c / step))];
  const lines = [0, 1].flatMap((axis) => Array.from({ length: last[axis] - first[axis] + 1 }, (_, i) => [first, last].flatMap((end) => {
    const point = [end[0] * step, end[1] * step, 0];
    point[axis] = (first[axis] + i) * step;
    return point;
  })));
  return new Float32Array(lines.flat());
}

/** @implements {Layer} */
export class Frames {
  constructor(/** @type {Viewer} */ viewer) {
    this.viewer = viewer;
    /** @type {LineSet | null} */ this.set = null;
    /** @type {LineSet | null} */ this.grid = null;
  }
  start(/** @type {Renderer} */ renderer) {
    this.set = renderer.lineSet();
    this.grid = renderer.lineSet();
  }
  /** @param {Settings} s @param {Palette} colors @returns {Picture["lines"]} */
  lines(s, colors) {
    const { scene } = this.viewer;
    const empty = scene.bodies.length === scene.robot;
    if (!(s.frames || empty) || !this.set || !this.grid) return [];
    const size = SIZE * Math.hypot(...scene.bounds[0].map((low, k) => scene.bounds[1][k] - low));
    const axes = (s.frames ? framesOf(scene, s) : [IDENTITY]).flatMap((pose) => {
      /** @type {Vec3} */ const origin = [pose[0], pose[1], pose[2]];
      return AXES.flatMap((axis) => [...origin, ...place(pose, 0, /** @type {Vec3} */ (scale(axis, size)))]);
    });
    this.set.clear();
    this.set.append(new Float32Array(axes), (row) => COLORS[row % 3]);
    this.grid.clear();
    if (empty) this.grid.append(gridOf(scene), () => [1, 1, 1, 1]);
    return [
      { set: this.grid, count: this.grid.count, width: 1, color: colors.wire, alpha: 0.4, over: false },
      { set: this.set, count: this.set.count, width: 2.5, color: null, alpha: 1, over: true },
    ];
  }
}
