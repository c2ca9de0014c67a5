// What a run has searched: its trees or roadmap, and the motions that were not free. It grows with the run's events.

import { GrowingTree, KeptRows } from "mp/growing.js";
import { brief } from "mp/dom.js";
import { placeFact, describeNode } from "mp/picking.js";
import { treeColor } from "mp/picture.js";

/** @import { Palette } from "mp/colors.js" */
/** @import { Message } from "mp/message.js" */
/** @import { Cloud } from "mp/picking.js" */
/** @import { Settings } from "mp/picture.js" */
/** @import { Picture, Renderer } from "mp/renderer.js" */
/** @import { Layer } from "mp/viewer.js" */

/** How many rejected motions are kept: more only hide each other. */
const MOST_REJECTED = 50000;

/** The search of one run. */
export class RunPicture {
  constructor(/** @type {Renderer} */ renderer) {
    this.renderer = renderer;
    /** @type {GrowingTree[]} */ this.trees = [];
    this.nodes = new KeptRows(renderer.pointSet(), [1, 1, 1, 0.25]);
    this.edges = new KeptRows(renderer.lineSet());
    this.rejected = new KeptRows(renderer.lineSet());
  }
  /** @param {Message} event `grown` of docs/formats/session.md */
  grow(event) {
    for (const { tree, survivors } of event.pruned ?? []) this.trees[tree]?.prune(survivors);
    for (const { tree, name, nodes, parents } of event.trees ?? []) {
      this.trees[tree] ??= new GrowingTree(this.renderer, name);
      this.trees[tree].append(nodes, parents);
    }
    for (const { tree, nodes, parents } of event.rewired ?? []) this.trees[tree]?.rewire(nodes, parents);
    if (event.roadmap) {
      const { nodes, edges } = event.roadmap;
      this.nodes.append(nodes);
      this.edges.append(this.nodes.join(edges));
    }
    const room = 6 * (MOST_REJECTED - this.rejected.count);
    if (event.rejected?.length && room > 0) this.rejected.append(event.rejected.subarray(0, room));
  }
  /** After the graphics card was lost. @param {Renderer} renderer */
  restart(renderer) {
    this.renderer = renderer;
    for (const tree of this.grown()) tree.restart(renderer);
    this.nodes.restart(renderer.pointSet());
    for (const lines of [this.edges, this.rejected]) lines.restart(renderer.lineSet());
  }
  /** A tree that has not begun to grow is missing. */
  grown() { return this.trees.filter((tree) => tree); }

  free() {
    for (const tree of this.grown()) tree.free();
    for (const rows of [this.nodes, this.edges, this.rejected]) rows.set.free();
  }
}

/** Draws the search of the run that is chosen. @implements {Layer} */
export class RunLayer {
  constructor() {
    /** @type {RunPicture | null} */ this.shown = null;
    /** All that have buffers. @type {Set<RunPicture>} */ this.all = new Set();
    this.search = true;
    this.rejected = false;
  }
  start(/** @type {Renderer} */ renderer) { for (const run of this.all) run.restart(renderer); }

  /** @param {Settings} s @param {Palette} colors @returns {Picture["lines"]} */
  lines(s, colors) {
    if (!this.shown) return [];
    const { edges, rejected } = this.shown;
    const trees = this.shown.trees.map(({ name, lines, count }, i) =>
      ({ set: lines, count: Math.round(s.growth * count), width: 1, color: treeColor(name, i, colors), alpha: 0.7, over: false }));
    const searched = [...trees, { set: edges.set, count: edges.count, width: 1, color: colors.fromStart, alpha: 0.7, over: false }];
    const failed = { set: rejected.set, count: rejected.count, width: 1, color: colors.rejected, alpha: 0.5, over: false };
    return [...(this.rejected ? [failed] : []), ...(this.search ? searched : [])];
  }
  /** @param {Settings} s @param {Palette} colors @returns {Picture["points"]} */
  points(s, colors) {
    if (!this.shown || !this.search) return [];
    const marks = this.shown.trees.map(({ name, roots }, i) => ({ set: roots, count: roots.count, color: treeColor(name, i, colors), over: false }));
    return [...marks, { set: this.shown.nodes.set, count: this.shown.nodes.count, color: colors.fromStart, over: false }];
  }
  /** @param {Settings} s @returns {Cloud[]} */
  clouds(s) {
    if (!this.shown || !this.search) return [];
    const trees = this.shown.grown().map((grown) => {
      const tree = grown.tree();
      return { points: tree.nodes, count: Math.round(s.growth * grown.count), describe: (/** @type {number} */ i) => describeNode(tree, i) };
    });
    const { numbers, count } = this.shown.nodes;
    /** @param {number} i */
    const milestone = (i) => ({ title: `Milestone ${brief(i)} of the roadmap`, facts: [placeFact([numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]])], time: null, marked: true });
    return [...trees, { points: numbers, count, describe: milestone }];
  }
}
