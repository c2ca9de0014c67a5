// A quantity along the path as a small plot: clearance, a number of the configurations, or how the path bends. Press or drag in it to
// go to a configuration.

import { brief, select, whileHeld } from "mp/dom.js";
import { JointPlots, OF_JOINTS } from "mp/jointplots.js";

/** @import { Path, Scene } from "mp/scene.js" */
/** @typedef {ArrayLike<number>} Values  one for each configuration of a path */
/** @typedef {{key: string, name: string, unit: string, zero: boolean, period: number, of: (path: Path) => Values | null}} Quantity
 *  `zero`: the plot begins at zero; `period`: of an angle, or 0; `of` is null where a path does not have it. */
/** @typedef {{path: Path, values: Values, way: Values}} Curve  `way`: how far along the path each configuration is, 0 to 1 */

/** How far the robot has moved until each configuration, as a part of its whole way. Where that is not known, each step counts alike.
 * @param {Path} path @returns {Values} */
export function wayOf({ travel, count }) {
  const whole = travel?.[count - 1] ?? 0;
  if (travel && whole > 0) return Float64Array.from(travel, (x) => x / whole);
  return Float64Array.from({ length: count }, (_, i) => i / Math.max(1, count - 1));
}

/** The place of a part of the way among the configurations, as `time` of the settings has it. @param {Values} way @param {number} part */
export function timeAt(way, part) {
  let [low, high] = [0, way.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (way[middle] <= part) low = middle;
    else high = middle;
  }
  const step = way[high] - way[low];
  return step > 0 ? low + Math.max(0, Math.min(1, (part - way[low]) / step)) : high;
}

/** The part of the way at a time. @param {Values} way @param {number} time */
function partAt(way, time) {
  const i = Math.min(Math.floor(time), way.length - 1);
  const next = Math.min(i + 1, way.length - 1);
  return way[i] + (way[next] - way[i]) * (time - i);
}

/** The curvature of the trace at each of its points: one over the radius of the circle through the point and its neighbours, 1/m.
 * @param {Path} path @returns {Values} */
export function curvatureOf({ trace, count }) {
  const out = new Float64Array(count);
  const side = (/** @type {number} */ i, /** @type {number} */ j) => [0, 1, 2].map((k) => trace[3 * j + k] - trace[3 * i + k]);
  for (let i = 1; i + 1 < count; i++) {
    const [[ax, ay, az], [bx, by, bz], c] = [side(i - 1, i), side(i, i + 1), side(i - 1, i + 1)];
    const area = Math.hypot(ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx);
    const product = Math.hypot(ax, ay, az) * Math.hypot(bx, by, bz) * Math.hypot(...c);
    // Where the trace stands still it does not bend.
    out[i] = product > 1e-18 ? (2 * area) / product : 0;
  }
  return out;
}

/** How far the robot moves from each configuration to the next, metres. @param {Path} path @returns {Values | null} */
function stepsOf({ travel, count, trajectory }) {
  // Of a trajectory it has seconds.
  return trajectory ? null : travel && Float64Array.from({ length: count }, (_, i) => (i + 1 < count ? travel[i + 1] - travel[i] : travel[i] - (travel[i - 1] ?? travel[i])));
}

/** What can be plotted of the paths of a scene. @param {Scene} scene @returns {Quantity[]} */
export function quantitiesOf({ columns }) {
  const width = columns.length;
  const numbers = columns.map(({ name, unit }, k) => ({
    key: `column ${k}`, name, unit, zero: false, period: unit === "rad" ? 2 * Math.PI : 0,
    of: (/** @type {Path} */ { rows, count }) => Float64Array.from({ length: count }, (_, i) => rows[i * width + k]),
  }));
  return [
    { key: "clearance", name: "clearance", unit: "m", zero: true, period: 0, of: (path) => path.clearance },
    ...numbers,
    { key: "curvature", name: "curvature of the trace", unit: "1/m", zero: true, period: 0, of: curvatureOf },
    { key: "step", name: "step", unit: "m", zero: true, period: 0, of: stepsOf },
  ];
}

/** The least and the greatest of what is finite. @param {Values[]} all @returns {[number, number]} */
function rangeOf(all) {
  let [low, high] = [Infinity, -Infinity];
  for (const values of all) for (let i = 0; i < values.length; i++) if (Number.isFinite(values[i])) [low, high] = [Math.min(low, values[i]), Math.max(high, values[i])];
  return low <= high ? [low, high] : [0, 0];
}

export class PathPlot {
  /** @param {HTMLCanvasElement} canvas @param {(time: number) => void} scrub @param {() => void} changed */
  constructor(canvas, scrub, changed) {
    this.canvas = canvas; this.changed = changed;
    /** @type {Scene | null} */ this.scene = null;
    /** @type {Quantity[]} */ this.quantities = [];
    /** The one that is chosen; it stays when another path is shown. */ this.wanted = "clearance";
    /** @type {Quantity | null} */ this.quantity = null;
    /** Of the chosen path and of the one compared. @type {Curve[]} */ this.curves = [];
    this.control = select([], "", (key) => this.choose(key), { "aria-label": "Plot along the path" });
    this.joints = new JointPlots(scrub);
    whileHeld(canvas, (part) => { if (this.curves[0]) scrub(timeAt(this.curves[0].way, part)); });
  }
  /** @param {Scene | null} scene @param {(Path | null | undefined)[]} paths the chosen one, and the one compared */
  show(scene, paths) {
    if (scene && scene !== this.scene) {
      this.scene = scene;
      this.quantities = quantitiesOf(scene);
    }
    this.paths = paths.filter((path) => path?.count);
    const first = paths[0];
    const known = first?.count ? this.quantities.filter(({ of }) => of(first) !== null) : [];
    const ofJoints = first?.trajectory ? OF_JOINTS.map(([key, name]) => new Option(name, key)) : [];
    this.control.replaceChildren(...ofJoints, ...known.map(({ key, name, unit }) => new Option(unit ? `${name} (${unit})` : name, key)));
    const together = ofJoints.some(({ value }) => value === this.wanted);
    this.quantity = together ? null : (known.find(({ key }) => key === this.wanted) ?? known[0] ?? null);
    this.control.value = together ? this.wanted : (this.quantity?.key ?? "");
    this.control.hidden = !known.length;
    // Without a path its place is kept, so that the picture does not move.
    this.canvas.style.visibility = known.length ? "" : "hidden";
    this.fill();
  }
  /** @param {string} key of a quantity */
  choose(key) {
    this.wanted = key;
    this.quantity = this.quantities.find((q) => q.key === key) ?? null;
    this.fill();
    this.changed();
  }
  /** Computes the curves. */
  fill() {
    const { quantity, scene, joints, canvas } = this;
    const [first] = this.paths ?? [];
    const order = first?.trajectory ? OF_JOINTS.findIndex(([key]) => key === this.wanted) : -1;
    canvas.hidden = order >= 0;
    joints.element.hidden = order < 0;
    if (first && scene && order >= 0) joints.show(scene, first, order);
    this.curves = (this.paths ?? []).flatMap((path) => {
      const values = path && quantity?.of(path);
      return values ? [{ path, values, way: wayOf(path) }] : [];
    });
    /** Of all curves. */ this.range = rangeOf(this.curves.map(({ values }) => values));
    /** Of the chosen path. */ this.own = rangeOf(this.curves.slice(0, 1).map(({ values }) => values));
    const words = quantity && this.curves.length ? `${quantity.name} along the path: ${brief(this.own[0])} to ${brief(this.own[1])} ${quantity.unit}` : "";
    this.canvas.setAttribute("aria-label", words.charAt(0).toUpperCase() + words.slice(1));
  }
  draw(/** @type {number} */ time) {
    if (!this.joints.element.hidden) return this.joints.draw(time);
    const context = this.canvas.getContext("2d");
    const [curve] = this.curves;
    const { quantity, range, own } = this;
    if (!context || !curve || !quantity || !range || !own || this.canvas.clientWidth === 0) return;
    const ratio = devicePixelRatio || 1;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    context.scale(ratio, ratio);
    const style = getComputedStyle(this.canvas);
    const low = quantity.zero ? 0 : range[0];
    const size = range[1] - low || 1;
    const x = (/** @type {number} */ part) => 1 + part * (width - 2);
    const y = (/** @type {number} */ value) => height - 2 - ((Math.min(value, range[1]) - low) / size) * (height - 16);
    const colors = ["--path", "--compared"].map((name) => style.getPropertyValue(name));
    this.curves.slice().reverse().forEach((one) => stroke(context, one, quantity, { x, y }, colors[one === curve ? 0 : 1]));
    context.strokeStyle = style.color;
    context.beginPath();
    const now = x(partAt(curve.way, time));
    context.moveTo(now, 0);
    context.lineTo(now, height);
    context.stroke();
    context.fillStyle = style.color;
    context.font = "11px system-ui, sans-serif";
    const value = curve.values[Math.min(Math.round(time), curve.values.length - 1)];
    const extent = quantity.key === "clearance" ? `sampled, least ${brief(own[0])}` : `${brief(own[0])} to ${brief(own[1])}`;
    context.fillText(`${quantity.name} ${brief(value)} ${quantity.unit} (${extent} ${quantity.unit})`, 4, 11);
  }
}

/** @param {CanvasRenderingContext2D} context @param {Curve} curve @param {Quantity} quantity
 * @param {{x: (part: number) => number, y: (value: number) => number}} place @param {string} color */
function stroke(context, { values, way }, { zero, period }, { x, y }, color) {
  const last = values.length - 1;
  context.beginPath();
  for (let i = 0; i <= last; i++) {
    // An angle that passes its end goes on at the other.
    const jumps = i > 0 && period > 0 && Math.abs(values[i] - values[i - 1]) > period / 2;
    if (jumps) context.moveTo(x(way[i]), y(values[i]));
    else context.lineTo(x(way[i]), y(values[i]));
  }
  context.strokeStyle = color;
  context.lineWidth = 1.5;
  context.stroke();
  context.lineWidth = 1;
  if (!zero) return;
  context.lineTo(x(way[last]), y(0));
  context.lineTo(x(way[0]), y(0));
  context.globalAlpha = 0.2;
  context.fillStyle = color;
  context.fill();
  context.globalAlpha = 1;
}
