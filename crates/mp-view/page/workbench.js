// What is open: the session's scene, its document, start and goals. Panels of other modules ask it to open and to edit.

import { button, showError, showNote } from "mp/dom.js";
import { Ends } from "mp/ends.js";
import { readScene } from "mp/scene.js";
import { mayDiscard, setUnsaved } from "mp/unsaved.js";

/** @import { Message } from "mp/message.js" */
/** @import { Path, Scene } from "mp/scene.js" */
/** @import { Session, SessionError } from "mp/session.js" */
/** @import { Viewer } from "mp/viewer.js" */
/** @typedef {{scene: string} | {files: {name: string, bytes: Uint8Array}[], main?: string}} Source  a shipped scene, or files */

/** What of a document may change without the scene being another one. */
const UNIMPORTANT = ["name", "color", "start", "goal", "goals"];

export class Workbench {
  /** @param {Viewer} viewer @param {Session} session @param {Message} hello the reply of the session to `hello` */
  constructor(viewer, session, hello) {
    this.viewer = viewer; this.session = session; this.hello = hello;
    this.ends = new Ends(session);
    /** What can be edited, or null. @type {Message | null} */ this.document = null;
    /** What of the scene is not edited, and what can be done instead, or null. @type {string | null} */ this.unedited = null;
    /** Whether the session has a scene open. */ this.open = false;
    /** Whether bodies of the robot can be put to places: docs/formats/session.md. */ this.links = false;
    /** Whether paths of the robot get times. */ this.trajectories = false;
    /** How many parts of the motion come after this one. */ this.partsLeft = 0;
    /** Which scene is open: the same for equal ones, wherever start and goal are, and whatever bodies are called. */ this.which = "";
    /** Called after a scene was opened (“open”), or came back changed from the planner (“edit”).
     * @type {((reply: Message, how: "open" | "edit") => void)[]} */ this.onopened = [];
    /** Called after the session's scene was left. @type {(() => void)[]} */ this.onleft = [];
    /** Called when the planner is gone. @type {((error: SessionError) => void)[]} */ this.onlost = [];
    /** Called with events of runs. @type {((event: Message) => void)[]} */ this.onevent = [];
    /** Until the scene that was asked for is there, or is known not to be. @type {Promise<unknown>} */ this.opening = Promise.resolve();
    session.onevent = (event) => { for (const listener of this.onevent) listener(event); };
    session.onlost = (error) => this.lost(error);
    this.ends.onchange.push(() => viewer.changed());
  }
  /** Opens a scene in place of this one; asks first when there are unsaved changes. Errors are shown, and then nothing has changed.
   * @param {Source} source @returns {Promise<boolean>} */
  async openScene(source) {
    if (!(await mayDiscard())) return false;
    return this.replace(async () => this.take(await this.session.request({ do: "open", ...source }), "open"));
  }
  /** Puts another scene in place of this one. Commands that are given before it is there change nothing.
   * @param {() => Promise<void>} task @returns {Promise<boolean>} */
  replace(task) {
    const replaced = this.attempt(async () => {
      await task();
      setUnsaved(false);
    });
    this.opening = replaced;
    return replaced;
  }
  /** Sends the changed document, and shows the scene that it gives; the camera stays. @param {Message} document @returns {Promise<boolean>} */
  edit(document) {
    return this.attempt(async () => {
      const { moved } = this.ends;
      this.take(await this.session.request({ do: "edit", document: this.withEnds(document) }), "edit");
      // The file of a problem still has its own ends.
      if (!document.robot) this.ends.moved = moved;
      setUnsaved(true);
    });
  }
  /** A document with start and goals as they are now, also one of a problem. @param {Message} document @returns {Message} */
  withEnds(document) {
    if (document.robot) return document;
    const { start, goals } = this.ends.request();
    return { ...document, start: start ?? document.start, goals: goals ?? document.goals };
  }
  /** Shows what `open` or `edit` gave. @param {Message} reply @param {"open" | "edit"} how
   * @param {{paths: Path[], report: Scene["report"]}} [known] what is shown with it */
  take(reply, how, known = { paths: [], report: null }) {
    const scene = readScene(reply.scene);
    if (reply.written) scene.paths[0].written = reply.written;
    scene.paths.push(...known.paths);
    scene.report ??= known.report;
    scene.notes = reply.notes ?? [];
    this.open = true;
    this.describe(reply);
    this.viewer.show(scene, { keepCamera: how === "edit" });
    this.ends.show(scene);
    showNote((reply.warnings ?? []).join(". "));
    for (const listener of this.onopened) listener(reply, how);
  }
  /** What the session says of its scene. @param {Message} reply */
  describe({ document = null, unedited = null, links = false, trajectories = false, parts_left: partsLeft = 0 }) {
    const which = JSON.stringify([partsLeft, document], (key, value) => (UNIMPORTANT.includes(key) ? undefined : value));
    Object.assign(this, { document, unedited, links, trajectories, partsLeft, which });
  }

  /** Opens the next part of the motion, in which nothing is edited; asks first when there are unsaved changes.
   * @param {number[]} row where this one ends @returns {Promise<boolean>} */
  async nextPart(row) {
    if (!(await mayDiscard())) return false;
    return this.replace(async () => this.take(await this.session.request({ do: "next", row }), "edit"));
  }
  /** The page shows something else than the scene of the session: there is nothing to edit or to plan. */
  leave() {
    this.open = false;
    this.document = this.unedited = null;
    this.ends.scene = null;
    for (const listener of this.onleft) listener();
  }
  /** Takes the session's scene without showing it again: the page shows it already. @param {Message} reply */
  adopt(reply) {
    this.open = true;
    this.describe(reply);
    this.ends.show(this.viewer.scene);
    this.viewer.scene.notes = reply.notes ?? [];
    this.viewer.panels?.showFacts();
    for (const listener of this.onopened) listener(reply, "open");
  }
  /** The planner is gone: what is shown stays. @param {SessionError} error */
  lost(error) {
    for (const listener of this.onlost) listener(error);
    const again = async () => {
      showError("Connecting…");
      await this.session.reconnect().then(() => showError(""), (e) => this.lost(e));
    };
    showError(error, button("Reconnect", again));
  }
  /** Does something that may fail; then says why, and what to do. @param {() => Promise<void>} task @returns {Promise<boolean>} whether it succeeded */
  async attempt(task) {
    try {
      await task();
      return true;
    } catch (error) {
      showError(error);
      return false;
    }
  }
}
