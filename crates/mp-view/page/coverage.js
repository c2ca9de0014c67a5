// What a search has reached: the cells of a grid in which the drawn points of its nodes lie, seen along an axis.

import { brief, el, labelled, legendOf, select } from "mp/dom.js";

/** @import { Color, Palette } from "mp/colors.js" */
/** @import { Vec3 } from "mp/math.js" */
/** @import { ImageSet } from "mp/buffers.js" */
/** @import { Settings } from "mp/picture.js" */
/** @import { Picture, Renderer } from "mp/renderer.js" */
/** @import { Scene } from "mp/scene.js" */
/** @import { Layer, Viewer } from "mp/viewer.js" */
/** @typedef {{of: object, version: number, points: Float32Array, count: number}} Nodes the nodes of a tree or roadmap. Only later
 *  ones are counted again, unless `version` has changed. */

/** Cells along the longer side of the grid. */
const CELLS = 64;
/** The projections: the axis along which one looks, and those of the image. @type {Record<string, [number, number]>} */
const AXES = { z: [0, 1], y: [0, 2], x: [1, 2] };

/** Numbers of points in the cells of a grid over a rectangle. */
export class CoverageGrid {
  /** @param {[number, number]} axes of the points @param {Vec3} low @param {Vec3} high corners of the box that is covered */
  constructor(axes, low, high) {
    this.axes = axes;
    const sides = axes.map((k) => Math.max(high[k] - low[k], 1e-9));
    /** The size of a cell, metres. */ this.cell = Math.max(...sides) / CELLS;
    this.origin = axes.map((k) => low[k]);
    const cells = (/** @type {number} */ side) => Math.max(1, Math.ceil(side / this.cell - 1e-9));
    this.width = cells(sides[0]);
    this.height = cells(sides[1]);
    this.counts = new Uint32Array(this.width * this.height);
    /** Cells with a point. */ this.reached = 0;
    /** Points in the fullest cell. */ this.most = 0;
    /** Points beside the grid. */ this.outside = 0;
    /** @type {{of: object, version: number, counted: number}[]} */ this.known = [];
  }
  clear() {
    this.counts.fill(0);
    this.reached = this.most = this.outside = 0;
    this.known = [];
  }
  /** @param {Float32Array} points x y z @param {number} from @param {number} to */
  add(points, from, to) {
    const { axes: [i, j], origin: [x, y], cell, width, height, counts } = this;
    for (let p = from; p < to; p++) {
      const column = Math.floor((points[3 * p + i] - x) / cell), row = Math.floor((points[3 * p + j] - y) / cell);
      // The upper border belongs to the last cells.
      const c = column === width && points[3 * p + i] <= x + width * cell * (1 + 1e-6) ? width - 1 : column;
      const r = row === height && points[3 * p + j] <= y + height * cell * (1 + 1e-6) ? height - 1 : row;
      if (!(c >= 0 && c < width && r >= 0 && r < height)) {
        this.outside++;
        continue;
      }
      const count = ++counts[r * width + c];
      if (count === 1) this.reached++;
      if (count > this.most) this.most = count;
    }
  }
  /** Counts what has not been counted; all again when something was taken away. @param {Nodes[]} nodes @returns {boolean} whether anything changed */
  update(nodes) {
    const grows = this.known.every(({ of, version, counted }, k) => nodes[k]?.of === of && nodes[k].version === version && nodes[k].count >= counted);
    if (!grows) this.clear();
    let changed = !grows;
    nodes.forEach(({ of, version, points, count }, k) => {
      const from = this.known[k]?.counted ?? 0;
      if (count > from) {
        this.add(points, from, count);
        changed = true;
      }
      this.known[k] = { of, version, counted: count };
    });
    return changed;
  }
  /** Red, green, blue and opacity of each cell: the more points, the less transparent. @param {Color} color */
  pixels(color) {
    const out = new Uint8Array(4 * this.counts.length);
    const scale = 1 / Math.log2(1 + Math.max(1, this.most));
    this.counts.forEach((count, i) => {
      if (!count) return;
      for (let k = 0; k < 3; k++) out[4 * i + k] = Math.round(255 * color[k]);
      out[4 * i + 3] = Math.round(255 * opacity(Math.log2(1 + count) * scale));
    });
    return out;
  }
}

/** The opacity of a cell, for a share between 0 and 1 of the fullest. @param {number} share */
const opacity = (share) => 0.15 + 0.6 * share;

/** The box in which the drawn point of the robot may be: where there are limits of a place, these. @param {Scene} scene @returns {[Vec3, Vec3]} */
export function reachBox(scene) {
  const [low, high] = scene.bounds.map((corner) => /** @type {Vec3} */ ([...corner]));
  ["x", "y", "z"].forEach((name, k) => {
    const column = scene.columns.findIndex((c) => c.name === name && c.unit === "m");
    const limit = scene.limits[column];
    if (limit) [low[k], high[k]] = limit;
  });
  return [low, high];
}

/** @implements {Layer} */
export class Coverage {
  constructor(/** @type {Viewer} */ viewer) {
    this.viewer = viewer;
    /** The axis along which one looks, or none. */ this.along = "";
    /** @type {CoverageGrid | null} */ this.grid = null;
    /** @type {ImageSet | null} */ this.image = null;
    this.dark = false;
    this.legend = el("p", { class: "legend", hidden: true });
    this.control = select([["", "not shown"]], "", (along) => this.choose(along));
    this.row = labelled("Coverage of the search", this.control);
    this.row.title = "Where the search has nodes (L)";
    viewer.onshow.push(() => this.show());
  }
  get elements() { return [this.row, this.legend]; }

  /** After another scene is shown. */
  show() {
    const { planar } = this.viewer.scene;
    const all = planar ? [["z", "shown"]] : [["z", "seen along z"], ["y", "seen along y"], ["x", "seen along x"]];
    this.choices = ["", ...all.map(([value]) => value)];
    this.control.replaceChildren(...[["", "not shown"], ...all].map(([value, label]) => el("option", { value }, label)));
    this.choose(this.choices.includes(this.along) ? this.along : "");
  }
  /** @param {string} along z, y, x, or nothing */
  choose(along) {
    this.along = along;
    this.control.value = along;
    const axes = AXES[along];
    this.grid = axes ? new CoverageGrid(axes, ...reachBox(this.viewer.scene)) : null;
    this.legend.hidden = !this.grid;
    this.viewer.changed();
  }
  /** The next projection, after the last one none. */
  next() {
    const choices = this.choices ?? [""];
    this.choose(choices[(choices.indexOf(this.along) + 1) % choices.length]);
  }
  start(/** @type {Renderer} */ renderer) {
    this.image = renderer.image();
    this.grid?.clear();
  }
  /** What is counted: the search of the run that is shown, or else what the scene has. @param {Settings} s @returns {Nodes[]} */
  nodes(s) {
    const searched = this.viewer.layers.flatMap((layer) => layer.searched?.(s) ?? []);
    if (searched.length) return searched;
    const { trees, roadmap } = this.viewer.scene;
    const stored = trees.map((tree) => ({ of: tree, version: 0, points: tree.nodes, count: Math.round(s.growth * tree.parents.length) }));
    return roadmap ? [...stored, { of: roadmap, version: 0, points: roadmap.nodes, count: roadmap.kind.length }] : stored;
  }
  /** @param {Settings} s @param {Palette} colors @returns {Picture["images"]} */
  images(s, colors) {
    const { grid, image } = this;
    if (!grid || !image) return [];
    if (grid.update(this.nodes(s)) || this.dark !== s.dark || image.owner !== grid) {
      this.dark = s.dark;
      image.write(grid, grid.width, grid.height, grid.pixels(colors.covered));
      this.legend.replaceChildren(...legendOf(colors.covered, this.words(grid)));
    }
    const [low, high] = reachBox(this.viewer.scene);
    // On the far side of the box, where it hides nothing.
    const across = 3 - grid.axes[0] - grid.axes[1];
    if (this.viewer.scene.planar) low[across] = 0;
    else if (this.viewer.camera.axes().back[across] < 0) low[across] = high[across];
    /** @param {number} i @param {number} length @returns {Vec3} */
    const side = (i, length) => /** @type {Vec3} */ ([0, 1, 2].map((k) => (k === i ? length : 0)));
    const [i, j] = grid.axes;
    return [{ image, corner: low, right: side(i, grid.width * grid.cell), up: side(j, grid.height * grid.cell) }];
  }
  /** @param {CoverageGrid} grid */
  words({ reached, counts, cell, most, outside }) {
    const share = ((100 * reached) / counts.length).toFixed(reached && reached < 0.1 * counts.length ? 1 : 0);
    const beside = outside ? ` ${brief(outside)} nodes are beside the grid.` : "";
    return `${brief(reached)} of ${brief(counts.length)} cells reached (${share}%). A cell is ${brief(cell)} m wide; the fullest has ${brief(most)} ${most === 1 ? "node" : "nodes"}.${beside}`;
  }
}
