// The page: reads the scene, puts picture, camera, panels and timeline together, and redraws when something changed.

import { Camera } from "mp/camera.js";
import { palette } from "mp/colors.js";
import { Controls, isTyping } from "mp/controls.js";
import { byId } from "mp/dom.js";
import { Panels, VIEWS } from "mp/panels.js";
import { Picker } from "mp/picking.js";
import { PictureMaker } from "mp/picture.js";
import { Renderer } from "mp/renderer.js";
import { unpack } from "mp/packed.js";
import { readScene } from "mp/scene.js";
import { shapesOf } from "mp/shapes.js";
import { Timeline } from "mp/timeline.js";

/** @import { ViewName } from "mp/camera.js" */
/** @import { Animation, Settings } from "mp/picture.js" */
/** @import { Mode } from "mp/renderer.js" */
/** @import { Scene } from "mp/scene.js" */
/** @typedef {{drawCalls: number, triangles: number, milliseconds: number, frames: number}} Stats
 *  `milliseconds`: the time that scripts took for the last frame. */

function showError(/** @type {string} */ text) {
  const box = byId("alert");
  box.textContent = text;
  box.hidden = text === "";
}

/** @param {unknown} error */
const sentence = (error) => (error instanceof Error ? error.message : String(error));

/** What is shown at the beginning. @param {Scene} scene @returns {Settings} */
function firstSettings(scene) {
  return {
    mode: "solid",
    bodies: scene.bodies.map(() => ({ visible: true, mode: "" })),
    edges: true,
    path: scene.paths.length ? 0 : -1,
    animation: "step",
    time: 0,
    copies: 30,
    copyMode: "transparent",
    start: true,
    goals: true,
    trace: true,
    trees: scene.trees.map(() => true),
    roadmap: true,
    growth: 1,
    section: { axis: -1, at: 0.5, flipped: false },
    dark: matchMedia("(prefers-color-scheme: dark)").matches,
    marked: null,
  };
}

class Viewer {
  constructor(/** @type {Scene} */ scene) {
    this.scene = scene;
    this.settings = firstSettings(scene);
    this.canvas = /** @type {HTMLCanvasElement} */ (byId("canvas"));
    const { shapes, ofBody } = shapesOf(scene);
    this.shapes = shapes; this.ofBody = ofBody;
    this.camera = new Camera(scene.bounds);
    /** @type {Stats} */ this.stats = { drawCalls: 0, triangles: 0, milliseconds: 0, frames: 0 };
    this.waiting = false;
    this.start();
    const changed = () => this.changed();
    this.controls = new Controls(this.canvas, this.camera, scene.planar, { changed, clicked: (x, y) => this.click(x, y), centered: (x, y) => this.center(x, y) });
    const triangles = ofBody.reduce((sum, s) => sum + shapes[s].triangles.length / 3, 0);
    this.panels = new Panels(scene, this.settings, this, triangles);
    this.timeline = new Timeline(scene, this.settings, changed);
    this.picker = new Picker(scene, shapes, this.camera);
    this.listen();
    this.resize();
    if (scene.planar) this.setPerspective(false);
    this.look(scene.planar ? "top" : "iso");
  }
  /** Takes the graphics card into use: at the beginning, and after it was lost. */
  start() {
    this.renderer = new Renderer(this.canvas, this.shapes);
    this.pictures = new PictureMaker(this.scene, this.ofBody, this.renderer);
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
  /** @param {number} now milliseconds */
  frame(now) {
    this.waiting = false;
    const flies = this.controls?.fly(now) ?? false;
    const plays = this.timeline?.advance(now) ?? false;
    try {
      this.draw();
    } catch (error) {
      showError(sentence(error));
      return;
    }
    if (flies || plays) this.changed();
  }
  /** Draws now. */
  draw() {
    if (this.lost || !this.pictures || !this.renderer) return;
    const begin = performance.now();
    this.picture = this.pictures.make(this.settings);
    this.renderer.draw(this.picture, this.camera, palette(this.settings.dark), this.ratio ?? 1);
    this.timeline?.update();
    this.panels?.update();
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
    this.changed();
  }
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
    if (this.timeline?.key(e)) return e.preventDefault();
    const s = this.settings;
    const view = VIEWS[Number(e.key) - 1];
    if (view) this.look(view[0]);
    else if (e.key === "f") this.fit();
    else if (e.key === "o") this.setPerspective(!this.camera.perspective);
    else if (e.key === "m") this.panels?.setMode(s.mode === "solid" ? "transparent" : s.mode === "transparent" ? "wire" : "solid");
    else if (e.key === "x") this.panels?.setSection(s.section.axis >= 2 ? -1 : s.section.axis + 1);
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

/** The bytes of the scene: in this page, or beside it. @returns {Promise<Uint8Array>} */
async function sceneBytes() {
  const inside = document.getElementById("scene")?.textContent?.trim();
  if (inside) return unpack(inside);
  const none = "This page holds no scene, and there is no file scene.mpv beside it.";
  if (location.protocol === "file:") throw new Error(none);
  const answer = await fetch("scene.mpv").catch(() => null);
  if (!answer?.ok) throw new Error(none);
  return new Uint8Array(await answer.arrayBuffer());
}

/** Reads the bytes and shows the scene. @param {Uint8Array} bytes @returns {Viewer} */
function show(bytes) {
  const viewer = new Viewer(readScene(bytes));
  viewer.draw();
  document.body.classList.remove("loading");
  return viewer;
}

/** @type {Viewer | null} */
let viewer = null;

/** @returns {Viewer} */
function present() {
  if (!viewer) throw new Error("No scene is shown.");
  return viewer;
}

/** Resolves when the first picture is drawn; rejects when the scene cannot be shown. */
const ready = (async () => {
  try {
    viewer = show(await sceneBytes());
  } catch (error) {
    showError(sentence(error));
    throw error;
  }
})();
ready.catch(() => {});

Object.assign(window, {
  mpView: {
    ready,
    /** @param {number} part of the path: 0 is the start, 1 the end */
    setTime: (part) => {
      const { timeline } = present();
      timeline.scrub(part * timeline.last);
    },
    /** @param {Animation | Mode} mode */
    setMode: (mode) => present().setMode(mode),
    draw: () => present().draw(),
    stats: () => present().stats,
  },
});
