// A tree on the graphics card that grows: new nodes are appended, and a node with a new parent changes its segment in place.

/** @import { Renderer } from "mp/renderer.js" */
/** @import { Tree } from "mp/scene.js" */

/** Room for twice as many numbers when the array is full. @template {Float32Array | Int32Array} T @param {T} array @param {number} needed @returns {T} */
function withRoom(array, needed) {
  if (array.length >= needed) return array;
  const bigger = /** @type {T} */ (new /** @type {any} */ (array.constructor)(Math.max(needed, 2 * array.length)));
  bigger.set(array);
  return bigger;
}

const WHITE = /** @type {const} */ ([1, 1, 1, 1]);

/** Node i has segment i, from its parent to itself; a root's segment is a point. */
export class GrowingTree {
  /** @param {Renderer} renderer @param {string} name */
  constructor(renderer, name) {
    this.name = name;
    this.count = 0;
    this.nodes = new Float32Array(0);
    this.parents = new Int32Array(0);
    this.lines = renderer.lineSet();
    this.roots = renderer.pointSet();
  }
  /** Makes the buffers again after the graphics card was lost. @param {Renderer} renderer */
  restart(renderer) {
    this.lines = renderer.lineSet();
    this.roots = renderer.pointSet();
    this.upload(0);
  }
  free() {
    this.lines.free();
    this.roots.free();
  }
  /** Its nodes and parents as a tree of a scene. @returns {Tree} */
  tree() { return { name: this.name, nodes: this.nodes.subarray(0, 3 * this.count), parents: this.parents.subarray(0, this.count) }; }

  /** @param {Float32Array} nodes x y z of each new node @param {Int32Array} parents */
  append(nodes, parents) {
    const from = this.count;
    this.count += parents.length;
    this.nodes = withRoom(this.nodes, 3 * this.count);
    this.parents = withRoom(this.parents, this.count);
    this.nodes.set(nodes, 3 * from);
    this.parents.set(parents, from);
    this.upload(from);
  }
  /** Writes the segments of the nodes from this one on to the graphics card. @param {number} from */
  upload(from) {
    const segments = new Float32Array(6 * (this.count - from));
    for (let i = from; i < this.count; i++) {
      this.segment(i, segments, 6 * (i - from));
      if (this.parents[i] < 0) this.roots.append(this.nodes.slice(3 * i, 3 * i + 3), () => [1, 1, 1, 0.6]);
    }
    this.lines.append(segments, () => [...WHITE]);
  }
  /** @param {number} i @param {Float32Array} out @param {number} at */
  segment(i, out, at) {
    const parent = this.parents[i] < 0 ? i : this.parents[i];
    for (let k = 0; k < 3; k++) {
      out[at + k] = this.nodes[3 * parent + k];
      out[at + 3 + k] = this.nodes[3 * i + k];
    }
  }
  /** @param {Uint32Array} nodes @param {Int32Array} parents */
  rewire(nodes, parents) {
    const segment = new Float32Array(6);
    nodes.forEach((node, i) => {
      this.parents[node] = parents[i];
      this.segment(node, segment, 0);
      this.lines.replace(node, segment);
    });
  }
  /** Keeps only some nodes: node i becomes what `survivors[i]` was. @param {Uint32Array} survivors */
  prune(survivors) {
    const now = new Int32Array(this.count).fill(-1);
    survivors.forEach((old, i) => (now[old] = i));
    const { nodes, parents } = this;
    this.nodes = new Float32Array(3 * survivors.length);
    this.parents = new Int32Array(survivors.length);
    survivors.forEach((old, i) => {
      this.nodes.set(nodes.subarray(3 * old, 3 * old + 3), 3 * i);
      this.parents[i] = parents[old] < 0 ? -1 : now[parents[old]];
    });
    this.count = survivors.length;
    this.lines.clear();
    this.roots.clear();
    this.upload(0);
  }
}
