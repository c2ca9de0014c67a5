// The panel at the side: what the scene is, how it is drawn, its bodies, its paths, the report, and what was picked.

import { brief, button, byId, checkbox, coordinate, el, factList, labelled, section, select, slider } from "mp/dom.js";
import { emptyScene } from "mp/scene.js";

/** @import { ViewName } from "mp/camera.js" */
/** @import { Picked } from "mp/picking.js" */
/** @import { Settings } from "mp/picture.js" */
/** @import { Mode } from "mp/renderer.js" */
/** @import { Path, Scene } from "mp/scene.js" */
/** @typedef {{changed: () => void, look: (view: ViewName) => void, fit: () => void, setPerspective: (on: boolean) => void,
 *  choosePath: (path: number) => void, select: (body: number) => void, setTheme: (theme: string) => void}} Actions */

/** @type {[Mode, string][]} */
const MODES = [["solid", "solid"], ["transparent", "transparent"], ["wire", "wire"]];
/** @type {[ViewName, string][]} */
export const VIEWS = [["front", "Front"], ["back", "Back"], ["left", "Left"], ["right", "Right"], ["top", "Top"], ["bottom", "Bottom"], ["iso", "Iso"]];

/** @type {[string, string][]} */
const HELP = [
  ["Drag", "turn the view (in the plane: move it)"],
  ["Shift + drag, right button", "move the view (in the plane: turn it)"], ["Wheel, two fingers, + and −", "zoom"],
  ["Click", "say what is there"], ["Double click", "look at this place"],
  ["W A S D, Q E", "fly: forwards, left, backwards, right; down, up"], ["Shift + arrow keys", "turn the view"],
  ["1 … 7", "front, back, left, right, top, bottom, iso"], ["F", "fit everything"],
  ["O", "perspective or parallel view"], ["M", "solid, transparent or wire"], ["X", "section: none, x, y, z"], ["L", "where the search has nodes: not shown, seen along z, y, x"],
  ["← →", "step by step along the path"], ["Home, End", "first and last configuration"], ["Space", "play and pause"],
  ["C", "all configurations at once"], ["P", "show or hide the panel"], ["Esc", "forget what was picked"],
  ["?", "this help"],
];

export class Panels {
  /** @param {Settings} settings @param {Actions} actions */
  constructor(settings, actions) {
    this.settings = settings; this.actions = actions;
    this.scene = emptyScene();
    this.triangles = 0;
    this.picked = el("div", { role: "status", class: "picked" });
    this.row = el("dl", {});
    /** Controls of other modules. @type {HTMLElement[]} */ this.more = [];
    this.shown = section("Shown", true, []);
    this.paths = section("Paths", true, []);
    this.configuration = section("Configuration", false, [this.row]);
    this.bodies = section("Bodies", true, []);
    this.facts = el("div", {});
    byId("about").replaceChildren(this.picked, section("Picture", true, this.pictureControls()), this.shown, this.paths, this.configuration, this.bodies, this.facts);
    this.showPaths();
    this.buildHelp();
    this.buildPanelButton();
  }
  /** @param {Scene} scene @param {number} triangles */
  show(scene, triangles) {
    this.scene = scene; this.triangles = triangles;
    document.title = scene.name || "Scene";
    byId("title").textContent = scene.name || "Scene";
    this.showPicked(null, () => {});
    this.showPaths();
    this.showBodies();
    this.bodies.open = scene.bodies.length <= 12;
    this.showFacts();
  }
  /** Shows what the scene is, and the report of a run in it. */
  showFacts() {
    const { scene } = this;
    const notes = scene.notes.map((note) => el("small", {}, `${note.charAt(0).toUpperCase()}${note.slice(1)}.`));
    const parts = [section("Scene", true, [factList(this.sceneFacts()), ...notes])];
    if (scene.report) parts.push(section("Report", true, [factList(reportFacts(scene.report))]));
    this.facts.replaceChildren(...parts);
  }
  /** Adds controls below those of what is shown; they stay when another scene is shown. @param {HTMLElement[]} controls */
  addShown(...controls) {
    this.more.push(...controls);
    this.shown.lastElementChild?.append(...controls);
  }
  /** Shows what can be shown of the scene, and its paths. */
  showPaths() {
    const { paths, columns } = this.scene;
    this.shown.lastElementChild?.replaceChildren(...this.shownControls(), ...this.more);
    this.paths.lastElementChild?.replaceChildren(...this.pathList());
    this.shown.hidden = !columns.length;
    this.paths.hidden = paths.every((path) => path.ofRun);
    this.configuration.hidden = !paths.length;
  }
  set(/** @type {() => void} */ change) {
    change();
    this.actions.changed();
  }
  /** @returns {HTMLElement[]} */
  pictureControls() {
    const { settings: s, actions } = this;
    const views = VIEWS.map(([view, label], i) => button(label, () => actions.look(view), { title: `${label} view (${i + 1})` }));
    this.mode = select(MODES, s.mode, (v) => this.set(() => (s.mode = /** @type {Mode} */ (v))));
    this.projection = select([["perspective", "perspective"], ["parallel", "parallel"]], "perspective", (v) => actions.setPerspective(v === "perspective"));
    const theme = select([["auto", "as the system"], ["light", "light"], ["dark", "dark"]], "auto", (t) => actions.setTheme(t));
    return [
      el("div", { class: "buttons", role: "group", "aria-label": "Views" }, ...views, button("Fit", () => actions.fit(), { title: "Fit everything (F)" })),
      labelled("Surfaces", this.mode),
      labelled("View", this.projection),
      checkbox("Edges", s.edges, (on) => this.set(() => (s.edges = on))),
      this.sectionControls(),
      labelled("Colours", theme),
    ];
  }
  sectionControls() {
    const { settings: s } = this;
    this.axis = select([["-1", "none"], ["0", "across x"], ["1", "across y"], ["2", "across z"]], "-1", (v) => this.setSection(Number(v)));
    const at = slider({ low: 0, high: 1, step: 0.005, value: s.section.at }, (x) => this.set(() => (s.section.at = x)));
    const flip = checkbox("other side", s.section.flipped, (on) => this.set(() => (s.section.flipped = on)));
    this.sectionPlace = el("div", { hidden: true }, labelled("Place of the section", at), flip);
    return el("div", {}, labelled("Section through obstacles", this.axis), this.sectionPlace);
  }
  /** @param {number} axis −1 for none */
  setSection(axis) {
    this.settings.section.axis = axis;
    if (this.axis) this.axis.value = String(axis);
    if (this.sectionPlace) this.sectionPlace.hidden = axis < 0;
    this.actions.changed();
  }
  setMode(/** @type {Mode} */ mode) {
    this.settings.mode = mode;
    if (this.mode) this.mode.value = mode;
    this.actions.changed();
  }
  /** @param {boolean} on */
  showPerspective(on) { if (this.projection) this.projection.value = on ? "perspective" : "parallel"; }
  /** @returns {HTMLElement[]} */
  shownControls() {
    const { scene, settings: s } = this;
    const boxes = [
      checkbox("Start", s.start, (on) => this.set(() => (s.start = on))),
      checkbox(scene.goals.length > 1 ? `Goals (${scene.goals.length})` : "Goal", s.goals, (on) => this.set(() => (s.goals = on))),
    ];
    boxes.push(checkbox("Frames of the world and the bodies", s.frames, (on) => this.set(() => (s.frames = on))));
    if (scene.paths.length) boxes.push(checkbox("Trace of the path", s.trace, (on) => this.set(() => (s.trace = on))));
    scene.trees.forEach((tree, i) => boxes.push(checkbox(`Tree “${tree.name}” (${brief(tree.parents.length)} nodes)`, s.trees[i], (on) => this.set(() => (s.trees[i] = on)))));
    if (scene.roadmap) {
      const label = `Roadmap (${brief(scene.roadmap.kind.length)} nodes, ${brief(scene.roadmap.edges.length / 2)} edges)`;
      boxes.push(checkbox(label, s.roadmap, (on) => this.set(() => (s.roadmap = on))));
    }
    if (scene.trees.length) {
      const growth = slider({ low: 0, high: 1, step: "any", value: 1 }, (g) => this.set(() => (s.growth = g)));
      boxes.push(labelled("Growth of the trees", growth));
    }
    return boxes;
  }
  /** Shows the list of bodies again. */
  showBodies() {
    const { scene, settings: s, actions } = this;
    /** @type {[string, string][]} */ const modes = [["", "as all"], ...MODES];
    const rows = scene.bodies.map((body, b) => {
      const seen = el("input", { type: "checkbox", checked: s.bodies[b].visible, "aria-label": `Show “${body.name}”`, onchange: () => this.set(() => (s.bodies[b].visible = seen.checked)) });
      const name = button(body.name, () => actions.select(b), { class: "name", "aria-pressed": "false" });
      const mode = select(modes, s.bodies[b].mode, (v) => this.set(() => (s.bodies[b].mode = /** @type {Mode | ""} */ (v))), { "aria-label": `How “${body.name}” is drawn` });
      const row = el("li", { class: body.role }, seen, name, mode);
      if (body.color) row.style.borderColor = `rgb(${body.color.map((x) => Math.round(255 * x)).join(" ")})`;
      return row;
    });
    this.bodies.firstElementChild?.replaceChildren(`Bodies (${scene.bodies.length})`);
    this.bodies.lastElementChild?.replaceChildren(el("ul", { class: "bodies" }, ...rows));
  }
  /** Marks the body that is selected, −1 for none. @param {number} body */
  markBody(body) {
    this.bodies.querySelectorAll("button.name").forEach((name, b) => name.setAttribute("aria-pressed", String(b === body)));
  }
  /** Marks the path that is shown, unless it was chosen here. */
  markPath() {
    const marked = /** @type {HTMLInputElement | null} */ (this.paths.querySelector("input:checked"));
    if (marked?.value !== String(this.settings.path)) this.paths.lastElementChild?.replaceChildren(...this.pathList());
  }
  /** @returns {HTMLElement[]} */
  pathList() {
    const { scene, settings: s, actions } = this;
    // The paths of runs are in the table of runs.
    const rows = scene.paths.flatMap((path, p) => {
      if (path.ofRun) return [];
      const input = el("input", { type: "radio", name: "path", value: String(p), checked: p === s.path, onchange: () => actions.choosePath(p) });
      return [el("li", {}, el("label", { class: "check" }, input, el("span", {}, path.name, el("small", {}, pathWords(path)))))];
    });
    return [el("ul", { class: "paths" }, ...rows)];
  }
  /** @returns {[string, string][]} */
  sceneFacts() {
    const { scene } = this;
    const robot = scene.bodies.filter((body) => body.role === "robot").length;
    const size = scene.bounds[0].map((low, k) => brief(scene.bounds[1][k] - low)).join(" × ");
    /** @type {[string, string][]} */
    const facts = [
      ["space", scene.space],
      ["robot", `${brief(robot)} ${robot === 1 ? "body" : "bodies"}`],
      ["obstacles", brief(scene.bodies.length - robot)],
      ["triangles", brief(this.triangles)],
      ["size", `${size} m`],
    ];
    scene.columns.forEach((column, i) => {
      const limit = scene.limits[i];
      facts.push([column.name, `${limit ? `${coordinate(limit[0])} to ${coordinate(limit[1])}` : "free"} ${column.unit}`]);
    });
    return facts;
  }
  /** The numbers of the present configuration. */
  update() {
    const { scene, settings: s } = this;
    const path = scene.paths[s.path];
    if (!path?.count || !this.configuration.open) return;
    const i = Math.round(s.time) * scene.columns.length;
    const facts = scene.columns.flatMap((c, k) => [el("dt", {}, c.name), el("dd", {}, `${coordinate(path.rows[i + k])} ${c.unit}`)]);
    this.row.replaceChildren(...facts);
  }
  /** @param {Picked | null} picked @param {() => void} close */
  showPicked(picked, close) {
    if (!picked) return this.picked.replaceChildren();
    const closer = button("×", close, { "aria-label": "Forget what was picked" });
    this.picked.replaceChildren(el("div", { class: "card" }, el("header", {}, el("strong", {}, picked.title), closer), factList(picked.facts)));
    byId("hint").textContent = [picked.title, ...picked.facts.slice(0, 2).map(([name, value]) => `${name} ${value}`)].join(" · ");
  }
  buildHelp() {
    const dialog = /** @type {HTMLDialogElement} */ (byId("help"));
    const close = button("Close", () => dialog.close());
    this.help = factList(HELP);
    dialog.replaceChildren(el("h2", { id: "help-title" }, "Mouse, fingers and keys"), this.help, close);
    dialog.setAttribute("aria-labelledby", "help-title");
    byId("help-button").onclick = () => {
      dialog.showModal();
      // What has the focus is at its end.
      dialog.scrollTop = 0;
    };
  }
  /** Adds lines to the help dialog. @param {[string, string][]} lines */
  addHelp(lines) { this.help?.append(...factList(lines).children); }

  buildPanelButton() {
    byId("panel-button").onclick = () => this.togglePanel();
    if (matchMedia("(max-width: 700px)").matches) this.togglePanel();
  }
  togglePanel() {
    const shown = document.body.classList.toggle("no-panel") === false;
    byId("panel-button").setAttribute("aria-expanded", String(shown));
  }
}

function pathWords(/** @type {Path} */ path) {
  const words = [path.trajectory ? `${brief(path.trajectory.duration)} s` : `${brief(path.count)} configurations`];
  if (Number.isFinite(path.length)) words.push(`length ${brief(path.length)}`);
  const clearance = clearanceOf({}, path);
  if (clearance) words.push(`clearance ${clearance}`);
  words.push(path.verified ? "verified" : "not verified");
  return words.join(", ");
}

/** The clearance of a path and how it is known: proved along the path, or the least of where the picture has the robot; empty where neither is.
 * @param {Record<string, unknown>} report @param {Path | null} [path] */
export function clearanceOf({ clearance }, path = null) {
  if (typeof clearance === "number") return `${brief(clearance)} m, proved`;
  return path?.clearance?.length ? `${brief(path.clearance.reduce((a, b) => Math.min(a, b)))} m, sampled` : "";
}

/** The time of all stages of a run, seconds. @param {Record<string, unknown>} report */
export const totalTime = ({ stages }) => /** @type {{time_s: number}[]} */ (stages ?? []).reduce((sum, stage) => sum + stage.time_s, 0);

/** The figures of a report that people ask for first. @param {Record<string, unknown>} report @returns {[string, string][]} */
export function reportFacts(report) {
  /** @type {[name: string, member: string, unit: string][]} */
  const wanted = [
    ["planner", "planner", ""], ["metric", "metric", ""], ["motion check", "motion", ""], ["seed", "seed", ""], ["planning", "time_s", "s"],
    ["finishing", "finish_s", "s"], ["iterations", "iterations", ""], ["nodes", "nodes", ""], ["edges", "edges", ""],
    ["motion checks", "motion_checks", ""], ["collision checks", "collision_checks", ""], ["length as found", "path_length_found", ""],
    ["length", "path_length", ""], ["clearance", "clearance", "m, proved"], ["stopped", "why", ""], ["fingerprint", "fingerprint", ""],
  ];
  /** @type {[string, string][]} */
  const facts = [["result", report.solved === true ? "a verified path" : "no path"]];
  if (report.stages) facts.push(["total time", `${brief(totalTime(report))} s`]);
  for (const [name, member, unit] of wanted) {
    const value = report[member];
    if (typeof value === "number") facts.push([name, `${brief(value)} ${unit}`.trim()]);
    if (typeof value === "string") facts.push([name, value]);
  }
  return facts;
}
