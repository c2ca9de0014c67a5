// A roadmap on the graphics card that grows. Milestones and edges have the colour of the first milestone of their connected component.
// When two components are joined, only one of them is written again. Edges that a lazy planner finds blocked become points.

import { componentColor } from "mp/colors.js";
import { brief } from "mp/dom.js";
import { KeptRows, withRoom } from "mp/growing.js";
import { KIND_NAMES, KIND_SIZES, placeFact } from "mp/picking.js";

/** @import { Rgba } from "mp/buffers.js" */
/** @import { Picked } from "mp/picking.js" */
/** @import { Renderer } from "mp/renderer.js" */

/** A set of milestones that edges connect. @typedef {{first: number, nodes: number[], edges: number[]}} Component */

/** Connected components of a graph that grows: the smaller joins the larger. */
export class Components {
  constructor() {
    /** Of each milestone. @type {Component[]} */ this.of = [];
    /** How many there are. */ this.count = 0;
    /** How many edges there are, with those that joined nothing. */ this.edges = 0;
  }
  /** Adds a milestone, which is a component of its own. */
  add() {
    const first = this.of.length;
    this.of.push({ first, nodes: [first], edges: [] });
    this.count++;
  }
  /** Adds an edge. Returns what is in a component with another first milestone now, or null. @param {number} a @param {number} b
   * @returns {Component | null} */
  join(a, b) {
    if (a === b) {
      this.edges++;
      return null;
    }
    let [large, small] = [this.of[a], this.of[b]];
    const edge = this.edges++;
    if (large === small) {
      large.edges.push(edge);
      return null;
    }
    if (small.nodes.length > large.nodes.length) [large, small] = [small, large];
    const changed = large.first < small.first ? small : { ...large, nodes: large.nodes.slice(), edges: large.edges.slice() };
    for (const node of small.nodes) {
      this.of[node] = large;
      large.nodes.push(node);
    }
    for (const other of small.edges) large.edges.push(other);
    large.edges.push(edge);
    large.first = Math.min(large.first, small.first);
    this.count--;
    return changed;
  }
}

export class GrowingRoadmap {
  constructor(/** @type {Renderer} */ renderer) {
    this.components = new Components();
    this.kinds = new Uint8Array(0);
    this.degrees = new Uint32Array(0);
    /** The two milestones of each edge; one and the same where the edge was taken away. */ this.ends = new Uint32Array(0);
    /** The numbers of edges by their ends; made when the first is taken away. @type {Map<string, number> | null} */ this.byEnds = null;
    this.nodes = new KeptRows(renderer.pointSet(), (i) => this.nodeColor(i));
    this.edges = new KeptRows(renderer.lineSet(), (e) => this.edgeColor(e));
  }
  get count() { return this.nodes.count; }
  /** @param {number} i @returns {Rgba} */
  nodeColor(i) { return [...componentColor(this.components.of[i].first), KIND_SIZES[Math.min(this.kinds[i], 3)]]; }
  /** @param {number} e @returns {Rgba} */
  edgeColor(e) { return [...componentColor(this.components.of[this.ends[2 * e]].first), 1]; }

  /** @param {{nodes: Float32Array, edges: Uint32Array, kind: Uint8Array, unlinked?: Uint32Array}} news of an event `grown` */
  append({ nodes, edges, kind, unlinked }) {
    const { components } = this;
    const [from, before] = [this.nodes.count, this.edges.count];
    this.kinds = withRoom(this.kinds, from + kind.length);
    this.kinds.set(kind, from);
    this.degrees = withRoom(this.degrees, from + kind.length);
    for (let i = 0; i < kind.length; i++) components.add();
    this.ends = withRoom(this.ends, 2 * before + edges.length);
    this.ends.set(edges, 2 * before);
    /** @type {Component[]} */ const joined = [];
    for (let i = 0; i < edges.length; i += 2) {
      const changed = components.join(edges[i], edges[i + 1]);
      if (changed) joined.push(changed);
      this.degrees[edges[i]]++;
      this.degrees[edges[i + 1]]++;
      this.byEnds?.set(`${edges[i]} ${edges[i + 1]}`, before + i / 2);
    }
    this.nodes.append(nodes);
    this.edges.append(this.nodes.join(edges));
    // What is new has the right colour already.
    this.nodes.recolor(joined.flatMap((c) => c.nodes.filter((i) => i < from)));
    this.edges.recolor(joined.flatMap((c) => c.edges.filter((e) => e < before)));
    if (unlinked?.length) this.remove(unlinked);
  }
  /** Takes edges away: components may fall apart, so all are found again. @param {Uint32Array} pairs the ends of the edges */
  remove(pairs) {
    const { ends, edges, nodes, components: before } = this;
    this.byEnds ??= new Map(Array.from({ length: edges.count }, (_, e) => [`${ends[2 * e]} ${ends[2 * e + 1]}`, e]));
    for (let i = 0; i < pairs.length; i += 2) {
      const key = `${pairs[i]} ${pairs[i + 1]}`;
      const edge = this.byEnds.get(key);
      if (edge === undefined) continue;
      this.byEnds.delete(key);
      this.degrees[pairs[i]]--;
      this.degrees[pairs[i + 1]]--;
      ends[2 * edge + 1] = ends[2 * edge];
      edges.replace(edge, nodes.join(ends.subarray(2 * edge, 2 * edge + 2)));
    }
    this.components = new Components();
    for (let i = 0; i < nodes.count; i++) this.components.add();
    for (let e = 0; e < edges.count; e++) this.components.join(ends[2 * e], ends[2 * e + 1]);
    const { of } = this.components;
    const other = (/** @type {number} */ i) => of[i].first !== before.of[i].first;
    nodes.recolor(of.flatMap((_, i) => (other(i) ? [i] : [])));
    edges.recolor(Array.from({ length: edges.count }, (_, e) => e).filter((e) => other(ends[2 * e])));
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
