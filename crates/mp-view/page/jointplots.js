// A trajectory as small plots over its time, one for each joint: position, velocity or acceleration, with the limits. Press or drag in one
// to go to a time.

import { el, whileHeld } from "mp/dom.js";

/** @import { Path, Scene } from "mp/scene.js" */

/** What can be plotted, in the order of derivatives: key, words of the list, unit behind that of the joint. @type {[key: string, name: string, per: string][]} */
export const OF_JOINTS = [["positions", "all joints: position", ""], ["velocities", "all joints: velocity", "/s"], ["accelerations", "all joints: acceleration", "/s²"]];

/** Plots beside each other, at most. */
const MOST_COLUMNS = 5;

/** An element of a drawing. @param {string} tag @param {Record<string, string | number>} properties */
function drawn(tag, properties) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(properties)) element.setAttribute(name, String(value));
  return element;
}

/** The numbers of a joint along a trajectory. @param {Path} path @param {number} joint @param {number} order 1 for velocities, 2 for accelerations */
export function numbersOf({ rows, count, trajectory }, joint, order) {
  const all = [rows, trajectory?.velocities ?? rows, trajectory?.accelerations ?? rows][order];
  return Array.from({ length: count }, (_, i) => all[i * (all.length / count) + joint]);
}

/** The lower and the upper end of a plot. Limits of velocity and acceleration are seen always; those of position where they are no farther
 * from the curve than this is high, as a curve would be flat otherwise. @param {number[]} numbers @param {[number, number] | null} limits
 * @param {boolean} always @returns {[number, number]} */
export function endsOf(numbers, limits, always) {
  const [low, high] = numbers.reduce(([a, b], x) => [Math.min(a, x), Math.max(b, x)], [Infinity, -Infinity]);
  const size = high - low || 1;
  const seen = (limits ?? []).filter((limit) => always || (limit > low - size && limit < high + size));
  const [least, most] = [Math.min(low, ...seen), Math.max(high, ...seen)];
  const margin = 0.06 * (most - least || 1);
  return [least - margin, most + margin];
}

export class JointPlots {
  /** @param {(time: number) => void} scrub to a configuration */
  constructor(scrub) {
    this.scrub = scrub;
    this.element = el("div", { class: "joints", hidden: true });
    /** @type {{cursor: Element, value: HTMLElement, numbers: number[], words: (x: number) => string}[]} */ this.plots = [];
    this.last = 0;
  }
  /** Shows a trajectory. @param {Scene} scene @param {Path} path @param {number} order */
  show(scene, path, order) {
    this.last = path.count - 1;
    const made = scene.columns.map(({ name, unit }, k) => {
      const most = path.trajectory?.limits[k]?.[order - 1];
      const limits = order ? /** @type {[number, number] | null} */ (most ? [-most, most] : null) : scene.limits[k];
      return this.plot(name, `${unit}${OF_JOINTS[order][2]}`, numbersOf(path, k, order), limits, order);
    });
    // On a wide page rows of plots are equally long, as far as that goes.
    this.element.style.setProperty("--columns", String(Math.ceil(made.length / Math.ceil(made.length / MOST_COLUMNS))));
    this.element.replaceChildren(...made.map(({ element }) => element));
    this.plots = made;
  }
  /** @param {string} name @param {string} unit @param {number[]} numbers @param {[number, number] | null} limits @param {number} order */
  plot(name, unit, numbers, limits, order) {
    const ends = endsOf(numbers, limits, order > 0);
    const y = (/** @type {number} */ value) => ((ends[1] - value) / (ends[1] - ends[0])).toFixed(4);
    const level = (/** @type {string} */ kind, /** @type {number} */ value) => drawn("path", { class: kind, d: `M0 ${y(value)}H1` });
    const levels = [...(order ? [level("zero", 0)] : []), ...(limits ?? []).filter((limit) => limit > ends[0] && limit < ends[1]).map((limit) => level("limit", limit))];
    // An angle that passes its end goes on at the other.
    const jumps = (/** @type {number} */ i) => i === 0 || (order === 0 && unit === "rad" && Math.abs(numbers[i] - numbers[i - 1]) > Math.PI);
    const curve = drawn("path", { class: "curve", d: numbers.map((value, i) => `${jumps(i) ? "M" : "L"}${(i / (this.last || 1)).toFixed(4)} ${y(value)}`).join("") });
    const cursor = drawn("path", { class: "cursor" });
    const within = limits ? `, limits ${limits.map((limit) => limit.toFixed(2)).join(" and ")}` : "";
    const label = `${name}: ${Math.min(...numbers).toFixed(3)} to ${Math.max(...numbers).toFixed(3)} ${unit}${within}`;
    const picture = drawn("svg", { viewBox: "0 0 1 1", preserveAspectRatio: "none", role: "img", "aria-label": label });
    picture.append(...levels, curve, cursor);
    whileHeld(picture, (part) => this.scrub(part * this.last));
    const value = el("span", {});
    const element = el("div", { title: label }, el("header", {}, el("span", {}, name), value), picture);
    const most = order && limits ? ` of ${Number(limits[1].toPrecision(3))}` : "";
    return { element, cursor, value, numbers, words: (/** @type {number} */ x) => `${(Math.abs(x) < 0.005 ? 0 : x).toFixed(2)}${most} ${unit}` };
  }
  draw(/** @type {number} */ time) {
    for (const { cursor, value, numbers, words } of this.plots) {
      cursor.setAttribute("d", `M${time / (this.last || 1)} 0V1`);
      value.textContent = words(numbers[Math.round(time)]);
    }
  }
}
