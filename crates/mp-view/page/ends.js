// Start and goals of the next run. Panels and handles move them; each change is checked by the planner, at most one check at a time.

/** @import { Configuration, Scene } from "mp/scene.js" */
/** @import { Session } from "mp/session.js" */
/** @typedef {"start" | number} End the start, or the number of a goal */
/** @typedef {{free: boolean, in_bounds: boolean, clearance: number | null, touching: string[], fault: string | null,
 *  nearest_free: number[] | null, poses: number[]}} Verdict  the answer to `check`: docs/formats/session.md */

export class Ends {
  constructor(/** @type {Session} */ session) {
    this.session = session;
    /** @type {Scene | null} */ this.scene = null;
    /** Called when an end has moved (`settled` is false while it is dragged), and when its verdict has come.
     * @type {((end: End, settled: boolean) => void)[]} */ this.onchange = [];
    /** What the planner says of each end as it is now. @type {Map<End, Verdict>} */ this.verdicts = new Map();
    /** Why an end could not be checked. @type {Map<End, Error>} */ this.errors = new Map();
    /** @type {Set<End>} */ this.unchecked = new Set();
    /** Ends whose present poses were given with the row. @type {Set<End>} */ this.posed = new Set();
    /** Whether start or goals are not those of the scene. */ this.moved = { start: false, goals: false };
    this.asking = false;
    /** Where a body is to be next. @type {{end: End, body: number, pose: number[]} | null} */ this.wish = null;
    /** While wishes are asked for. @type {Promise<void> | null} */ this.asked = null;
  }
  /** Takes the ends of a scene. @param {Scene} scene */
  show(scene) {
    this.scene = scene;
    for (const known of [this.verdicts, this.errors, this.unchecked, this.posed]) known.clear();
    this.moved = { start: false, goals: false };
  }
  /** @param {End} end @returns {Configuration | null} */
  at(end) { return (end === "start" ? this.scene?.start : this.scene?.goals[end]) ?? null; }

  /** Moves an end. @param {End} end @param {number[]} row
   * @param {{settled?: boolean, poses?: number[] | null}} [options] `poses` where they are known already; the planner's come with
   * its verdict. `settled` is false while the end is dragged. */
  set(end, row, { settled = true, poses = null } = {}) {
    const now = this.at(end);
    if (!this.scene || !now) return;
    const configuration = { row: [...row], poses: poses ?? now.poses };
    if (end === "start") this.scene.start = configuration;
    else this.scene.goals[end] = configuration;
    if (poses) this.posed.add(end);
    else this.posed.delete(end);
    this.moved[end === "start" ? "start" : "goals"] = true;
    this.check(end);
    this.tell(end, settled);
  }
  /** Moves an end so that a body of the robot has this pose, as far as the robot reaches. Of several wishes the last counts.
   * @param {End} end @param {number} body @param {number[]} pose */
  reach(end, body, pose) {
    this.wish = { end, body, pose };
    this.asked ??= this.grant().finally(() => (this.asked = null));
    return this.asked;
  }
  async grant() {
    const { scene } = this;
    while (this.wish) {
      const { end, body, pose } = this.wish;
      this.wish = null;
      const now = this.at(end)?.row;
      if (!now) return;
      const { row, poses } = await this.session.request({ do: "reach", row: now, body, pose });
      if (scene !== this.scene) return;
      if (row) this.set(end, row, { settled: false, poses });
    }
  }
  /** Ends a drag by a body: the end stays where it is, or goes back. @param {End} end @param {Configuration | null} back */
  async reached(end, back) {
    if (back) this.wish = null;
    await this.asked;
    const at = back ?? this.at(end);
    if (at) this.set(end, at.row, { poses: at.poses });
  }
  /** Start and goals for the planner: null where they are the scene's own. */
  request() {
    const { scene, moved } = this;
    return { start: moved.start && scene ? scene.start.row : null, goals: moved.goals && scene ? scene.goals.map((g) => g.row) : null };
  }
  /** Asks the planner about an end, soon. Of several questions about one end only the last is asked. @param {End} end */
  check(end) {
    this.verdicts.delete(end);
    this.errors.delete(end);
    this.unchecked.add(end);
    if (!this.asking) this.ask();
  }
  async ask() {
    this.asking = true;
    for (;;) {
      const [end] = this.unchecked;
      if (end === undefined) break;
      this.unchecked.delete(end);
      const { scene } = this;
      const row = this.at(end)?.row;
      if (!row) continue;
      /** @type {Verdict | null} */ let verdict = null;
      /** @type {Error | null} */ let error = null;
      try {
        verdict = /** @type {Verdict} */ (await this.session.request({ do: "check", row }));
      } catch (e) {
        error = e instanceof Error ? e : new Error(String(e));
      }
      // An answer about another scene comes too late; one about a row of before still shows where the robot was.
      const now = this.at(end);
      if (scene !== this.scene || !now) continue;
      const wanted = now.row === row || !this.posed.has(end);
      if (verdict && wanted && verdict.poses.length === now.poses.length) now.poses = verdict.poses;
      if (now.row === row && verdict) this.verdicts.set(end, verdict);
      if (now.row === row) now.refused = verdict !== null && !verdict.free;
      if (now.row === row && error) this.errors.set(end, error);
      this.tell(end, !this.unchecked.has(end));
    }
    this.asking = false;
  }
  /** @param {End} end @param {boolean} settled */
  tell(end, settled) { for (const listener of this.onchange) listener(end, settled); }
}
