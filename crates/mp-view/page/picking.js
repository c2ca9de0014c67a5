// What is under a pixel: a body, a configuration of the path, or a node of a tree or of the roadmap.

import { brief, coordinate } from "mp/dom.js";
import { add, dot, place, pointAt, scale, sub, unplace, unrotate } from "mp/math.js";

/** @import { Camera, Ray } from "mp/camera.js" */
/** @import { Mat4, Vec3 } from "mp/math.js" */
/** @import { Settings } from "mp/picture.js" */
/** @import { Item, Picture } from "mp/renderer.js" */
/** @import { Scene, Tree } from "mp/scene.js" */
/** @import { Shape } from "mp/shapes.js" */
/** @import { Layer } from "mp/viewer.js" */
/** @typedef {{title: string, facts: [string, string][], point: Vec3, time: number | null, marked: boolean, item?: Item}} Picked
 *  `time` is set for a configuration of the path; `item` for a body. */
/** @typedef {{points: Float32Array, count: number, describe: (i: number) => Omit<Picked, "point">}} Cloud points to click on */

/** The kinds of milestones, by the numbers of docs/formats/viewer.md. */
export const KIND_NAMES = ["sampled", "guard", "connection", "other"];
/** How large milestones of each kind are drawn, as parts of 16 pixels. */
export const KIND_SIZES = [0.3, 0.65, 0.4, 0.3];

/** How near to a point or line a click must be, pixels. */
const NEAR = 8;

/** Whether the ray meets a box. @param {Ray} ray @param {number[]} low @param {number[]} high */
function meetsBox(ray, low, high) {
  let [enter, leave] = [0, Infinity];
  for (let k = 0; k < 3; k++) {
    const d = ray.direction[k] || 1e-300;
    const [s, t] = [(low[k] - ray.origin[k]) / d, (high[k] - ray.origin[k]) / d];
    enter = Math.max(enter, Math.min(s, t));
    leave = Math.min(leave, Math.max(s, t));
  }
  return enter <= leave;
}

/** The nearest hit of the ray with a copy of a shape. @param {Ray} ray @param {Item} item @param {Shape} shape
 * @param {(t: number) => boolean} kept whether the section leaves this place */
function meetItem(ray, item, shape, kept) {
  const local = { origin: unplace(item.pose, item.at, ray.origin), direction: unrotate(item.pose, item.at, ray.direction) };
  if (!shape.triangles.length || !meetsBox(local, shape.low, shape.high)) return Infinity;
  let best = Infinity;
  const { positions: p, triangles } = shape;
  const [[ox, oy, oz], [dx, dy, dz]] = [local.origin, local.direction];
  // As Möller and Trumbore, with plain numbers: there may be millions of triangles.
  for (let i = 0; i < triangles.length; i += 3) {
    const a = 3 * triangles[i];
    const b = 3 * triangles[i + 1];
    const c = 3 * triangles[i + 2];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const px = dy * vz - dz * vy, py = dz * vx - dx * vz, pz = dx * vy - dy * vx;
    const det = ux * px + uy * py + uz * pz;
    if (Math.abs(det) < 1e-30) continue;
    const sx = ox - p[a], sy = oy - p[a + 1], sz = oz - p[a + 2];
    const x = (sx * px + sy * py + sz * pz) / det;
    if (x < 0 || x > 1) continue;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
    const y = (dx * qx + dy * qy + dz * qz) / det;
    if (y < 0 || x + y > 1) continue;
    const t = (vx * qx + vy * qy + vz * qz) / det;
    if (t > 0 && t < best && (!item.cut || kept(t))) best = t;
  }
  return best;
}

/** How far a pixel is from a segment on the screen. @param {[number, number]} p @param {[number, number]} a @param {[number, number]} b */
function pixelsTo(p, a, b) {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const t = Math.max(0, Math.min(1, ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy);
}

export class Picker {
  /** @param {Scene} scene @param {Shape[]} shapes @param {Camera} camera @param {Layer[]} layers */
  constructor(scene, shapes, camera, layers) {
    this.scene = scene; this.shapes = shapes; this.camera = camera; this.layers = layers;
  }
  /** @param {number} x @param {number} y pixels @param {Picture} picture @param {Settings} settings @returns {Picked | null} */
  pick(x, y, picture, settings) {
    const ray = this.camera.ray(x, y);
    const surface = this.surface(ray, [x, y], picture);
    const limit = surface && surface.item.mode === "solid" && !picture.flat ? surface.t + this.camera.radius * 0.01 : Infinity;
    const point = this.point(ray, x, y, settings, limit);
    if (point) return point;
    return surface ? this.describeItem(surface.item, add(ray.origin, scale(ray.direction, surface.t)), settings) : null;
  }
  /** The nearest body. @param {Ray} ray @param {[number, number]} pixel @param {Picture} picture */
  surface(ray, pixel, picture) {
    const { plane, flat } = picture;
    /** @param {number} t */
    const kept = (t) => !plane || dot([plane[0], plane[1], plane[2]], add(ray.origin, scale(ray.direction, t))) <= plane[3];
    const { both } = this.camera.matrices();
    /** @type {{t: number, item: Item} | null} */ let best = null;
    for (const item of picture.items) {
      const shape = this.shapes[item.shape];
      const t = Math.min(meetItem(ray, item, shape, kept), this.meetLines(ray, pixel, item, shape, both));
      if (!Number.isFinite(t)) continue;
      const above = best && (flat || Math.abs(t - best.t) < 1e-5 * t) ? item.layer >= best.item.layer : !best || t < best.t;
      if (above) best = { t, item };
    }
    return best;
  }
  /** @param {Ray} ray @param {[number, number]} pixel @param {Item} item @param {Shape} shape @param {Mat4} both */
  meetLines(ray, pixel, item, shape, both) {
    let best = Infinity;
    for (let i = 0; i < shape.segments.length / 3; i += 2) {
      const a = place(item.pose, item.at, pointAt(shape.segments, i));
      const [p, q] = [a, place(item.pose, item.at, pointAt(shape.segments, i + 1))].map((c) => this.camera.project(both, c));
      if (p && q && pixelsTo(pixel, p, q) < NEAR) best = Math.min(best, dot(sub(a, ray.origin), ray.direction));
    }
    return best;
  }
  /** The point nearest to the pixel that no surface hides. @param {Ray} ray @param {number} x @param {number} y
   * @param {Settings} settings @param {number} limit @returns {Picked | null} */
  point(ray, x, y, settings, limit) {
    const { both } = this.camera.matrices();
    let near = NEAR;
    /** @type {Picked | null} */ let best = null;
    for (const { points, count, describe } of this.clouds(settings)) {
      for (let i = 0; i < count; i++) {
        const point = pointAt(points, i);
        const at = this.camera.project(both, point);
        if (!at || Math.abs(at[0] - x) > near) continue;
        const away = Math.hypot(at[0] - x, at[1] - y);
        if (away >= near || dot(sub(point, ray.origin), ray.direction) > limit) continue;
        near = away;
        best = { point, ...describe(i) };
      }
    }
    return best;
  }
  /** All points that can be clicked. @param {Settings} s @returns {Cloud[]} */
  clouds(s) {
    const { paths, trees, roadmap } = this.scene;
    const path = paths[s.path];
    /** @type {Cloud[]} */ const clouds = [];
    if (path && s.trace) clouds.push({ points: path.trace, count: path.count, describe: (i) => this.describeConfiguration(s.path, i) });
    trees.forEach((tree, t) => {
      const count = Math.round(s.growth * tree.parents.length);
      if (s.trees[t]) clouds.push({ points: tree.nodes, count, describe: (i) => describeNode(tree, i) });
    });
    if (roadmap && s.roadmap) clouds.push({ points: roadmap.nodes, count: roadmap.kind.length, describe: (i) => this.describeMilestone(i) });
    for (const layer of this.layers) clouds.push(...(layer.clouds?.(s) ?? []));
    return clouds;
  }
  /** @param {number} p @param {number} i @returns {Omit<Picked, "point">} */
  describeConfiguration(p, i) {
    const path = this.scene.paths[p];
    const facts = this.rowFacts(p, i);
    if (path.clearance) facts.push(["clearance", `at least ${brief(path.clearance[i])} m`]);
    return { title: `Configuration ${i + 1} of ${path.count}, path “${path.name}”`, facts, time: i, marked: true };
  }
  /** The numbers of a configuration. @param {number} p @param {number} i @returns {[string, string][]} */
  rowFacts(p, i) {
    const { columns, paths } = this.scene;
    return columns.map((c, k) => [c.name, `${coordinate(paths[p].rows[i * columns.length + k])} ${c.unit}`]);
  }
  /** @param {number} i @returns {Omit<Picked, "point">} */
  describeMilestone(i) {
    const { nodes, component, kind, edges } = /** @type {NonNullable<Scene["roadmap"]>} */ (this.scene.roadmap);
    const degree = edges.reduce((sum, e) => sum + (e === i ? 1 : 0), 0);
    return {
      title: `Milestone ${brief(i)} of the roadmap`,
      facts: [placeFact(pointAt(nodes, i)), ["kind", KIND_NAMES[Math.min(kind[i], 3)]], ["component", brief(component[i])], ["edges", brief(degree)]],
      time: null,
      marked: true,
    };
  }
  /** @param {Item} item @param {Vec3} point @param {Settings} s @returns {Picked} */
  describeItem(item, point, s) {
    const body = this.scene.bodies[item.body];
    const shape = this.shapes[item.shape];
    const part = this.scene.bodies[item.body].role === "moving" ? "the obstacles that move" : PARTS[item.role](item.index);
    /** @type {[string, string][]} */ const facts = [["part of", part], placeFact(point)];
    facts.push(["size", [0, 1, 2].map((k) => brief(shape.high[k] - shape.low[k])).join(" × ") + " m"]);
    if (shape.triangles.length) facts.push(["triangles", brief(shape.triangles.length / 3)]);
    if (item.role === "copy" || item.role === "robot") facts.push(...this.rowFacts(s.path, item.index));
    if (item.role === "compared") facts.push(...this.rowFacts(s.other, item.index));
    return { title: body.name, facts, point, time: item.role === "copy" ? item.index : null, marked: false, item };
  }
}

/** @type {Record<import("mp/renderer.js").Role, (index: number) => string>} */
const PARTS = {
  obstacle: () => "the obstacles",
  robot: (i) => `the robot, configuration ${i + 1}`,
  copy: (i) => `the robot, configuration ${i + 1}`,
  compared: (i) => `the robot on the path compared, configuration ${i + 1}`,
  start: () => "the start",
  goal: (i) => `goal ${i + 1}`,
};

/** @param {Vec3} p @returns {[string, string]} */
export const placeFact = (p) => ["place", `${p.map(brief).join(", ")} m`];

/** @param {Tree} tree @param {number} i @returns {Omit<Picked, "point">} */
export function describeNode({ name, nodes, parents }, i) {
  let depth = 0;
  for (let k = i; parents[k] >= 0 && depth <= parents.length; k = parents[k]) depth++;
  const parent = parents[i] < 0 ? "none: this is a root" : `node ${brief(parents[i])}`;
  return { title: `Node ${brief(i)} of the tree “${name}”`, facts: [placeFact(pointAt(nodes, i)), ["parent", parent], ["steps to the root", brief(depth)]], time: null, marked: true };
}
