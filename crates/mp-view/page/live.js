// What a run has searched: its trees or roadmap, and the motions that were not free. It grows with the run's events.

import { GrowingTree, KeptRows } from "mp/growing.js";
import { GrowingRoadmap } from "mp/milestones.js";
import { describeNode } from "mp/picking.js";
import { treeColor } from "mp/picture.js";

/** @import { Palette } from "mp/colors.js" */
/** @import { Message } from "mp/message.js" */
/** @import { Nodes } from "mp/coverage.js" */
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
    this.roadmap = new GrowingRoadmap(renderer);
    this.rejected = new KeptRows(renderer.lineSet());
  }
  /** @param {Message} event `grown` of docs/formats/session.md */
  grow(event) {
    for (const { tree, survivors } of event.pruned ?? []) this.trees[tree]?.prune(survivors);
    for (const { tree, name, nodes, parents, ...bends } of event.trees ?? []) {
      this.trees[tree] ??= new GrowingTree(this.renderer, name);
      this.trees[tree].append(nodes, parents, bends.bent ? bends : null);
    }
    for (const { tree, nodes, parents, ...bends } of event.rewired ?? []) this.trees[tree]?.rewire(nodes, parents, bends.bent ? bends : null);
    if (event.roadmap) this.roadmap.append(event.roadmap);
    const room = 6 * (MOST_REJECTED - this.rejected.count);
    if (event.rejected?.length && room > 0) this.rejected.append(event.rejected.subarray(0, room));
  }
  /** After the graphics card was lost. @param {Renderer} renderer */
  restart(renderer) {
    this.renderer = renderer;
    for (const tree of this.grown()) tree.restart(renderer);
    this.roadmap.restart(renderer);
    this.rejected.restart(renderer.lineSet());
  }
  /** A tree that has not begun to grow is missing. */
  grown() { return this.trees.filter((tree) => tree); }

  free() {
    for (const tree of this.grown()) tree.free();
    this.roadmap.free();
    this.rejected.set.free();
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
    const { roadmap: { edges }, rejected } = this.shown;
    const trees = this.shown.trees.flatMap((tree, i) =>
      tree.drawn(s.growth).map((part) => ({ ...part, width: 1, color: treeColor(tree.name, i, colors), alpha: 0.7, over: false })));
    const searched = [...trees, { set: edges.set, count: edges.count, width: 1, color: null, alpha: 1, over: false }];
    const failed = { set: rejected.set, count: rejected.count, width: 1, color: colors.rejected, alpha: 0.5, over: false };
    return [...(this.rejected ? [failed] : []), ...(this.search ? searched : [])];
  }
  /** @param {Settings} s @param {Palette} colors @returns {Picture["points"]} */
  points(s, colors) {
    if (!this.shown || !this.search) return [];
    const marks = this.shown.trees.flatMap(({ name, roots }, i) => (roots ? [{ set: roots, count: roots.count, color: treeColor(name, i, colors), over: false }] : []));
    const { nodes } = this.shown.roadmap;
    return [...marks, { set: nodes.set, count: nodes.count, color: null, over: false }];
  }
  /** @param {Settings} s @returns {Nodes[]} */
  searched(s) {
    if (!this.shown) return [];
    const trees = this.shown.grown().map((tree) => ({ of: tree, version: tree.version, points: tree.nodes, count: Math.round(s.growth * tree.count) }));
    const { roadmap } = this.shown;
    return [...trees, { of: roadmap, version: 0, points: roadmap.nodes.numbers, count: roadmap.count }];
  }
  /** @param {Settings} s @returns {Cloud[]} */
  clouds(s) {
    if (!this.shown || !this.search) return [];
    const trees = this.shown.grown().map((grown) => {
      const tree = grown.tree();
      return { points: tree.nodes, count: Math.round(s.growth * grown.count), describe: (/** @type {number} */ i) => describeNode(tree, i) };
    });
    const { roadmap } = this.shown;
    return [...trees, { points: roadmap.nodes.numbers, count: roadmap.count, describe: (/** @type {number} */ i) => roadmap.describe(i) }];
  }
}
