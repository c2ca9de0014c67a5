// A roadmap on the graphics card that grows. Milestones and edges have the colour of their connected component. When two
// components are joined, only what belonged to the smaller one is written again.

import { componentColor } from "mp/colors.js";
import { brief } from "mp/dom.js";
import { KeptRows, withRoom } from "mp/growing.js";
import { KIND_NAMES, KIND_SIZES, placeFact } from "mp/picking.js";

/** @import { Rgba } from "mp/buffers.js" */
/** @import { Picked } from "mp/picking.js" */
/** @import { Renderer } from "mp/renderer.js" */

/** A set of milestones that edges connect. `number` stays when a smaller component joins it.
 * @typedef {{number: number, nodes: number[], edges: number[]}} Component */

/** Connected components of a graph that grows. A milestone changes its component at most log₂ n times, as the smaller joins the larger. */
export class Components {
  constructor() {
    /** Of each milestone. @type {Component[]} */ this.of = [];
    /** How many there are. */ this.count = 0;
    /** The first milestone of each edge. @type {number[]} */ this.ends = [];
  }
  /** Adds a milestone, which is a component of its own. */
  add() {
    const number = this.of.length;
    this.of.push({ number, nodes: [number], edges: [] });
    this.count++;
  }
  /** Adds an edge. Returns what has another component now, or null. @param {number} a @param {number} b @returns {Component | null} */
  join(a, b) {
    let [large, small] = [this.of[a], this.of[b]];
    const edge = this.ends.push(a) - 1;
    if (large === small) {
      large.edges.push(edge);
      return null;
    }
    const larger = small.nodes.length - large.nodes.length || large.number - small.number;
    if (larger > 0) [large, small] = [small, large];
    for (const node of small.nodes) {
      this.of[node] = large;
      large.nodes.push(node);
    }
    for (const other of small.edges) large.edges.push(other);
    large.edges.push(edge);
    this.count--;
    return small;
  }
}

export class GrowingRoadmap {
  constructor(/** @type {Renderer} */ renderer) {
    this.components = new Components();
    this.kinds = new Uint8Array(0);
    this.degrees = new Uint32Array(0);
    this.nodes = new KeptRows(renderer.pointSet(), (i) => this.nodeColor(i));
    this.edges = new KeptRows(renderer.lineSet(), (e) => this.edgeColor(e));
  }
  get count() { return this.nodes.count; }
  /** @param {number} i @returns {Rgba} */
  nodeColor(i) { return [...componentColor(this.components.of[i].number), KIND_SIZES[Math.min(this.kinds[i], 3)]]; }
  /** @param {number} e @returns {Rgba} */
  edgeColor(e) { return [...componentColor(this.components.of[this.components.ends[e]].number), 1]; }

  /** @param {{nodes: Float32Array, edges: Uint32Array, kind: Uint8Array}} news of an event `grown` */
  append({ nodes, edges, kind }) {
    const { components } = this;
    const [from, before] = [this.nodes.count, this.edges.count];
    this.kinds = withRoom(this.kinds, from + kind.length);
    this.kinds.set(kind, from);
    this.degrees = withRoom(this.degrees, from + kind.length);
    for (let i = 0; i < kind.length; i++) components.add();
    /** @type {Component[]} */ const joined = [];
    for (let i = 0; i < edges.length; i += 2) {
      const smaller = components.join(edges[i], edges[i + 1]);
      if (smaller) joined.push(smaller);
      this.degrees[edges[i]]++;
      this.degrees[edges[i + 1]]++;
    }
    this.nodes.append(nodes);
    this.edges.append(this.nodes.join(edges));
    // What is new has the right colour already.
    this.nodes.recolor(joined.flatMap((c) => c.nodes.filter((i) => i < from)));
    this.edges.recolor(joined.flatMap((c) => c.edges.filter((e) => e < before)));
  }
  /** After the graphics card was lost. @param {Renderer} renderer */
  restart(renderer) {
    this.nodes.restart(renderer.pointSet());
    this.edges.restart(renderer.lineSet());
  }
  free() {
    this.nodes.set.free();
    this.edges.set.free();
  }
  /** @param {number} i @returns {Omit<Picked, "point">} */
  describe(i) {
    const [x, y, z] = this.nodes.numbers.subarray(3 * i, 3 * i + 3);
    const { nodes } = this.components.of[i];
    const size = nodes.length === 1 ? "this one only" : `${brief(nodes.length)} milestones`;
    return {
      title: `Milestone ${brief(i)} of the roadmap`,
      facts: [placeFact([x, y, z]), ["kind", KIND_NAMES[Math.min(this.kinds[i], 3)]], ["component", size], ["edges", brief(this.degrees[i])]],
      time: null,
      marked: true,
    };
  }
}
