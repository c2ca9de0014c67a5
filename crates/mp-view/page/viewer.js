// The picture of a scene with its camera, panels and timeline; it redraws when something changed.

import { Camera } from "mp/camera.js";
import { palette } from "mp/colors.js";
import { Controls, isTyping } from "mp/controls.js";
import { Coverage } from "mp/coverage.js";
import { byId, showError } from "mp/dom.js";
import { Frames } from "mp/frames.js";
import { Pace } from "mp/pace.js";
import { Panels, VIEWS } from "mp/panels.js";
import { Picker } from "mp/picking.js";
import { PictureMaker } from "mp/picture.js";
import { Renderer } from "mp/renderer.js";
import { emptyScene } from "mp/scene.js";
import { shapesOf } from "mp/shapes.js";
import { Timeline } from "mp/timeline.js";

/** @import { ViewName } from "mp/camera.js" */
/** @import { Palette } from "mp/colors.js" */
/** @import { Nodes } from "mp/coverage.js" */
/** @import { Cloud } from "mp/picking.js" */
/** @import { Animation, Settings } from "mp/picture.js" */
/** @import { Item, Mode, Picture, Role } from "mp/renderer.js" */
/** @import { Path, Scene } from "mp/scene.js" */
/** @import { Shape } from "mp/shapes.js" */
/** @typedef {{drawCalls: number, triangles: number, milliseconds: number, frames: number}} Stats
 *  `milliseconds`: the time that scripts took for the last frame. */
/** @typedef {{start?: (renderer: Renderer) => void, items?: (settings: Settings, colors: Palette) => Item[],
 *  images?: (settings: Settings, colors: Palette) => Picture["images"],
 *  lines?: (settings: Settings, colors: Palette) => Picture["lines"], points?: (settings: Settings, colors: Palette) => Picture["points"],
 *  clouds?: (settings: Settings) => Cloud[], searched?: (settings: Settings) => Nodes[]}} Layer
 *  What another module draws over the scene. `start` is called when the layer is added, and after the graphics card was lost: its
 *  buffers are gone then. `clouds` are points that can be clicked, and `searched` the nodes of a search that is shown instead of the scene's own. */

/** What belongs to one scene only. @param {Scene} scene */
const settingsOf = (scene) => ({
  bodies: scene.bodies.map(() => ({ visible: true, mode: /** @type {Mode | ""} */ ("") })),
  path: scene.paths.length ? 0 : -1,
  other: -1,
  time: 0,
  trees: scene.trees.map(() => true),
  growth: 1,
  marked: null,
});

/** What is shown at the beginning. @param {Scene} scene @returns {Settings} */
const firstSettings = (scene) => ({
  ...settingsOf(scene),
  mode: "solid",
  edges: true,
  animation: "step",
  copies: 30,
  copyMode: "transparent",
  start: true,
  goals: true,
  trace: true,
  frames: false,
  roadmap: true,
  section: { axis: -1, at: 0.5, flipped: false },
  dark: matchMedia("(prefers-color-scheme: dark)").matches,
});

export class Viewer {
  constructor() {
    this.scene = emptyScene();
    this.settings = firstSettings(this.scene);
    this.canvas = /** @type {HTMLCanvasElement} */ (byId("canvas"));
    this.camera = new Camera(this.scene.bounds);
    /** @type {Layer[]} */ this.layers = [];
    /** Called with each key that no control has used; they return whether they used it. @type {((e: KeyboardEvent) => boolean)[]} */ this.keys = [];
    /** Called after each drawing. @type {(() => void)[]} */ this.ondraw = [];
    /** Called when another path is shown. @type {(() => void)[]} */ this.onpath = [];
    /** Called when a body is chosen, in the picture or in the list; −1 when none is. @type {((body: number, role: Role, index: number) => void)[]} */ this.onselect = [];
    /** Called after another scene is shown. @type {((scene: Scene) => void)[]} */ this.onshow = [];
    /** @type {Stats} */ this.stats = { drawCalls: 0, triangles: 0, milliseconds: 0, frames: 0 };
    this.waiting = false;
    this.pace = new Pace();
    /** @type {Shape[]} */ this.shapes = [];
    /** The shape of each body. @type {number[]} */ this.ofBody = [];
    this.addLayer(new Frames(this));
    this.coverage = new Coverage(this);
    this.addLayer(this.coverage);
    this.prepare();
    const changed = () => this.changed();
    this.controls = new Controls(this.canvas, this.camera, { moved: () => this.moved(), clicked: (x, y) => this.click(x, y), centered: (x, y) => this.center(x, y) });
    this.panels = new Panels(this.settings, this);
    this.panels.addShown(...this.coverage.elements);
    this.coverage.show();
    this.timeline = new Timeline(this.settings, changed);
    this.listen();
    this.resize();
  }
  /** Shows another scene. Settings that do not belong to one scene stay. @param {Scene} scene
   * @param {{keepCamera?: boolean}} [options] */
  show(scene, { keepCamera = false } = {}) {
    this.scene = scene;
    Object.assign(this.settings, settingsOf(scene));
    this.camera.setBounds(scene.bounds);
    if (this.controls) this.controls.planar = scene.planar;
    this.prepare();
    this.panels?.show(scene, this.ofBody.reduce((sum, s) => sum + this.shapes[s].triangles.length / 3, 0));
    this.timeline?.show(scene);
    byId("hint").textContent = this.shapes.every((shape) => shape.outlined) ? "" : "Edges are left out: a mesh has more than 4 million triangles.";
    if (!keepCamera) this.lookAsUsual();
    for (const listener of this.onshow) listener(scene);
    this.changed();
  }
  /** Looks at the scene as such scenes are first seen: those of the plane from above. */
  lookAsUsual() {
    this.setPerspective(!this.scene.planar);
    this.look(this.scene.planar ? "top" : "iso");
  }
  /** Adds a panel at the side; it stays when another scene is shown. @param {HTMLElement} panel */
  addPanel(panel) { byId("tools").append(panel); }
  /** Adds a control to the bar at the top. @param {HTMLElement} control */
  addMenu(control) { byId("menu").append(control); }
  /** @param {Layer} layer */
  addLayer(layer) {
    this.layers.push(layer);
    if (this.renderer) layer.start?.(this.renderer);
  }
  /** Adds a path of the scene and returns its number. @param {Path} path */
  addPath(path) {
    this.scene.paths.push(path);
    this.pictures?.addPath(path);
    this.panels?.showPaths();
    return this.scene.paths.length - 1;
  }
  /** Puts a path in the place of another one. @param {number} i @param {Path} path */
  setPath(i, path) {
    this.scene.paths[i] = path;
    this.pictures?.setPath(i, path);
    this.panels?.showPaths();
    if (i === this.settings.path) this.choosePath(i);
  }
  /** Brings the scene to the graphics card; what was there of another scene is freed. */
  prepare() {
    const { shapes, ofBody } = shapesOf(this.scene, this.shapes);
    this.shapes = shapes; this.ofBody = ofBody;
    this.pictures?.free();
    if (!this.renderer) this.start();
    else this.fill(this.renderer);
  }
  /** Takes the graphics card into use: at the beginning, and after it was lost. */
  start() {
    this.renderer = new Renderer(this.canvas);
    this.fill(this.renderer);
    for (const layer of this.layers) layer.start?.(this.renderer);
  }
  fill(/** @type {Renderer} */ renderer) {
    renderer.setShapes(this.shapes);
    this.pictures = new PictureMaker(this.scene, this.ofBody, renderer, this.layers);
    this.picker = new Picker(this.scene, this.shapes, this.camera, this.layers);
  }
  listen() {
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    addEventListener("keydown", (e) => this.key(e));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.setTheme(document.documentElement.dataset.theme ?? "auto"));
    this.canvas.addEventListener("webglcontextlost", (e) => {
      e.preventDefault();
      this.lost = true;
      showError("The graphics card was taken away from this page. The picture comes back when the browser gives it again; otherwise reload the page.");
    });
    this.canvas.addEventListener("webglcontextrestored", () => {
      this.lost = false;
      showError("");
      this.start();
      this.changed();
    });
  }
  resize() {
    const ratio = Math.min(devicePixelRatio || 1, 2);
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    this.ratio = ratio;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    const fresh = this.camera.width <= 1;
    this.camera.width = width;
    this.camera.height = height;
    if (fresh) this.camera.fit();
    if (this.stats.frames) this.draw();
  }
  /** Asks for one redraw, soon. */
  changed() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame((now) => this.frame(now));
  }
  /** The view has moved, or something was clicked: asks for one redraw, very soon. */
  moved() {
    this.pace.moved(() => this.changed());
    this.changed();
  }
  /** @param {number} now milliseconds */
  frame(now) {
    this.waiting = false;
    // The next frame comes when this one is drawn.
    const begin = performance.now();
    const { share } = this.pace;
    requestAnimationFrame(() => this.pace.took(share, performance.now() - begin));
    const flies = this.controls?.fly(now) ?? false;
    const plays = this.timeline?.advance(now) ?? false;
    try {
      this.draw(share);
    } catch (error) {
      return showError(error);
    }
    if (flies) this.moved();
    if (plays) this.changed();
  }
  /** Draws now. @param {number} [share] of the lines of searches */
  draw(share = 1) {
    if (this.lost || !this.pictures || !this.renderer) return;
    const begin = performance.now();
    this.picture = this.pictures.make(this.settings);
    this.renderer.draw(this.picture, this.camera, palette(this.settings.dark), this.ratio ?? 1, share);
    this.timeline?.update();
    this.panels?.update();
    for (const listener of this.ondraw) listener();
    const milliseconds = performance.now() - begin;
    this.stats = { drawCalls: this.renderer.calls, triangles: this.renderer.triangles, milliseconds, frames: this.stats.frames + 1 };
  }
  look(/** @type {ViewName} */ view) {
    this.camera.look(view);
    this.fit();
  }
  fit() {
    this.camera.fit();
    this.changed();
  }
  setPerspective(/** @type {boolean} */ on) {
    this.camera.perspective = on;
    this.panels?.showPerspective(on);
    this.changed();
  }
  setTheme(/** @type {string} */ theme) {
    document.documentElement.dataset.theme = theme;
    this.settings.dark = theme === "auto" ? matchMedia("(prefers-color-scheme: dark)").matches : theme === "dark";
    this.changed();
  }
  choosePath(/** @type {number} */ path) {
    this.settings.path = path;
    this.panels?.markPath();
    this.timeline?.showPath();
    for (const listener of this.onpath) listener();
    this.changed();
  }
  /** Shows a second path beside the chosen one. @param {number} path −1 for none */
  compare(path) {
    this.settings.other = path;
    this.timeline?.showPath();
    this.changed();
  }
  /** Says what is at a pixel. @param {number} x @param {number} y */
  click(x, y) {
    const picked = this.picture ? (this.picker?.pick(x, y, this.picture, this.settings) ?? null) : null;
    this.settings.marked = picked?.marked ? picked.point : null;
    if (picked && picked.time !== null) this.timeline?.scrub(picked.time);
    if (!picked) byId("hint").textContent = "";
    this.panels?.showPicked(picked, () => this.forget());
    this.select(picked?.item?.body ?? -1, picked?.item?.role, picked?.item?.index);
    this.moved();
  }
  /** Chooses a body; of the robot at its start, when it is not said. @param {number} body −1 for none @param {Role} [role]
   * @param {number} [index] of a goal or a configuration */
  select(body, role = "start", index = 0) { for (const listener of this.onselect) listener(body, role, index); }

  /** Looks at what is at a pixel. @param {number} x @param {number} y */
  center(x, y) {
    const picked = this.picture && this.picker?.pick(x, y, this.picture, this.settings);
    if (picked) this.camera.target = picked.point;
    this.changed();
  }
  forget() {
    this.settings.marked = null;
    byId("hint").textContent = "";
    this.panels?.showPicked(null, () => {});
    this.changed();
  }
  key(/** @type {KeyboardEvent} */ e) {
    if (isTyping(e.target) || e.ctrlKey || e.metaKey || e.altKey || document.querySelector("dialog[open]")) return;
    if (this.keys.some((use) => use(e)) || this.timeline?.key(e)) return e.preventDefault();
    const s = this.settings;
    const view = VIEWS[Number(e.key) - 1];
    if (view) this.look(view[0]);
    else if (e.key === "f") this.fit();
    else if (e.key === "o") this.setPerspective(!this.camera.perspective);
    else if (e.key === "m") this.panels?.setMode(s.mode === "solid" ? "transparent" : s.mode === "transparent" ? "wire" : "solid");
    else if (e.key === "x") this.panels?.setSection(s.section.axis >= 2 ? -1 : s.section.axis + 1);
    else if (e.key === "l") this.coverage.next();
    else if (e.key === "c") this.timeline?.setAnimation("all");
    else if (e.key === "p") this.panels?.togglePanel();
    else if (e.key === "?") byId("help-button").click();
    else if (e.key === "Escape") this.forget();
  }
  /** A way to show the path, or to draw surfaces. @param {Animation | Mode} mode */
  setMode(mode) {
    if (mode === "all" || mode === "step" || mode === "auto") this.timeline?.setAnimation(mode);
    else this.panels?.setMode(mode);
  }
}
