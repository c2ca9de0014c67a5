// The panel that plans: planner, settings, budgets, and the run that goes on.

import { brief, button, checkbox, el, labelled, section, select, showError, slider } from "mp/dom.js";
import { isTyping } from "mp/controls.js";
import { FIELDS } from "mp/field.js";
import { clearanceOf, totalTime } from "mp/panels.js";
import { Runs, ended } from "mp/runs.js";
import { readPath } from "mp/scene.js";

/** @import { Message } from "mp/message.js" */
/** @import { Run } from "mp/runs.js" */
/** @import { Path } from "mp/scene.js" */
/** @import { Workbench } from "mp/workbench.js" */
/** @typedef {{name: string, range: string, default: string, summary: string}} Parameter */
/** @typedef {{name: string, aliases: string[], summary: string, family: "tree" | "roadmap",
 *  citation: string, parameters: Parameter[]}} PlannerInfo */
/** @typedef {{prefix: string, summary: string, around: string[] | null, parameters: Parameter[]}} MetaInfo */

/** @type {[string, string][]} */
const HELP = [
  ["R", "plan with these settings"], ["T", "pause and resume the run"], ["N", "some iterations, then pause"], ["K", "cancel the run"],
  ["V", "show where edges fail: motions that were not free"],
];
/** @type {[string, string][]} */
const FINISH = [["shorten", "shorten it"], ["relax", "relax it by a snake"], ["as-found", "leave it as found"]];

/** A field for a number that may be left empty. @param {number | null} value @param {Record<string, string | number>} [more] */
const numberField = (value, more = {}) => el("input", { type: "number", min: 0, value: value ?? "", placeholder: "no limit", ...more });

/** The number in a field, or null when it is empty. @param {HTMLInputElement} field */
const numberIn = (field) => (field.value.trim() === "" ? null : field.valueAsNumber);

/** What a planner is, its paper and its other names. @param {PlannerInfo} info */
function summaryOf({ summary, citation, aliases }) {
  const sentence = summary.charAt(0).toUpperCase() + summary.slice(1);
  return `${sentence}${citation ? ` (${citation})` : ""}.${aliases.length ? ` Also called ${aliases.join(", ")}.` : ""}`;
}

/** Whether a box is checked, and can be. @param {HTMLElement | undefined} box */
function isOn(box) {
  const input = box?.querySelector("input");
  return input ? input.checked && !input.disabled : false;
}

export class PlanningPanel {
  constructor(/** @type {Workbench} */ workbench) {
    this.workbench = workbench;
    this.viewer = workbench.viewer;
    this.runs = new Runs(workbench.viewer);
    /** @type {Run | null} */ this.run = null;
    this.count = 0;
    this.build();
    this.showPlanner();
    this.showState();
    workbench.onevent.push((event) => this.event(event));
    workbench.onopened.push((reply, how) => {
      this.suit(reply);
      this.opened(how);
    });
    workbench.onleft.push(() => this.opened("open"));
    workbench.onlost.push(() => this.lost());
    this.viewer.keys.push((e) => this.key(e));
    this.viewer.panels?.addHelp(HELP);
  }
  build() {
    const { planners, meta_planners: metas, metrics, request } = this.workbench.hello;
    /** @type {PlannerInfo[]} */ this.planners = planners;
    const group = (/** @type {string} */ family, /** @type {string} */ label) =>
      el("optgroup", { label }, ...planners.filter((/** @type {PlannerInfo} */ p) => p.family === family).map((/** @type {PlannerInfo} */ p) => el("option", { value: p.name }, p.name)));
    this.planner = el("select", { onchange: () => this.showPlanner() }, group("tree", "Trees"), group("roadmap", "Roadmaps"));
    this.planner.value = this.suggested = request.planner;
    // In a name, a meta-planner that runs only some planners stands next to them.
    const inOrder = [...metas].sort((a, b) => Number(a.around !== null) - Number(b.around !== null));
    this.metas = inOrder.map((/** @type {MetaInfo} */ meta) => ({ meta, box: checkbox(`${meta.prefix} ${meta.summary}`, false, () => this.showPlanner()) }));
    this.summary = el("small", {});
    this.parameters = el("div", { class: "content" });
    this.metric = select(metrics.map((/** @type {{name: string, formula: string}} */ m) => [m.name, m.formula ? `${m.name}: ${m.formula}` : m.name]), request.metric, () => {});
    const [motion, resolution] = request.motion.split(":");
    const step = el("input", { type: "text", value: resolution ?? "1%" });
    this.resolution = step;
    const stepRow = labelled("Step of the check", step);
    stepRow.hidden = motion !== "discrete";
    this.motion = select([["certified", "certified"], ["discrete", "discrete"]], motion, (value) => (stepRow.hidden = value !== "discrete"));
    this.clearance = numberField(request.clearance || null, { step: "any", min: 0, placeholder: "0" });
    this.seed = numberField(request.seed, { step: 1, max: Number.MAX_SAFE_INTEGER, placeholder: "0" });
    this.next = checkbox("another seed for each run", false, () => {});
    this.time = numberField(request.budget.time_s, { step: "any" });
    this.iterations = numberField(request.budget.iterations, { step: 1 });
    this.nodes = numberField(request.budget.nodes, { step: 1 });
    this.field = select(FIELDS, request.field, () => {});
    const fieldRow = labelled("In which field", this.field);
    fieldRow.hidden = request.finish !== "relax";
    this.finish = select(FINISH, request.finish, (value) => (fieldRow.hidden = value !== "relax"));
    this.first = checkbox("stop at the first path", request.first_only, () => {});
    const search = section("How to search", false, [
      labelled("Metric", this.metric), labelled("Motion check", this.motion), stepRow,
      labelled("Clearance to keep, m", this.clearance),
      labelled("Seed", this.seed), this.next,
      labelled("Most seconds", this.time), labelled("Most iterations", this.iterations), labelled("Most nodes", this.nodes),
      labelled("The path found", this.finish), fieldRow, this.first]);
    this.panel = section("Plan", true, [
      labelled("Planner", this.planner), this.summary, section("Settings of the planner", false, [this.parameters]),
      section("Around the planner", false, this.metas.map(({ box }) => box)), search, ...this.runControls()]);
    this.viewer.addPanel(this.panel);
  }
  /** Buttons of the run, and what it does. @returns {HTMLElement[]} */
  runControls() {
    const { layer } = this.runs;
    this.planButton = button("Plan", () => this.plan(false), { class: "main", title: "Plan (R)" });
    this.pauseButton = button("Pause", () => this.pause(), { title: "Pause or resume (T)" });
    this.stepButton = button("Step", () => this.step(), { title: "Some iterations, then pause (N)" });
    this.cancelButton = button("Cancel", () => this.cancel(), { title: "Cancel (K)" });
    this.nextButton = button("Next part", () => this.nextPart(), { title: "The motion goes on where this path ends" });
    this.stepSize = el("input", { type: "number", min: 1, value: 100, "aria-label": "Iterations of a step" });
    this.counts = el("p", { class: "counts" });
    this.status = el("p", { role: "status" });
    this.rejected = checkbox("Where edges fail", false, (on) => this.show(() => (layer.rejected = on)));
    const growth = slider({ low: 0, high: 1, step: "any", value: 1 }, (g) => this.show(() => (this.viewer.settings.growth = g)));
    this.growth = growth;
    return [
      el("div", { class: "buttons", role: "group", "aria-label": "Run" }, this.planButton, this.pauseButton, this.cancelButton, this.stepButton, this.stepSize, this.nextButton),
      this.status, this.counts,
      checkbox("Trees and roadmap of the run", true, (on) => this.show(() => (layer.search = on))), this.rejected,
      labelled("Growth", growth)];
  }
  show(/** @type {() => void} */ change) {
    change();
    this.viewer.changed();
  }
  /** Planners that cannot plan for the robot cannot be chosen, and say why. If such a planner was chosen, or the default one for the last
   * robot, the default one for this robot is. @param {Message} reply of “open” */
  suit({ planner, cannot }) {
    if (!this.planner || !planner) return;
    const reasons = new Map(/** @type {[string, string][]} */ (cannot));
    for (const option of this.planner.options) {
      option.disabled = reasons.has(option.value);
      option.title = reasons.get(option.value) ?? "";
    }
    if (this.planner.value === this.suggested || reasons.has(this.planner.value)) this.planner.value = planner;
    this.suggested = planner;
    this.showPlanner();
  }
  /** Shows the summary and the parameters of the planner that is chosen. */
  showPlanner() {
    const name = this.planner?.value ?? "";
    const info = this.planners?.find((p) => p.name === name);
    if (this.summary) this.summary.textContent = info ? summaryOf(info) : "";
    for (const { meta, box } of this.metas ?? []) {
      const input = box.querySelector("input");
      if (input) input.disabled = meta.around !== null && !meta.around.includes(name);
    }
    const known = new Map([...(this.parameters?.querySelectorAll("input") ?? [])].map((field) => [field.name, field.value]));
    const fields = [...(info?.parameters ?? []), ...this.around().flatMap((meta) => meta.parameters)].map((p) => {
      const field = el("input", { type: "text", placeholder: p.default, name: p.name, value: known.get(p.name) ?? "" });
      return el("div", {}, labelled(p.name, field), el("small", {}, p.range ? `${p.summary}; ${p.range}` : p.summary));
    });
    this.parameters?.replaceChildren(...(fields.length ? fields : ["This planner has no settings."]));
  }
  /** The meta-planners that are chosen, the outermost first. */
  around() { return (this.metas ?? []).filter(({ box }) => isOn(box)).map(({ meta }) => meta); }

  /** The request as docs/formats/report.md describes it. @returns {Message} */
  request() {
    /** @type {Record<string, string>} */ const settings = {};
    for (const field of this.parameters?.querySelectorAll("input") ?? []) if (field.value.trim()) settings[field.name] = field.value.trim();
    const value = (/** @type {HTMLInputElement | HTMLSelectElement | undefined} */ control) => control?.value ?? "";
    const limit = (/** @type {HTMLInputElement | undefined} */ field) => (field ? numberIn(field) : null);
    return {
      planner: this.around().map(({ prefix }) => prefix).join("") + value(this.planner),
      settings,
      metric: value(this.metric),
      motion: value(this.motion) === "discrete" ? `discrete:${value(this.resolution)}` : "certified",
      clearance: limit(this.clearance) ?? 0,
      budget: { time_s: limit(this.time), iterations: limit(this.iterations), nodes: limit(this.nodes) },
      seed: limit(this.seed) ?? 0,
      finish: value(this.finish),
      field: value(this.field),
      first_only: isOn(this.first),
      sharp_clearance: true,
    };
  }
  get going() { return this.run !== null && !ended(this.run); }

  /** Starts a run. @param {boolean} paused */
  async plan(paused) {
    if (this.going || !this.workbench.open) return;
    const request = this.request();
    const ends = this.workbench.ends.request();
    const run = this.runs.begin(++this.count, request.planner, request.seed, ends);
    this.run = run;
    this.viewer.settings.growth = 1;
    if (this.growth) this.growth.value = "1";
    showError("");
    this.showState();
    try {
      await this.workbench.session.request({ do: "plan", run: run.id, request, ...ends, paused });
    } catch (error) {
      // A run that has ended meanwhile has said why.
      if (!ended(run)) this.fail(run, error instanceof Error ? error.message : String(error), error);
    }
  }
  /** @param {string} what @param {object} [more] */
  async tell(what, more = {}) {
    const { run } = this;
    if (!run || !this.going) return;
    try {
      await this.workbench.session.request({ do: what, run: run.id, ...more });
    } catch (error) {
      // A run that has ended meanwhile needs no message.
      if (!ended(run)) showError(error);
    }
  }
  pause() { return this.tell(this.run?.state === "paused" ? "resume" : "pause"); }

  cancel() { return this.tell("cancel"); }

  async step() {
    if (!this.going) await this.plan(true);
    await this.tell("step", { iterations: Math.max(1, Math.round(this.stepSize?.valueAsNumber || 1)) });
  }
  /** The configuration where the chosen path ends, if it has been written. */
  get end() {
    const { chosen } = this.runs;
    return (chosen && !this.runs.isOld(chosen) && this.runs.pathOf(chosen)?.written?.at(-1)) || null;
  }

  nextPart() { return this.end && this.workbench.nextPart(this.end); }

  event(/** @type {Message} */ event) {
    const run = this.runs.all.find((r) => r.id === event.run);
    if (!run || ended(run)) return;
    if (event.event === "grown") run.picture?.grow(event);
    if (event.event === "progress") {
      run.progress = { ...run.progress, ...event };
      run.state = event.state;
    }
    if (event.event === "found") {
      run.progress.length = event.length;
      run.found = event.rows;
    }
    if (event.event === "done") this.finished(run, event);
    if (event.event === "failed") {
      this.fail(run, event.message, event.cancelled ? null : Object.assign(new Error(event.message), { help: event.help }));
      if (run.found && !this.runs.isOld(run)) this.keep(run, run.found);
    }
    this.update(run);
  }
  /** @param {Run} run @param {Message} event */
  finished(run, { report, path }) {
    run.state = "done";
    run.report = report;
    if (path) this.addPath(run, readPath(path, run.columns, run.robot), report.path ?? null);
    const seed = this.seed;
    if (seed && isOn(this.next)) seed.valueAsNumber = (numberIn(seed) ?? 0) + 1;
    if (!report.solved && !this.runs.isOld(run)) this.explain();
  }
  /** Shows the path of a run. @param {Run} run @param {Path} path @param {number[][] | null} written */
  addPath(run, path, written) {
    run.track = { ...path, name: `run ${run.id}: ${run.planner}`, ofRun: true, written };
    const { columns, robot } = this.viewer.scene;
    if (run.columns === columns.length && run.robot === robot) run.path = this.viewer.addPath(run.track);
    if (this.runs.chosen === run) this.runs.choose(run);
  }
  /** Keeps the path of a run that was ended before it had finished it, if the planner's verifier passes it as it would be written.
   * @param {Run} run @param {Float64Array} found its configurations, one after the other */
  async keep(run, found) {
    const { columns, robot } = this.viewer.scene;
    const why = run.note;
    const rows = Array.from({ length: found.length / columns.length }, (_, i) => [...found.subarray(i * columns.length, (i + 1) * columns.length)]);
    run.note = `${why} The path that it had found is checked.`;
    this.update(run);
    try {
      const { path, faults, written } = await this.workbench.session.request({ do: "path", name: run.planner, rows, ...run.ends });
      if (!this.runs.all.includes(run) || this.runs.isOld(run)) return;
      run.note = faults.length ? `${why} The path that it had found is not free: ${faults[0]}.` : `${why} A verified path stays, as it was found.`;
      if (!faults.length) this.addPath(run, readPath(path, columns.length, robot), written);
    } catch (error) {
      run.note = why;
      showError(error);
    }
    this.update(run);
  }
  /** Shows what a run is doing. @param {Run} run */
  update(run) {
    this.runs.update(run);
    this.showState();
    this.viewer.changed();
  }
  /** @param {Run} run @param {string} message @param {unknown} error shown at the top, unless null */
  fail(run, message, error) {
    run.state = "failed";
    run.note = message;
    if (error) showError(error);
    if (error) this.explain();
    this.runs.update(run);
    this.showState();
  }
  /** Asks whether start and goals are free: a run without a path may be their fault. */
  explain() {
    const { ends } = this.workbench;
    ends.check("start");
    this.viewer.scene.goals.forEach((_, i) => ends.check(i));
  }
  /** The planner is gone, and its run with it; what it has searched stays. */
  lost() {
    if (this.run && this.going) this.fail(this.run, "the planner is gone", null);
    this.showState();
  }
  /** After another scene was opened or shown, or this one was changed. @param {"open" | "edit"} how */
  opened(how) {
    this.cancel();
    if (how === "edit") this.runs.keep(this.workbench.which);
    else this.runs.clear(this.workbench.which);
    if (how === "open" || this.going) this.run = null;
    this.showState();
  }
  showState() {
    const { run } = this;
    const going = this.going;
    const paused = run?.state === "paused";
    if (!this.planButton || !this.pauseButton || !this.stepButton || !this.cancelButton || !this.status || !this.counts) return;
    this.planButton.disabled = going || !this.workbench.open;
    this.stepButton.disabled = !this.workbench.open;
    this.pauseButton.disabled = this.cancelButton.disabled = !going;
    if (this.nextButton) this.nextButton.hidden = !this.workbench.partsLeft;
    if (this.nextButton) this.nextButton.disabled = going || !this.end;
    const label = paused ? "Resume" : "Pause";
    if (this.pauseButton.textContent !== label) this.pauseButton.textContent = label;
    const status = this.stateWords();
    if (this.status.textContent !== status) this.status.textContent = status;
    this.counts.textContent = run && going ? this.countWords(run.progress) : "";
    const failed = this.runs.layer.shown?.rejected.count ?? 0;
    const text = this.rejected?.querySelector("span");
    if (text) text.textContent = `Where edges fail${failed ? ` (${brief(failed)} motions)` : ""}`;
  }
  stateWords() {
    const { run } = this;
    if (!this.workbench.open) return "Open a scene to plan in it.";
    if (!run) return "";
    if (!run.report) return run.note || `Run ${run.id}: ${run.state}`;
    const { solved, path_length: length, why } = run.report;
    const took = `in ${brief(totalTime(run.report))} s`;
    if (!solved) return `Run ${run.id} has no path: ${why ?? "it ended"}, ${took}.`;
    const old = this.runs.isOld(run) ? " It is of the scene before." : "";
    const clearance = clearanceOf(run.report, this.runs.pathOf(run));
    return `Run ${run.id}: a verified path ${took}, length ${brief(length)}${clearance && `, clearance ${clearance}`}.${old}`;
  }
  /** @param {Message} progress */
  countWords({ iterations = 0, nodes = 0, motions = 0, time_s: time = 0 }) {
    return `${brief(iterations)} iterations, ${brief(nodes)} nodes, ${brief(motions)} motions, ${time.toFixed(1)} s`;
  }
  key(/** @type {KeyboardEvent} */ e) {
    if (isTyping(e.target)) return false;
    if (e.key === "r") this.plan(false);
    else if (e.key === "t") this.pause();
    else if (e.key === "n") this.step();
    else if (e.key === "k") this.cancel();
    else if (e.key === "v") this.rejected?.querySelector("input")?.click();
    else return false;
    return true;
  }
}
