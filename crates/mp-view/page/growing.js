// A tree on the graphics card that grows: new nodes are appended, and a node with a new parent changes its segment in place.

/** @import { LineSet, PointSet, Rgba } from "mp/buffers.js" */
/** @import { Renderer } from "mp/renderer.js" */
/** @import { Tree } from "mp/scene.js" */
/** @typedef {{bent: Uint32Array, through: Float32Array}} Bends edges that are not straight, as docs/formats/viewer.md has them */

/** Room for twice as many numbers when the array is full. @template {Float32Array | Int32Array | Uint32Array | Uint8Array} T @param {T} array
 * @param {number} needed @returns {T} */
export function withRoom(array, needed) {
  if (array.length >= needed) return array;
  const bigger = /** @type {T} */ (new /** @type {any} */ (array.constructor)(Math.max(needed, 2 * array.length)));
  bigger.set(array);
  return bigger;
}

/** @type {Rgba} */
const WHITE = [1, 1, 1, 1];

/** Stands for a parent that is not known; roots have −1. */
const ORPHAN = -2;

/** Rows that are written again by one call may have so many others between them. */
const GAP = 64;

/** Points or segments that are kept beside their copy on the graphics card. @template {LineSet | PointSet} S */
export class KeptRows {
  /** @param {S} set @param {(row: number) => Rgba} color of each row */
  constructor(set, color = () => WHITE) {
    this.set = set; this.color = color;
    this.numbers = new Float32Array(0);
    this.count = 0;
  }
  /** @param {Float32Array} coordinates of new rows, whose colours are known */
  append(coordinates) {
    const from = this.count;
    this.numbers = withRoom(this.numbers, from * this.set.floats + coordinates.length);
    this.numbers.set(coordinates, from * this.set.floats);
    this.count += coordinates.length / this.set.floats;
    this.set.append(coordinates, (i) => this.color(from + i));
  }
  /** Gives a row other coordinates. @param {number} row @param {Float32Array} coordinates */
  replace(row, coordinates) {
    this.numbers.set(coordinates, row * this.set.floats);
    this.set.replace(row, coordinates);
  }
  /** Writes rows whose colours have changed. @param {number[]} rows */
  recolor(rows) {
    const { set, numbers } = this;
    const sorted = Uint32Array.from(rows).sort();
    for (let i = 0, end; i < sorted.length; i = end) {
      end = i + 1;
      while (end < sorted.length && sorted[end] - sorted[end - 1] <= GAP) end++;
      const first = sorted[i];
      set.rewrite(first, numbers.subarray(first * set.floats, (sorted[end - 1] + 1) * set.floats), (k) => this.color(first + k));
    }
  }
  /** The segments between pairs of points. @param {Uint32Array} pairs */
  join(pairs) {
    const out = new Float32Array(3 * pairs.length);
    for (let i = 0; i < pairs.length; i++) for (let k = 0; k < 3; k++) out[3 * i + k] = this.numbers[3 * pairs[i] + k];
    return out;
  }
  /** Takes another set after the graphics card was lost. @param {S} set */
  restart(set) {
    this.set = set;
    set.append(this.numbers.subarray(0, this.count * set.floats), this.color);
  }
}

/** The nodes whose edges bend. @param {Bends | null} bends @returns {number[]} */
const bentNodes = (bends) => Array.from({ length: (bends?.bent.length ?? 0) / 2 }, (_, i) => bends?.bent[2 * i] ?? 0);

/** Node i has segment i, which ends at it and begins at its parent or, where the edge bends, at the last bend; a root's segment is a
 * point. The other segments of bent edges follow one another in a set of their own. */
export class GrowingTree {
  /** @param {Renderer} renderer @param {string} name */
  constructor(renderer, name) {
    this.name = name;
    this.count = 0;
    /** Rises whenever nodes get other numbers. */ this.version = 0;
    this.nodes = new Float32Array(0);
    this.parents = new Int32Array(0);
    /** Of each node whose edge bends, the points between, and its first segment in `bent`. @type {Map<number, {points: Float32Array, at: number}>} */
    this.bends = new Map();
    /** For each segment in `bent`, how many nodes there are when it is seen. @type {number[]} */ this.seen = [];
    this.start(renderer);
  }
  /** @param {Renderer} renderer */
  start(renderer) {
    this.lines = renderer.lineSet();
    this.bent = renderer.lineSet();
    this.roots = renderer.pointSet();
  }
  /** Makes the buffers again after the graphics card was lost. @param {Renderer} renderer */
  restart(renderer) {
    this.start(renderer);
    this.upload(0);
  }
  free() { for (const set of this.sets()) set.free(); }

  sets() { return [this.lines, this.bent, this.roots].filter((set) => set !== undefined); }

  /** Its nodes and parents as a tree of a scene. @returns {Tree} */
  tree() { return { name: this.name, nodes: this.nodes.subarray(0, 3 * this.count), parents: this.parents.subarray(0, this.count), bends: null }; }

  /** The segments that are seen when the tree has grown to a part of its nodes. @param {number} growth 0 to 1 @returns {{set: LineSet, count: number}[]} */
  drawn(growth) {
    const { lines, bent, seen } = this;
    if (!lines || !bent) return [];
    const nodes = Math.round(growth * this.count);
    let [low, high] = [0, seen.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (seen[middle] <= nodes) low = middle + 1;
      else high = middle;
    }
    return [{ set: lines, count: nodes }, { set: bent, count: low }];
  }
  /** @param {Float32Array} nodes x y z of each new node @param {Int32Array} parents @param {Bends | null} [bends] */
  append(nodes, parents, bends = null) {
    const from = this.count;
    this.count += parents.length;
    this.nodes = withRoom(this.nodes, 3 * this.count);
    this.parents = withRoom(this.parents, this.count);
    this.nodes.set(nodes, 3 * from);
    this.parents.set(parents, from);
    this.bend(bends);
    this.upload(from, bentNodes(bends));
  }
  /** Notes where edges bend. @param {Bends | null} bends */
  bend(bends) {
    if (!bends) return;
    const { bent, through } = bends;
    for (let i = 0, at = 0; i < bent.length; i += 2) {
      const end = at + 3 * bent[i + 1];
      this.bends.set(bent[i], { points: through.slice(at, end), at: -1 });
      at = end;
    }
  }
  /** Writes the segments of the nodes from this one on to the graphics card. @param {number} from
   * @param {number[]} bent those of them whose edges bend, which rise */
  upload(from, bent = [...this.bends.keys()].sort((a, b) => a - b)) {
    const segments = new Float32Array(6 * (this.count - from));
    for (let i = from; i < this.count; i++) {
      this.segment(i, segments, 6 * (i - from));
      if (this.parents[i] === -1) this.roots?.append(this.nodes.slice(3 * i, 3 * i + 3), () => [1, 1, 1, 0.6]);
    }
    this.lines?.append(segments, () => WHITE);
    if (!from) this.seen = [];
    this.uploadBends(bent, (node) => node + 1);
  }
  /** Writes the segments between the parents of nodes and the last bends of their edges. @param {number[]} bent the nodes
   * @param {(node: number) => number} seen how many nodes there are when they are seen */
  uploadBends(bent, seen) {
    const ends = bent.flatMap((node) => {
      const bend = this.bends.get(node);
      const parent = this.parents[node];
      if (!bend || parent < 0) return [];
      const { points } = bend;
      bend.at = this.seen.length;
      for (let i = 0; i < points.length; i += 3) this.seen.push(seen(node));
      const line = [...this.nodes.subarray(3 * parent, 3 * parent + 3), ...points];
      return Array.from({ length: points.length / 3 }, (_, i) => line.slice(3 * i, 3 * i + 6)).flat();
    });
    this.bent?.append(new Float32Array(ends), () => WHITE);
  }
  /** @param {number} i @param {Float32Array} out @param {number} at */
  segment(i, out, at) {
    const parent = this.parents[i] < 0 ? i : this.parents[i];
    const points = this.parents[i] < 0 ? undefined : this.bends.get(i)?.points;
    for (let k = 0; k < 3; k++) {
      out[at + k] = points ? points[points.length - 3 + k] : this.nodes[3 * parent + k];
      out[at + 3 + k] = this.nodes[3 * i + k];
    }
  }
  /** @param {Uint32Array} nodes @param {Int32Array} parents @param {Bends | null} [bends] of the new edges */
  rewire(nodes, parents, bends = null) {
    const segment = new Float32Array(6);
    for (const node of nodes) this.straighten(node);
    this.bend(bends);
    nodes.forEach((node, i) => {
      this.parents[node] = parents[i];
      this.segment(node, segment, 0);
      this.lines?.replace(node, segment);
    });
    this.uploadBends(bentNodes(bends), () => this.count);
  }
  /** Forgets the bends of an edge: their segments become points at its node. @param {number} node */
  straighten(node) {
    const bend = this.bends.get(node);
    if (!bend) return;
    this.bends.delete(node);
    if (bend.at < 0) return;
    const [x, y, z] = this.nodes.subarray(3 * node, 3 * node + 3);
    for (let i = 0; i < bend.points.length / 3; i++) this.bent?.replace(bend.at + i, new Float32Array([x, y, z, x, y, z]));
  }
  /** Keeps only some nodes: node i becomes what `survivors[i]` was. @param {Uint32Array} survivors */
  prune(survivors) {
    const now = new Int32Array(this.count).fill(-1);
    survivors.forEach((old, i) => (now[old] = i));
    const { nodes, parents, bends } = this;
    this.nodes = new Float32Array(3 * survivors.length);
    this.parents = new Int32Array(survivors.length);
    this.bends = new Map();
    survivors.forEach((old, i) => {
      this.nodes.set(nodes.subarray(3 * old, 3 * old + 3), 3 * i);
      // A parent that is gone is replaced by the same event, which rewires the node.
      this.parents[i] = parents[old] < 0 ? parents[old] : now[parents[old]] < 0 ? ORPHAN : now[parents[old]];
      const bend = bends.get(old);
      if (bend) this.bends.set(i, { points: bend.points, at: -1 });
    });
    this.count = survivors.length;
    this.version++;
    for (const set of this.sets()) set.clear();
    this.upload(0);
  }
}
