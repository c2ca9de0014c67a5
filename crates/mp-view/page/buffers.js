// Buffers on the graphics card: shapes, and lines and points that can grow.

/** @import { Shape } from "mp/shapes.js" */
/** @typedef {[number, number, number, number]} Rgba between 0 and 1 */

/** @param {WebGL2RenderingContext} gl @param {string} vertex @param {string} fragment @returns {WebGLProgram} */
export function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, source] of /** @type {[number, string][]} */ ([[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]])) {
    const shader = /** @type {WebGLShader} */ (gl.createShader(kind));
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(/** @type {WebGLProgram} */ (made), shader);
  }
  const linked = /** @type {WebGLProgram} */ (made);
  gl.linkProgram(linked);
  if (!gl.getProgramParameter(linked, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error(`The graphics card refused a program of this page: ${gl.getProgramInfoLog(linked)}`);
  }
  return linked;
}

/** The places of all uniforms of a program. @param {WebGL2RenderingContext} gl @param {WebGLProgram} of
 * @returns {Record<string, WebGLUniformLocation | null>} */
export function uniforms(gl, of) {
  /** @type {Record<string, WebGLUniformLocation | null>} */ const out = {};
  const count = gl.getProgramParameter(of, gl.ACTIVE_UNIFORMS) ?? 0;
  for (let i = 0; i < count; i++) {
    const name = gl.getActiveUniform(of, i)?.name ?? "";
    out[name] = gl.getUniformLocation(of, name);
  }
  return out;
}

/** A buffer that keeps what it has when it grows. */
class GrowingBuffer {
  constructor(/** @type {WebGL2RenderingContext} */ gl) {
    this.gl = gl;
    this.buffer = gl.createBuffer();
    this.size = 0;
    this.room = 0;
  }
  append(/** @type {ArrayBufferView} */ bytes) {
    const gl = this.gl;
    if (this.size + bytes.byteLength > this.room) this.grow(this.size + bytes.byteLength);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferSubData(gl.ARRAY_BUFFER, this.size, bytes);
    this.size += bytes.byteLength;
  }
  /** @param {number} needed bytes */
  grow(needed) {
    const gl = this.gl;
    const old = this.buffer;
    this.room = this.size ? Math.max(needed, 2 * this.room) : needed;
    this.buffer = gl.createBuffer();
    gl.bindBuffer(gl.COPY_WRITE_BUFFER, this.buffer);
    gl.bufferData(gl.COPY_WRITE_BUFFER, this.room, gl.DYNAMIC_DRAW);
    gl.bindBuffer(gl.COPY_READ_BUFFER, old);
    if (this.size) gl.copyBufferSubData(gl.COPY_READ_BUFFER, gl.COPY_WRITE_BUFFER, 0, 0, this.size);
    gl.bindBuffer(gl.COPY_READ_BUFFER, null);
    gl.deleteBuffer(old);
  }
}

/** Bytes of a corner: three coordinates and a colour of four bytes. */
const CORNER = 16;

/** Rows of some corners, which have the colour of their row. */
class ColoredRows {
  /** @param {WebGL2RenderingContext} gl @param {number} corners of a row */
  constructor(gl, corners) {
    this.gl = gl; this.corners = corners;
    /** Coordinates of a row. */ this.floats = 3 * corners;
    this.stride = CORNER * corners;
    this.rows = new GrowingBuffer(gl);
    this.vao = gl.createVertexArray();
  }
  get count() { return this.rows.size / this.stride; }
  /** The bytes of rows. @param {Float32Array} coordinates @param {(row: number) => Rgba} color */
  packed(coordinates, color) {
    const count = coordinates.length / this.floats;
    const bytes = new Uint8Array(count * this.stride);
    const numbers = new Float32Array(bytes.buffer);
    for (let i = 0; i < count; i++) {
      const rgba = color(i);
      for (let c = i * this.corners; c < (i + 1) * this.corners; c++) {
        for (let k = 0; k < 3; k++) numbers[4 * c + k] = coordinates[3 * c + k];
        for (let k = 0; k < 4; k++) bytes[CORNER * c + 12 + k] = Math.round(255 * rgba[k]);
      }
    }
    return bytes;
  }
  /** Adds rows at the end. @param {Float32Array} coordinates @param {(row: number) => Rgba} color of the row with this number among the new ones */
  append(coordinates, color) {
    if (!coordinates.length) return;
    this.rows.append(this.packed(coordinates, color));
    this.bind();
  }
  /** Writes rows again, from this one on. @param {number} first @param {Float32Array} coordinates @param {(row: number) => Rgba} color as in `append` */
  rewrite(first, coordinates, color) {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.rows.buffer);
    this.gl.bufferSubData(this.gl.ARRAY_BUFFER, first * this.stride, this.packed(coordinates, color));
  }
  /** Gives a row other coordinates. @param {number} row @param {Float32Array} coordinates */
  replace(row, coordinates) {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.rows.buffer);
    for (let c = 0; c < this.corners; c++) this.gl.bufferSubData(this.gl.ARRAY_BUFFER, row * this.stride + c * CORNER, coordinates, 3 * c, 3);
  }
  /** Tells the vertex array where the corners are, as the buffer may be a new one. */
  bind() {
    const gl = this.gl;
    gl.bindVertexArray(this.vao);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.rows.buffer);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, CORNER, 0);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 4, gl.UNSIGNED_BYTE, true, CORNER, 12);
    gl.bindVertexArray(null);
  }

  /** Forgets all rows. */
  clear() { this.rows.size = 0; }

  /** Frees the memory on the graphics card. */
  free() {
    this.gl.deleteVertexArray(this.vao);
    this.gl.deleteBuffer(this.rows.buffer);
  }
}

/** Segments: two ends and a colour each. They are drawn as lines of one pixel, or as strips of any width: a copy of the strip for each, which
 * takes software that draws some twenty times as long. */
export class LineSet extends ColoredRows {
  /** @param {WebGL2RenderingContext} gl @param {WebGLBuffer | null} strip the corners of a strip */
  constructor(gl, strip) {
    super(gl, 2);
    this.strip = strip;
    this.strips = gl.createVertexArray();
  }
  bind() {
    super.bind();
    const gl = this.gl;
    gl.bindVertexArray(this.strips);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.strip);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 8, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.rows.buffer);
    for (const [at, size, type, offset] of [[1, 3, gl.FLOAT, 0], [2, 3, gl.FLOAT, CORNER], [3, 4, gl.UNSIGNED_BYTE, 12]]) {
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, size, type, type !== gl.FLOAT, this.stride, offset);
      gl.vertexAttribDivisor(at, 1);
    }
    gl.bindVertexArray(null);
  }
  free() {
    super.free();
    this.gl.deleteVertexArray(this.strips);
  }
}

/** Points: a place and a colour each; the fourth number of the colour is the size as a part of 16 pixels. */
export class PointSet extends ColoredRows {
  constructor(/** @type {WebGL2RenderingContext} */ gl) { super(gl, 1); }
}

/** Numbers of a copy of a shape: pose (7), colour (4), how it is cut (1), how it is stretched (3). */
export const COPY = 15;

/** A shape on the graphics card. The corners are there once; triangles and edges have a vertex array each. */
export class ShapeBuffers {
  /** @param {WebGL2RenderingContext} gl @param {Shape} shape @param {WebGLBuffer | null} copies @param {WebGLBuffer | null} strip */
  constructor(gl, shape, copies, strip) {
    this.gl = gl; this.shape = shape; this.copies = copies;
    this.corners = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.corners);
    gl.bufferData(gl.ARRAY_BUFFER, shape.positions, gl.STATIC_DRAW);
    /** @type {(WebGLBuffer | null)[]} */ this.indices = [];
    this.triangles = this.indexed(shape.triangles);
    this.edges = this.indexed(shape.edges);
    /** @type {{vao: WebGLVertexArrayObject | null, count: number} | null} */ this.allEdges = null;
    this.lines = new LineSet(gl, strip);
    this.lines.append(shape.segments, () => [1, 1, 1, 1]);
  }
  /** All edges; made when they are first drawn. */
  get wire() { return (this.allEdges ??= this.indexed(this.shape.wire)); }
  indexed(/** @type {Uint32Array} */ indices) {
    const gl = this.gl;
    const vao = gl.createVertexArray();
    gl.bindVertexArray(vao);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.corners);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 12, 0);
    this.indices.push(gl.createBuffer());
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.indices[this.indices.length - 1]);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
    for (let at = 1; at <= 5; at++) {
      gl.enableVertexAttribArray(at);
      gl.vertexAttribDivisor(at, 1);
    }
    gl.bindVertexArray(null);
    return { vao, count: indices.length };
  }
  /** Frees the memory on the graphics card. */
  free() {
    const gl = this.gl;
    for (const part of [this.triangles, this.edges, this.allEdges]) gl.deleteVertexArray(part?.vao ?? null);
    for (const buffer of [this.corners, ...this.indices]) gl.deleteBuffer(buffer);
    this.lines.free();
  }
  /** Takes the copies from the one with this index on. @param {number} first */
  bindCopies(first) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.copies);
    for (const [at, size, offset] of [[1, 3, 0], [2, 4, 3], [3, 4, 7], [4, 1, 11], [5, 3, 12]]) {
      gl.vertexAttribPointer(at, size, gl.FLOAT, false, 4 * COPY, 4 * (first * COPY + offset));
    }
  }
}

/** An image: a rectangle of cells, each of one colour. */
export class ImageSet {
  constructor(/** @type {WebGL2RenderingContext} */ gl) {
    this.gl = gl;
    this.texture = gl.createTexture();
    /** What it was written for. @type {object | null} */ this.owner = null;
  }
  /** @param {object} owner @param {number} width @param {number} height @param {Uint8Array} pixels red, green, blue, opacity of each cell, the lowest row first */
  write(owner, width, height, pixels) {
    const gl = this.gl;
    this.owner = owner;
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, width, height, 0, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    for (const axis of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, axis, gl.CLAMP_TO_EDGE);
  }
}
