// The robot on its path, in the three ways of Benitez et al. (2010): all configurations at once, step by step forwards and
// backwards, and automatically.

import { brief, button, byId, el, labelled, select, slider } from "mp/dom.js";
import { PathPlot } from "mp/plot.js";

/** @import { Animation, Settings } from "mp/picture.js" */
/** @import { Mode } from "mp/renderer.js" */
/** @import { Scene } from "mp/scene.js" */
/** @typedef {"stop" | "loop" | "return"} AtEnd what happens at the end of the path */

/** @type {[Animation, string][]} */
const ANIMATIONS = [["all", "All at once"], ["step", "Step by step"], ["auto", "Automatic"]];

export class Timeline {
  /** @param {Settings} settings @param {() => void} changed */
  constructor(settings, changed) {
    /** @type {Scene | null} */ this.scene = null;
    this.settings = settings; this.changed = changed;
    this.playing = false;
    this.speed = 1;
    this.direction = 1;
    /** @type {AtEnd} */ this.atEnd = "loop";
    this.lastTime = 0;
    this.build();
  }
  show(/** @type {Scene} */ scene) {
    this.scene = scene;
    this.playing = false;
    this.showPath();
  }
  get path() { return this.scene?.paths[this.settings.path] ?? null; }
  get last() { return Math.max(0, (this.path?.count ?? 0) - 1); }

  build() {
    const s = this.settings;
    this.modes = ANIMATIONS.map(([value, label]) => button(label, () => this.setAnimation(value), { value }));
    this.playButton = button("Play", () => this.toggle(), { class: "wide" });
    this.slider = slider({ low: 0, high: 1, step: 1, value: 0 }, (t) => this.scrub(t), { "aria-label": "Configuration" });
    this.output = el("output", { class: "count" });
    this.plot = new PathPlot(el("canvas", { class: "plot", role: "img" }), (t) => this.scrub(t), () => this.changed());
    this.autoControls = el("span", { class: "group" },
      labelled("Speed", select([["0.25", "¼×"], ["0.5", "½×"], ["1", "1×"], ["2", "2×"], ["4", "4×"]], "1", (v) => (this.speed = Number(v)))),
      labelled("At the end", select([["loop", "again"], ["return", "back"], ["stop", "stop"]], "loop", (v) => (this.atEnd = /** @type {AtEnd} */ (v)))));
    this.copies = slider({ low: 2, high: 200, step: 1, value: s.copies }, (n) => this.set(() => (s.copies = n)));
    /** @type {[Mode, string][]} */
    const modes = [["transparent", "transparent"], ["solid", "solid"], ["wire", "wire"]];
    this.allControls = el("span", { class: "group" },
      labelled("Copies", this.copies),
      labelled("as", select(modes, s.copyMode, (v) => this.set(() => (s.copyMode = /** @type {Mode} */ (v))), { "aria-label": "How copies are drawn" })));
    byId("timeline").replaceChildren(
      el("div", { class: "bar" },
        el("span", { class: "segments", role: "group", "aria-label": "Animation" }, ...this.modes),
        el("span", { class: "group" },
          button("«", () => this.scrub(0), { "aria-label": "First configuration", title: "First (Home)" }),
          button("‹", () => this.step(-1), { "aria-label": "Previous configuration", title: "Previous (←)" }),
          this.playButton,
          button("›", () => this.step(1), { "aria-label": "Next configuration", title: "Next (→)" }),
          button("»", () => this.scrub(this.last), { "aria-label": "Last configuration", title: "Last (End)" })),
        this.autoControls, this.allControls, this.plot.control, this.output),
      this.slider, this.plot.canvas, this.plot.joints.element);
  }
  set(/** @type {() => void} */ change) {
    change();
    this.changed();
  }
  /** After another path was chosen. */
  showPath() {
    byId("timeline").hidden = !this.scene?.paths.length;
    if (!this.slider) return;
    this.slider.max = String(this.last);
    this.settings.time = Math.min(this.settings.time, this.last);
    const { copies } = this;
    if (copies) copies.max = String(Math.min(400, Math.max(2, this.last + 1)));
    this.plot?.show(this.scene, [this.path, this.scene?.paths[this.settings.other]]);
    this.update();
  }
  /** Shows the settings in the controls. */
  update() {
    const { animation, time, copies } = this.settings;
    this.modes?.forEach((mode) => mode.setAttribute("aria-pressed", String(mode.value === animation)));
    if (!this.slider) return;
    this.slider.step = animation === "step" ? "1" : "any";
    this.slider.valueAsNumber = time;
    const { duration = 0 } = this.path?.trajectory ?? {};
    const seconds = this.path?.trajectory && `${((time / (this.last || 1)) * duration).toFixed(2)} of ${duration.toFixed(2)} s`;
    const words = seconds ?? (this.path ? `${brief(Math.round(time) + 1)} of ${brief(this.last + 1)}` : "no path");
    this.slider.setAttribute("aria-valuetext", seconds ?? `Configuration ${words}`);
    if (this.output) this.output.textContent = this.path && animation === "all" ? `${words} · ${Math.min(copies, this.last + 1)} shown` : words;
    if (this.playButton) this.playButton.textContent = this.playing ? "Pause" : "Play";
    // The planner has a button “Pause”, too.
    this.playButton?.setAttribute("aria-label", this.playing ? "Pause the path" : "Play the path");
    if (this.autoControls) this.autoControls.hidden = animation !== "auto";
    if (this.allControls) this.allControls.hidden = animation !== "all";
    this.plot?.draw(time);
  }
  setAnimation(/** @type {Animation} */ animation) {
    this.settings.animation = animation;
    this.playing = animation === "auto";
    this.lastTime = 0;
    if (animation === "step") this.settings.time = Math.round(this.settings.time);
    if (animation === "auto" && this.settings.time >= this.last) this.settings.time = 0;
    this.changed();
  }
  /** Plays the path from its start to its end. */
  playOnce() {
    this.atEnd = "stop";
    this.direction = 1;
    this.settings.time = 0;
    this.setAnimation("auto");
  }
  toggle() {
    if (this.settings.animation !== "auto") return this.setAnimation("auto");
    this.playing = !this.playing;
    this.lastTime = 0;
    if (this.playing && this.settings.time >= this.last) this.settings.time = 0;
    this.changed();
  }
  /** Goes to a time, in configurations. @param {number} time */
  scrub(time) {
    const { animation } = this.settings;
    this.playing = false;
    const t = Math.max(0, Math.min(this.last, time));
    this.settings.time = animation === "step" ? Math.round(t) : t;
    this.changed();
  }
  /** One configuration on or back. @param {number} by */
  step(by) {
    if (this.settings.animation === "auto") this.settings.animation = "step";
    const { time } = this.settings;
    this.scrub(by > 0 ? Math.floor(time + 1e-6) + by : Math.ceil(time - 1e-6) + by);
  }
  /** Moves on while it plays; returns whether it plays. @param {number} now milliseconds */
  advance(now) {
    if (!this.playing || !this.last) return false;
    const { duration = 0 } = this.path?.trajectory ?? {};
    const seconds = this.lastTime ? Math.min(duration ? 1 : 0.1, (now - this.lastTime) / 1000) : 0;
    this.lastTime = now;
    // A path without times takes 4 to 16 seconds.
    const rate = this.last / (duration || Math.max(4, Math.min(16, this.last / 25)));
    const time = this.settings.time + seconds * rate * this.speed * this.direction;
    if (time < 0 || time > this.last) this.turn(time);
    else this.settings.time = time;
    return this.playing;
  }
  /** At an end of the path. @param {number} time */
  turn(time) {
    this.settings.time = Math.max(0, Math.min(this.last, time));
    if (this.atEnd === "stop") this.playing = false;
    if (this.atEnd === "return") this.direction = time < 0 ? 1 : -1;
    else this.direction = 1;
    if (this.atEnd === "loop") this.settings.time = 0;
  }
  /** @param {KeyboardEvent} e @returns {boolean} whether the key was used */
  key(e) {
    if (!this.path || e.shiftKey) return false;
    if (e.key === "ArrowRight") this.step(1);
    else if (e.key === "ArrowLeft") this.step(-1);
    else if (e.key === "Home") this.scrub(0);
    else if (e.key === "End") this.scrub(this.last);
    else if (e.key === " " && !(e.target instanceof HTMLButtonElement)) this.toggle();
    else return false;
    return true;
  }
}
