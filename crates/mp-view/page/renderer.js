// Draws a picture with WebGL2: first what is opaque, then lines and points, then what is transparent, far to near.

import { COPY, ImageSet, LineSet, PointSet, ShapeBuffers, program, uniforms } from "mp/buffers.js";
import { dot, normalize, place } from "mp/math.js";
import { IMAGE_FRAGMENT, IMAGE_VERTEX, LINE_FRAGMENT, LINE_VERTEX, POINT_FRAGMENT, POINT_VERTEX, SURFACE_FRAGMENT, SURFACE_VERTEX, THIN_VERTEX } from "mp/shaders.js";

/** @import { Camera } from "mp/camera.js" */
/** @import { Color, Palette } from "mp/colors.js" */
/** @import { Mat4, Numbers, Vec3 } from "mp/math.js" */
/** @import { Shape } from "mp/shapes.js" */
/** @typedef {"solid" | "transparent" | "wire"} Mode */
/** @typedef {"obstacle" | "robot" | "copy" | "compared" | "start" | "goal"} Role */
/** @typedef {{shape: number, pose: Numbers, at: number, color: Color, alpha: number, mode: Mode, cut: boolean, layer: number,
 *  stretch: Vec3, body: number, role: Role, index: number}} Item
 *  A copy of a shape; `index` is the number of the goal or of the configuration. Of surfaces at the same place, the one with the highest layer is seen. */
/** @typedef {{set: LineSet, count: number, width: number, color: Color | null, alpha: number, over: boolean}} Lines */
/** @typedef {{set: PointSet, count: number, color: Color | null, over: boolean}} Points
 *  What is `over` is drawn over transparent things. */
/** @typedef {{image: ImageSet, corner: Vec3, right: Vec3, up: Vec3}} Image an image of cells on a rectangle, below a scene of the plane */
/** @typedef {{items: Item[], images: Image[], lines: Lines[], points: Points[], plane: [number, number, number, number] | null, edges: boolean,
 *  flat: boolean}} Picture  `flat`: a planar scene, where later things hide earlier ones. */
/** @typedef {{first: number, count: number, item: Item, items: Item[]}} Batch copies that are drawn by one call */

/** How strong edges of wire are that surfaces of wire hide; and paths, trees and roadmaps, which are what one looks for. */
const [HIDDEN_EDGE, HIDDEN] = [0.15, 0.4];

const LOST = "This page needs WebGL2, which this browser does not offer or has switched off.";

export class Renderer {
  constructor(/** @type {HTMLCanvasElement} */ canvas) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
    if (!gl) throw new Error(LOST);
    this.gl = gl;
    this.surface = program(gl, SURFACE_VERTEX, SURFACE_FRAGMENT);
    this.line = program(gl, LINE_VERTEX, LINE_FRAGMENT);
    this.thin = program(gl, THIN_VERTEX, LINE_FRAGMENT);
    this.point = program(gl, POINT_VERTEX, POINT_FRAGMENT);
    this.imageProgram = program(gl, IMAGE_VERTEX, IMAGE_FRAGMENT);
    this.imageAt = uniforms(gl, this.imageProgram);
    this.surfaceAt = uniforms(gl, this.surface);
    this.lineAt = uniforms(gl, this.line);
    this.thinAt = uniforms(gl, this.thin);
    this.pointAt = uniforms(gl, this.point);
    this.copies = gl.createBuffer();
    this.copyNumbers = new Float32Array(64 * COPY);
    this.strip = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.strip);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([0, -1, 1, -1, 0, 1, 1, 1]), gl.STATIC_DRAW);
    /** @type {ShapeBuffers[]} */ this.shapes = [];
    this.calls = 0;
    this.triangles = 0;
    this.hidden = false;
  }
  /** Takes the shapes of another scene. Those that it has already stay on the graphics card, the others are freed. @param {Shape[]} shapes */
  setShapes(shapes) {
    const known = new Map(this.shapes.map((buffers) => [buffers.shape, buffers]));
    this.shapes = shapes.map((shape) => {
      const buffers = known.get(shape) ?? new ShapeBuffers(this.gl, shape, this.copies, this.strip);
      known.set(shape, buffers);
      return buffers;
    });
    const used = new Set(this.shapes);
    for (const buffers of known.values()) if (!used.has(buffers)) buffers.free();
  }
  lineSet() { return new LineSet(this.gl, this.strip); }

  pointSet() { return new PointSet(this.gl); }

  image() { return new ImageSet(this.gl); }

  /** @param {Picture} picture @param {Camera} camera @param {Palette} palette @param {number} ratio device pixels per pixel
   * @param {number} share of the lines below the traces */
  draw(picture, camera, palette, ratio, share) {
    const gl = this.gl;
    this.calls = 0;
    this.triangles = 0;
    this.frame = { camera, palette, ratio, share, ...camera.matrices() };
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    gl.clearColor(...palette.background, 1);
    gl.depthMask(true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(picture.flat ? gl.ALWAYS : gl.LEQUAL);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    const [low, middle, high, wire] = picture.flat ? layered(picture.items) : this.byDepth(picture.items);
    this.upload([...low, ...middle, ...high, ...wire]);
    if (picture.flat) this.drawImages(picture);
    this.drawSurfaces(low, 0, picture);
    if (!picture.flat) this.drawImages(picture);
    if (wire.length) {
      this.drawSurfaces(middle, low.length, picture);
      this.drawWire(wire, low.length + middle.length, picture);
    } else {
      this.drawLines(picture, false);
      this.drawPoints(picture, false);
      this.drawSurfaces(middle, low.length, picture);
      this.drawLines(picture, true);
      this.drawSurfaces(high, low.length + middle.length, picture);
      this.drawPoints(picture, true);
    }
    gl.bindVertexArray(null);
  }
  /** What is drawn before the lines, after them, after the traces, and with the lines. @param {Item[]} items @returns {Item[][]} */
  byDepth(items) {
    const opaque = items.filter((i) => i.mode !== "transparent").sort((a, b) => a.layer - b.layer);
    // A mesh without edges is not left out of wire pictures.
    const isWire = (/** @type {Item} */ i) => i.mode === "wire" && this.shapes[i.shape].shape.outlined;
    const transparent = this.farToNear(items.filter((i) => i.mode === "transparent"));
    return [opaque.filter((i) => !isWire(i)), transparent, [], opaque.filter(isWire)];
  }
  /** Wire and all lines. Surfaces of wire are not seen, and hide nothing but lines: what they hide is faint.
   * @param {Item[]} items @param {number} shift @param {Picture} picture */
  drawWire(items, shift, picture) {
    const gl = this.gl;
    for (const hidden of [true, false]) {
      this.hidden = hidden;
      if (!hidden) {
        gl.colorMask(false, false, false, false);
        this.useSurface(picture);
        for (const batch of grouped(items)) this.fill(this.shapes[batch.item.shape], batch, batch.first + shift);
        gl.colorMask(true, true, true, true);
      }
      this.drawSurfaces(items, shift, picture);
      for (const over of [false, true]) {
        this.drawLines(picture, over);
        this.drawPoints(picture, over);
      }
    }
  }
  farToNear(/** @type {Item[]} */ items) {
    const { back } = this.now.camera.axes();
    const depth = items.map((item) => {
      const { low, high } = this.shapes[item.shape].shape;
      /** @type {Vec3} */ const middle = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2];
      return dot(place(item.pose, item.at, middle), back);
    });
    return items.map((_, i) => i).sort((a, b) => depth[a] - depth[b]).map((i) => items[i]);
  }
  get now() {
    if (!this.frame) throw new Error("Nothing is being drawn.");
    return this.frame;
  }
  /** Writes the numbers of all copies to the graphics card. @param {Item[]} items */
  upload(items) {
    if (this.copyNumbers.length < items.length * COPY) this.copyNumbers = new Float32Array(2 * items.length * COPY);
    const out = this.copyNumbers;
    items.forEach((item, i) => {
      const o = i * COPY;
      for (let k = 0; k < 7; k++) out[o + k] = item.pose[item.at + k];
      for (let k = 0; k < 3; k++) out[o + 7 + k] = item.color[k];
      out[o + 10] = item.alpha;
      for (let k = 0; k < 3; k++) out[o + 12 + k] = item.stretch[k];
      out[o + 11] = item.cut ? (this.shapes[item.shape].shape.closed ? 2 : 1) : 0;
    });
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.copies);
    gl.bufferData(gl.ARRAY_BUFFER, out.subarray(0, items.length * COPY), gl.DYNAMIC_DRAW);
  }
  /** @param {Item[]} items @param {number} shift of the copies' indices @param {Picture} picture */
  drawSurfaces(items, shift, picture) {
    const gl = this.gl;
    let prepared = false;
    for (const batch of grouped(items)) {
      if (!prepared) this.useSurface(picture);
      const buffers = this.shapes[batch.item.shape];
      const first = batch.first + shift;
      const clear = batch.item.mode === "transparent";
      if (clear || batch.item.role === "copy" || this.hidden) gl.enable(gl.BLEND);
      gl.depthMask(!clear);
      if (batch.item.mode !== "wire" || !buffers.shape.outlined) this.fill(buffers, batch, first);
      if (batch.item.mode === "wire" || picture.edges) this.edges(buffers, batch, first);
      // Lines are drawn by another program.
      prepared = !buffers.lines.count;
      if (buffers.lines.count) this.bodyLines(buffers.lines, batch, picture);
      gl.disable(gl.BLEND);
      gl.depthMask(true);
    }
  }
  useSurface(/** @type {Picture} */ picture) {
    const gl = this.gl;
    const { view, projection, palette, camera } = this.now;
    const at = this.surfaceAt;
    gl.useProgram(this.surface);
    gl.uniformMatrix4fv(at.view, false, view);
    gl.uniformMatrix4fv(at.projection, false, projection);
    gl.uniform4fv(at.plane, picture.plane ?? [0, 0, 0, 1]);
    gl.uniform1f(at.cutting, picture.plane ? 1 : 0);
    gl.uniform1f(at.flatView, camera.perspective ? 0 : 1);
    gl.uniform3fv(at.cutColor, palette.cut);
    gl.uniform1f(at.strength, this.hidden ? HIDDEN_EDGE : 1);
    const sun = normalize([0.4, -0.6, 1]);
    gl.uniform3f(at.sun, ...rotated(view, sun));
  }
  /** @param {ShapeBuffers} buffers @param {Batch} batch @param {number} first */
  fill(buffers, batch, first) {
    const gl = this.gl;
    const { vao, count } = buffers.triangles;
    if (!count) return;
    gl.uniform1f(this.surfaceAt.shaded, 1);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    // Bodies at the same place differ in their last digits only; the layers are farther apart.
    gl.polygonOffset(1, 400 - 80 * batch.item.layer);
    // Of a transparent closed body only the outside is drawn, so that each of its faces counts once.
    if (batch.item.mode === "transparent" && buffers.shape.closed && !batch.item.cut) gl.enable(gl.CULL_FACE);
    gl.bindVertexArray(vao);
    buffers.bindCopies(first);
    gl.drawElementsInstanced(gl.TRIANGLES, count, gl.UNSIGNED_INT, 0, batch.count);
    gl.disable(gl.CULL_FACE);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    this.counted((count / 3) * batch.count);
  }
  /** @param {ShapeBuffers} buffers @param {Batch} batch @param {number} first */
  edges(buffers, batch, first) {
    const gl = this.gl;
    const wire = batch.item.mode === "wire";
    const { vao, count } = wire ? buffers.wire : buffers.edges;
    if (!count) return;
    const { palette } = this.now;
    gl.uniform1f(this.surfaceAt.shaded, 0);
    const alpha = wire ? 0 : batch.item.role === "copy" ? 0.4 : batch.item.mode === "transparent" ? 0.9 : 1;
    gl.uniform4f(this.surfaceAt.line, ...palette.edge, alpha);
    gl.bindVertexArray(vao);
    buffers.bindCopies(first);
    gl.drawElementsInstanced(gl.LINES, count, gl.UNSIGNED_INT, 0, batch.count);
    this.counted(0);
  }
  /** Lines that belong to a body: copy by copy. @param {LineSet} set @param {Batch} batch @param {Picture} picture */
  bodyLines(set, batch, picture) {
    for (const { pose, at, color, alpha, cut, mode } of batch.items) {
      const placed = [pose[at], pose[at + 1], pose[at + 2], pose[at + 3], pose[at + 4], pose[at + 5], pose[at + 6]];
      this.segments({ set, count: set.count, width: mode === "wire" ? 1.2 : 3, color, alpha }, picture, placed, cut);
    }
  }
  /** Lines of one pixel are drawn as such, wider ones as strips. @param {Pick<Lines, "set" | "count" | "width" | "color" | "alpha">} lines
   * @param {Picture} picture @param {readonly number[]} placed the pose @param {boolean} cut */
  segments({ set, count, width, color, alpha }, picture, placed, cut) {
    const gl = this.gl;
    const pixels = width * this.now.ratio;
    const thin = pixels < 1.5;
    const at = thin ? this.thinAt : this.lineAt;
    gl.useProgram(thin ? this.thin : this.line);
    gl.uniformMatrix4fv(at.both, false, this.now.both);
    gl.uniform4fv(at.plane, picture.plane ?? [0, 0, 0, 1]);
    gl.uniform3fv(at.origin, placed, 0, 3);
    gl.uniform4fv(at.turn, placed, 3, 4);
    gl.uniform4f(at.paint, ...(color ?? [0, 0, 0]), color ? alpha : 0);
    gl.uniform1f(at.cut, cut ? 1 : 0);
    gl.uniform1f(at.strength, this.hidden ? HIDDEN : 1);
    gl.bindVertexArray(thin ? set.vao : set.strips);
    if (thin) gl.drawArrays(gl.LINES, 0, 2 * count);
    else {
      gl.uniform2f(at.size, gl.drawingBufferWidth, gl.drawingBufferHeight);
      gl.uniform1f(at.width, pixels);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
    }
    this.counted(thin ? 0 : 2 * count);
  }
  /** @param {Picture} picture */
  drawImages({ images }) {
    if (!images.length) return;
    const gl = this.gl;
    gl.useProgram(this.imageProgram);
    gl.uniformMatrix4fv(this.imageAt.both, false, this.now.both);
    gl.bindVertexArray(null);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    for (const { image, corner, right, up } of images) {
      gl.uniform3fv(this.imageAt.corner, corner);
      gl.uniform3fv(this.imageAt.right, right);
      gl.uniform3fv(this.imageAt.up, up);
      gl.bindTexture(gl.TEXTURE_2D, image.texture);
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
      this.counted(2);
    }
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }
  /** Trees, roadmap and traces. @param {Picture} picture @param {boolean} over */
  drawLines(picture, over) {
    const gl = this.gl;
    gl.enable(gl.BLEND);
    for (const lines of picture.lines.filter((l) => l.over === over && l.count)) {
      const count = over ? lines.count : Math.ceil(lines.count * this.now.share);
      this.segments({ ...lines, count }, picture, [0, 0, 0, 0, 0, 0, 1], false);
    }
    gl.disable(gl.BLEND);
  }
  /** @param {Picture} picture @param {boolean} over */
  drawPoints(picture, over) {
    const gl = this.gl;
    gl.useProgram(this.point);
    gl.uniformMatrix4fv(this.pointAt.both, false, this.now.both);
    gl.uniform1f(this.pointAt.ratio, this.now.ratio);
    gl.uniform1f(this.pointAt.strength, this.hidden ? HIDDEN : 1);
    gl.enable(gl.BLEND);
    for (const { set, count, color } of picture.points.filter((p) => p.over === over && p.count)) {
      gl.uniform4f(this.pointAt.paint, ...(color ?? [0, 0, 0]), color ? 1 : 0);
      gl.bindVertexArray(set.vao);
      gl.drawArrays(gl.POINTS, 0, count);
      this.counted(0);
    }
    gl.disable(gl.BLEND);
  }
  counted(/** @type {number} */ triangles) {
    this.calls++;
    this.triangles += triangles;
  }
}

/** A direction of the world as the eye sees it. @param {Mat4} m @param {Vec3} v @returns {Vec3} */
function rotated(m, v) {
  const row = (/** @type {number} */ r) => m[r] * v[0] + m[4 + r] * v[1] + m[8 + r] * v[2];
  return [row(0), row(1), row(2)];
}

/** Of a planar scene: obstacles, start, goals and copies, the robot. @param {Item[]} items @returns {Item[][]} */
function layered(items) {
  const sorted = items.sort((a, b) => a.layer - b.layer);
  return [sorted.filter((i) => i.layer === 0), sorted.filter((i) => i.layer > 0 && i.layer < 4), sorted.filter((i) => i.layer === 4), []];
}

/** Neighbours that one call can draw. @param {Item[]} items @returns {Batch[]} */
function grouped(items) {
  /** @type {Batch[]} */ const batches = [];
  items.forEach((item, i) => {
    const last = batches[batches.length - 1]?.item;
    const joins = last && last.shape === item.shape && last.mode === item.mode && last.layer === item.layer && last.cut === item.cut;
    if (joins) {
      batches[batches.length - 1].count++;
      batches[batches.length - 1].items.push(item);
    } else batches.push({ first: i, count: 1, item, items: [item] });
  });
  return batches;
}
