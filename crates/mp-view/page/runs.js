// The runs of this page in a table: choose one to see its path and its search, and a second one to compare.

import { brief, byId, el } from "mp/dom.js";
import { RunLayer, RunPicture } from "mp/live.js";
import { clearanceOf, reportFacts, totalTime } from "mp/panels.js";

/** @import { Message } from "mp/message.js" */
/** @import { Path, Scene } from "mp/scene.js" */
/** @import { Viewer } from "mp/viewer.js" */
/** @typedef {{id: number, planner: string, seed: number, state: string, progress: Message, report: Message | null, path: number,
 *  picture: RunPicture | null, note: string, ends: Message, found: Float64Array | null, cells: HTMLElement[], row: HTMLElement, choose: HTMLInputElement, compare: HTMLInputElement,
 *  of: string, columns: number, robot: number, track: Path | null}} Run
 *  `path` is −1 where there is none; `picture` is null for the searches of older runs; `ends` are start and goals of its request, and
 *  `found` the configurations of the last path found, before it is finished. `of` says which scene it planned in, with so many `columns` and
 *  bodies of the robot; `track` is its path after the scene was changed. */

/** Of how many runs the searches are kept. */
const KEPT = 3;
const HEADS = ["Show", "Compare", "Run", "Planner", "Seed", "Result", "Time", "Iterations", "Nodes", "Length", "Clearance"];

/** Whether the run has ended. @param {Run} run */
export const ended = (run) => run.state === "done" || run.state === "failed";

/** What is in the cells of a run. @param {Run} run @param {Path | null} path @param {boolean} old whether it is of the scene before @returns {string[]} */
function words({ id, planner, seed, state, progress, report, note }, path, old) {
  const from = report ?? progress;
  const number = (/** @type {unknown} */ value, unit = "") => (typeof value === "number" ? `${brief(value)}${unit}` : "–");
  const result = (report?.solved ? "verified path" : report ? (report.why ?? "no path") : note || state) + (old ? ", of the scene before" : "");
  const counts = [number(report?.stages ? totalTime(report) : from.time_s, "\u202fs"), number(from.iterations), number(from.nodes)];
  return [String(id), planner, String(report?.seed ?? seed), result, ...counts, number(report?.path_length ?? progress.length), clearanceOf(report ?? {}, path) || "–"];
}

export class Runs {
  constructor(/** @type {Viewer} */ viewer) {
    this.viewer = viewer;
    this.layer = new RunLayer();
    viewer.addLayer(this.layer);
    /** @type {Run[]} */ this.all = [];
    /** @type {Run | null} */ this.chosen = null;
    /** @type {Run | null} */ this.compared = null;
    /** The scene that has the paths. @type {Scene} */ this.scene = viewer.scene;
    /** Which scene that is: of equal ones the runs are the same. */ this.of = "";
    this.body = el("tbody", {});
    const heads = el("tr", {}, ...HEADS.map((head) => el("th", { scope: "col" }, head)));
    this.facts = el("div", { class: "facts" });
    const table = el("table", {}, el("caption", {}, "Runs"), el("thead", {}, heads), this.body);
    byId("runs").replaceChildren(el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Table of runs" }, table), this.facts);
  }
  /** Whether the scene was changed since the run. @param {Run} run */
  isOld(run) { return run.of !== this.of; }

  /** @param {Run} run */
  pathOf(run) { return this.scene.paths[run.path] ?? null; }

  /** The scene was changed, or a change was taken back: all runs stay, and their paths where the robot can be shown on them. @param {string} of */
  keep(of) {
    const { viewer, chosen, compared } = this;
    const { scene } = viewer;
    for (const run of this.all) {
      run.track = this.scene.paths[run.path] ?? run.track;
      const fits = run.track && run.columns === scene.columns.length && run.robot === scene.robot;
      run.path = fits && run.track ? viewer.addPath(run.track) : -1;
    }
    this.scene = scene;
    this.of = of;
    for (const run of this.all) this.update(run);
    if (!chosen) return;
    this.choose(chosen);
    this.compare(compared);
  }
  /** Forgets all runs: another scene was opened. @param {string} of */
  clear(of) {
    this.scene = this.viewer.scene;
    this.of = of;
    for (const run of this.all) this.drop(run);
    this.all = [];
    this.chosen = this.compared = null;
    this.layer.shown = null;
    this.body.replaceChildren();
    this.facts.replaceChildren();
    byId("runs").hidden = true;
  }
  /** Frees the search of a run. @param {Run} run */
  drop(run) {
    if (!run.picture) return;
    this.layer.all.delete(run.picture);
    run.picture.free();
    run.picture = null;
  }
  /** A run begins, and is shown. @param {number} id @param {string} planner @param {number} seed @param {Message} ends @returns {Run} */
  begin(id, planner, seed, ends) {
    const choose = el("input", { type: "radio", name: "path", "aria-label": `Show run ${id}`, onchange: () => this.choose(run) });
    const compare = el("input", { type: "checkbox", "aria-label": `Compare with run ${id}`, onchange: () => this.compare(compare.checked ? run : null) });
    const cells = HEADS.slice(2).map(() => el("td", {}));
    const row = el("tr", {}, el("td", {}, choose), el("td", {}, compare), ...cells);
    const { renderer, scene } = this.viewer;
    const picture = renderer ? new RunPicture(renderer) : null;
    /** @type {Run} */ const run = { id, planner, seed, state: "starting", progress: {}, report: null, path: -1, picture, note: "", ends, found: null, cells, row, choose, compare,
      of: this.of, columns: scene.columns.length, robot: scene.robot, track: null };
    if (picture) this.layer.all.add(picture);
    this.all.push(run);
    for (const old of this.all.filter((r) => r.picture).slice(0, -KEPT)) this.drop(old);
    byId("runs").hidden = false;
    this.body.prepend(row);
    this.choose(run);
    this.update(run);
    return run;
  }
  /** Shows the run's figures. @param {Run} run */
  update(run) {
    words(run, this.pathOf(run), this.isOld(run)).forEach((text, i) => { if (run.cells[i].textContent !== text) run.cells[i].textContent = text; });
    const ready = run.path >= 0;
    run.compare.disabled = !ready;
    if (run === this.chosen || run === this.compared) this.showFacts();
  }
  choose(/** @type {Run} */ run) {
    this.chosen = run;
    run.choose.checked = true;
    if (this.compared === run) this.compare(null);
    this.layer.shown = run.picture;
    this.viewer.choosePath(run.path);
    this.showFacts();
  }
  /** Shows a second run beside the chosen one. @param {Run | null} run */
  compare(run) {
    this.compared = run === this.chosen ? null : run;
    for (const other of this.all) other.compare.checked = other === this.compared;
    this.viewer.compare(this.compared?.path ?? -1);
    this.showFacts();
  }
  /** The figures of two runs beside each other. */
  showFacts() {
    const [a, b] = [this.chosen, this.compared];
    if (!a?.report || !b?.report) return this.facts.replaceChildren();
    const other = new Map(reportFacts(b.report));
    const rows = reportFacts(a.report).map(([name, value]) =>
      el("tr", {}, el("th", { scope: "row" }, name), el("td", {}, value), el("td", {}, other.get(name) ?? "–")));
    const head = el("tr", {}, el("td", {}), el("th", { scope: "col", class: "chosen" }, `Run ${a.id}`), el("th", { scope: "col", class: "compared" }, `Run ${b.id}`));
    this.facts.replaceChildren(el("table", {}, el("caption", {}, "Compared"), el("thead", {}, head), el("tbody", {}, ...rows)));
  }
}
