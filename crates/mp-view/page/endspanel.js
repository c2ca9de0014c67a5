// The panel for start and goals: a slider and a number for each column, and what the planner says about the configuration.

import { brief, button, coordinate, el, labelled, section, select } from "mp/dom.js";

/** @import { End, Verdict } from "mp/ends.js" */
/** @import { Workbench } from "mp/workbench.js" */

/** Steps of a slider from end to end. */
const STEPS = 500;
const FULL_TURN = 2 * Math.PI;

/** @param {End} end @param {number} goals */
const endName = (end, goals) => (end === "start" ? "Start" : goals > 1 ? `Goal ${end + 1}` : "Goal");

export class EndsPanel {
  constructor(/** @type {Workbench} */ workbench) {
    this.workbench = workbench;
    this.ends = workbench.ends;
    /** @type {End} */ this.end = "start";
    /** @type {{slider: HTMLInputElement, number: HTMLInputElement, degrees: HTMLElement | null}[]} */ this.fields = [];
    this.choice = el("div", {});
    this.columns = el("div", { class: "columns" });
    this.verdict = el("div", { role: "status", class: "verdict" });
    this.panel = section("Start and goal", false, [this.choice, this.columns, this.verdict]);
    this.panel.hidden = true;
    this.panel.addEventListener("toggle", () => this.checkOnce());
    workbench.viewer.addPanel(this.panel);
    workbench.onopened.push(() => this.show());
    workbench.onleft.push(() => (this.panel.hidden = true));
    this.ends.onchange.push((end) => this.changed(end));
  }
  /** Shows the ends of another scene. */
  show() {
    const { scene } = this.workbench.viewer;
    this.panel.hidden = !scene.columns.length;
    if (this.end !== "start" && !scene.goals[this.end]) this.end = "start";
    /** @type {[string, string][]} */
    const options = [["start", "Start"], ...scene.goals.map((_, i) => /** @type {[string, string]} */ ([String(i), endName(i, scene.goals.length)]))];
    const choose = (/** @type {string} */ value) => this.choose(value === "start" ? "start" : Number(value));
    this.choice.replaceChildren(labelled("Configuration", select(options, String(this.end), choose)));
    this.buildColumns();
    this.checkOnce();
  }
  /** @param {End} end */
  choose(end) {
    this.end = end;
    this.showRow();
    this.checkOnce();
  }
  /** Asks the planner about the end that is shown, unless it has answered. */
  checkOnce() {
    const { ends, end } = this;
    if (this.panel.open && ends.at(end) && !ends.verdicts.has(end) && !ends.errors.has(end)) ends.check(end);
    this.showVerdict();
  }
  buildColumns() {
    const { scene } = this.workbench.viewer;
    this.fields = scene.columns.map(({ name, unit }, k) => {
      const [low, high] = scene.limits[k] ?? this.range(k);
      const slider = el("input", { type: "range", min: low, max: high, step: (high - low) / STEPS || "any", "aria-label": `${name} as a slider`, oninput: () => this.move(k, slider.valueAsNumber, false), onchange: () => this.move(k, slider.valueAsNumber, true) });
      // What is typed stays until it is taken, while answers about the value of before come.
      const taken = (/** @type {() => void} */ then) => () => { delete number.dataset.typed; then(); };
      const number = el("input", { type: "number", step: "any", "aria-label": `${name} ${unit}`, oninput: () => { number.dataset.typed = ""; }, onblur: taken(() => this.showRow()), onchange: taken(() => this.move(k, number.valueAsNumber, true)) });
      return { slider, number, degrees: unit === "rad" ? el("small", { "aria-hidden": "true" }) : null };
    });
    const rows = this.fields.map(({ slider, number, degrees }, k) =>
      el("div", { class: "column" }, el("span", {}, scene.columns[k].name), slider, number, el("span", { class: "unit" }, scene.columns[k].unit, ...(degrees ? [degrees] : []))));
    this.columns.replaceChildren(...rows);
    this.showRow();
  }
  /** The range of a column without limits: a turn for angles, otherwise around the scene. @param {number} k @returns {[number, number]} */
  range(k) {
    const { scene } = this.workbench.viewer;
    if (scene.columns[k].unit === "rad") return [-FULL_TURN / 2, FULL_TURN / 2];
    const axis = Math.max(0, ["x", "y", "z"].indexOf(scene.columns[k].name[0]));
    const [low, high] = [scene.bounds[0][axis], scene.bounds[1][axis]];
    const margin = (high - low) / 4 || 1;
    return [low - margin, high + margin];
  }
  /** @param {number} k the column @param {number} value @param {boolean} settled */
  move(k, value, settled) {
    const now = this.ends.at(this.end);
    if (!now || !Number.isFinite(value)) return this.showRow();
    const row = [...now.row];
    row[k] = value;
    this.ends.set(this.end, row, { settled });
  }
  /** @param {End} end */
  changed(end) {
    if (end !== this.end) return;
    this.showRow();
    this.showVerdict();
  }
  showRow() {
    const row = this.ends.at(this.end)?.row ?? [];
    this.fields.forEach(({ slider, number, degrees }, k) => {
      if (row[k] === undefined) return;
      slider.valueAsNumber = row[k];
      const typing = number.dataset.typed !== undefined || (document.activeElement === number && number.valueAsNumber === row[k]);
      if (!typing) number.value = coordinate(row[k]);
      if (degrees) degrees.textContent = `${((row[k] * 360) / FULL_TURN).toFixed(1)}°`;
    });
  }
  showVerdict() {
    const { ends, end } = this;
    const verdict = ends.verdicts.get(end);
    const error = ends.errors.get(end);
    const help = error && "help" in error && typeof error.help === "string" ? [el("small", {}, error.help)] : [];
    if (error) this.verdict.replaceChildren(el("strong", { class: "bad" }, error.message), ...help);
    else if (verdict) this.verdict.replaceChildren(...this.explanation(verdict));
    else if (!ends.unchecked.has(end) && !ends.asking) this.verdict.replaceChildren();
    this.verdict.classList.toggle("old", !verdict && !error);
  }
  /** Why a configuration is refused, or how far it is from the nearest obstacle. @param {Verdict} v @returns {HTMLElement[]} */
  explanation(v) {
    const clearance = typeof v.clearance === "number" ? `, clearance ${brief(v.clearance)} m` : "";
    if (v.free) return [el("strong", { class: "good" }, `Free${clearance}`)];
    const reasons = [...(v.in_bounds ? [] : ["It is outside the limits."]), ...v.touching.map((what) => `Touches ${what}`)];
    // A collision is named by what it touches.
    if (v.fault && !v.touching.length) reasons.push(v.fault);
    const parts = [el("strong", { class: "bad" }, "Refused"), el("ul", {}, ...reasons.map((reason) => el("li", {}, reason)))];
    const near = v.nearest_free;
    if (near) parts.push(button(v.in_bounds ? "Take the nearest free configuration" : "Take the nearest place in bounds", () => this.ends.set(this.end, near)));
    else parts.push(el("small", {}, "No free configuration was found near it. Move it away from what it touches."));
    return parts;
  }
}
