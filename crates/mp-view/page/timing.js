// The panel that gives the path of an arm times: a trajectory within limits of velocity and acceleration, which then is played as it is.

import { button, el, labelled, section, showError } from "mp/dom.js";
import { rowsOf } from "mp/saving.js";
import { readPath } from "mp/scene.js";

/** @import { Message } from "mp/message.js" */
/** @import { Path } from "mp/scene.js" */
/** @import { Workbench } from "mp/workbench.js" */

/** Numbers from here on are those of timings: runs in the table count from 1. */
const FIRST = 2 ** 32;

export class TimingPanel {
  /** @param {Workbench} workbench @param {() => void} save the trajectory that is shown */
  constructor(workbench, save) {
    this.workbench = workbench;
    this.viewer = workbench.viewer;
    this.count = FIRST;
    /** The timing that goes on. @type {{run: number, path: Path, cancelled: boolean} | null} */ this.going = null;
    const scale = () => el("input", { type: "number", min: 0, step: "any", value: 1, placeholder: "1" });
    this.velocity = scale(); this.acceleration = scale(); this.jerk = scale();
    this.start = button("Give it times", () => this.time(), { class: "main" });
    this.stop = button("Cancel", () => this.cancel(), { "aria-label": "Cancel the timing" });
    this.save = button("Save it…", save);
    this.status = el("div", { role: "status" });
    this.panel = section("Trajectory", true, [
      labelled("Velocity scale", this.velocity), labelled("Acceleration scale", this.acceleration),
      labelled("Jerk scale", this.jerk),
      el("div", { class: "buttons" }, this.start, this.stop, this.save), this.status]);
    this.viewer.addPanel(this.panel);
    this.opened();
    workbench.onevent.push((event) => this.event(event));
    workbench.onopened.push(() => this.opened());
    workbench.onleft.push(() => this.opened());
    workbench.onlost.push(() => this.end());
    this.viewer.onpath.push(() => this.showState());
  }
  /** The path that is shown, if there is one. */
  get path() { return this.viewer.scene.paths[this.viewer.settings.path] ?? null; }

  async time() {
    const { path } = this;
    if (!path || this.going) return;
    const run = ++this.count;
    const rows = rowsOf(path, this.viewer.scene.columns.length);
    const [velocity, acceleration, jerk] = [this.velocity, this.acceleration, this.jerk].map((field) => (field.value.trim() ? field.valueAsNumber : 1));
    this.going = { run, path, cancelled: false };
    showError("");
    this.showState();
    try {
      await this.workbench.session.request({ do: "time", run, rows, velocity, acceleration, jerk });
    } catch (error) {
      if (this.going?.run !== run) return;
      this.end();
      showError(error);
    }
  }
  async cancel() {
    if (!this.going) return;
    this.going.cancelled = true;
    // One that has ended meanwhile needs no message.
    await this.workbench.session.request({ do: "cancel", run: this.going.run }).catch(() => {});
  }
  event(/** @type {Message} */ event) {
    const { going } = this;
    if (event.run !== going?.run || !going) return;
    if (event.event === "timed") this.timed(going.path, event);
    if (event.event === "failed" && !going.cancelled) showError(Object.assign(new Error(event.message), { help: event.help }));
    if (event.event === "timed" || event.event === "failed") this.end();
  }
  /** Shows a path as its trajectory goes. @param {Path} path @param {Message} event */
  timed(path, { path: sent, velocities, accelerations, duration, limits, curve, knots, summary, notes }) {
    const { scene, timeline } = this.viewer;
    const i = scene.paths.indexOf(path);
    if (i < 0) return;
    const { count, rows, poses, trace, clearance, travel } = readPath(sent, scene.columns.length, scene.robot);
    const words = [...summary.split(/\n */), ...notes];
    const written = rowsOf(path, scene.columns.length);
    const trajectory = { duration, velocities, accelerations, limits, curve, knots, words };
    this.viewer.setPath(i, { ...path, count, rows, poses, trace, clearance, travel, written, trajectory });
    if (this.path?.trajectory !== trajectory) return;
    timeline.plot?.choose("positions");
    timeline.scrub(0);
  }
  end() {
    this.going = null;
    this.showState();
  }
  /** After another scene was opened or shown, or this one was changed: its paths are gone. */
  opened() {
    this.cancel();
    this.end();
  }
  showState() {
    const { path, going } = this;
    this.panel.hidden = !this.workbench.open || !this.workbench.trajectories;
    this.start.disabled = !path || going !== null;
    this.stop.disabled = !going;
    this.save.disabled = !path?.trajectory;
    const words = going ? ["Timing…"] : (path?.trajectory?.words ?? []);
    this.status.replaceChildren(...words.map((line) => el("small", {}, line.charAt(0).toUpperCase() + line.slice(1))));
  }
}
