// A copy of what is edited, which needs no planner: it can be saved when the planner is gone, and it is offered after a crash or a reload.

import { button, showError, showNote } from "mp/dom.js";
import { fileName } from "mp/saving.js";
import { SessionError } from "mp/session.js";

/** @import { Document, DocumentBody, Environment } from "mp/document.js" */
/** @import { Editor } from "mp/editor.js" */
/** @import { Message } from "mp/message.js" */

/** Pages from files share one storage; each server has its own. */
const KEY = `mp copy ${location.protocol === "file:" ? location.pathname : ""}`;
/** How long after a change it is kept, milliseconds. */
const DELAY = 500;

/** What the browser keeps, or null. A page in a frame may have no storage. Changes of a problem are those of the obstacles `first`.
 * @returns {{name: string, time: number, text: string, first?: string} | null} */
function kept() {
  try {
    return JSON.parse(localStorage.getItem(KEY) ?? "null");
  } catch {
    return null;
  }
}

/** Puts a copy in the place of the last one; without room for it there is none. @param {object | null} copy */
function keep(copy) {
  try {
    localStorage.removeItem(KEY);
    if (copy) localStorage.setItem(KEY, JSON.stringify(copy));
  } catch {
    // The page says in time that it has unsaved changes.
  }
}

export class SafeCopy {
  /** @param {Editor} editor */
  constructor(editor) {
    this.editor = editor;
    /** The triangles of meshes, as texts of OFF files. @type {Map<string, string>} */ this.meshes = new Map();
    /** The reply to `save` for a problem, whose text the planner makes, and what it was made of. @type {{of: string, reply: Message} | null} */ this.problem = null;
    /** Whether the copy that is kept is of this page. */ this.own = false;
    /** @type {Document | null} */ this.last = null;
    /** @type {ReturnType<typeof setTimeout> | undefined} */ this.soon = undefined;
    editor.onchange.push(() => this.changed());
    // The ends of a problem are not in its history.
    editor.ends.onchange.push((_, settled) => settled && this.last && !this.last.robot && this.later());
  }
  changed() {
    const { history, first } = this.editor;
    if (history?.document === this.last && history?.dirty === this.own) return;
    this.last = history?.document ?? null;
    if (this.last === first) this.problem = null;
    if (history?.dirty) this.later();
    else {
      clearTimeout(this.soon);
      if (this.own) keep(null);
    }
    this.own = history?.dirty ?? false;
  }
  later() {
    clearTimeout(this.soon);
    this.soon = setTimeout(() => this.renew(), DELAY);
  }
  async renew() {
    const document = this.last;
    // Without the planner what it said before is known.
    await this.learn().catch(() => {});
    if (!document || document !== this.last || !this.own) return;
    const first = document.robot ? {} : { first: JSON.stringify(this.editor.first?.obstacles) };
    keep({ name: document.name, time: Date.now(), text: this.text(), ...first });
  }
  /** Asks for the triangles of meshes that are new, or for the text of a problem. */
  async learn() {
    const document = this.last;
    const unknown = (/** @type {DocumentBody} */ { shape }) => "mesh" in shape && !this.meshes.has(shape.mesh.file);
    if (!document || (document.robot && ![document.robot, ...document.obstacles].some(unknown))) return;
    const edited = this.editor.workbench.withEnds(document);
    const reply = await this.editor.workbench.session.request({ do: "save", format: "own", name: fileName(document.name), document: edited, content: true });
    if (document !== this.last) return;
    if (!document.robot) {
      this.problem = { of: JSON.stringify(edited), reply };
      return;
    }
    /** @type {Environment} */ const whole = JSON.parse(new TextDecoder().decode(reply.files[0].bytes));
    for (const [i, { shape }] of [document.robot, ...document.obstacles].entries()) {
      const saved = [whole.robot, ...whole.obstacles][i].shape;
      if ("mesh" in shape && "mesh" in saved && saved.mesh.off) this.meshes.set(shape.mesh.file, saved.mesh.off);
    }
  }
  /** What is edited, as the planner would reply to `save`. @param {string} name of the file, without its ending @returns {Message} */
  saved(name) {
    const { document, workbench } = this.editor;
    if (document?.robot) return { files: [{ name: `${name}.mp.json`, bytes: new TextEncoder().encode(this.text()) }] };
    const { problem } = this;
    if (!problem || problem.of !== JSON.stringify(document && workbench.withEnds(document))) {
      throw new SessionError("The planner stopped before the page had the text of this change.", "Press “Reconnect” and save again; or reload the page when “mp view” runs again.", true);
    }
    const [{ bytes }, ...beside] = problem.reply.files;
    return { ...problem.reply, files: [{ name: `${name}.toml`, bytes }, ...beside] };
  }
  /** What is edited, as a scene file of its own. */
  text() {
    const { document, workbench } = this.editor;
    const whole = (/** @type {string} */ key, /** @type {any} */ value) => (key === "mesh" ? { ...value, off: this.meshes.get(value.file) } : value);
    return `${JSON.stringify(document && workbench.withEnds(document), whole, 1)}\n`;
  }
  /** Takes the obstacles of a problem, when it is open. @param {string} text @param {string} first its obstacles without the changes */
  async takeProblem(text, first) {
    const { editor } = this;
    const copy = JSON.parse(text);
    const { document } = editor;
    if (document?.robot !== undefined || document?.name !== copy.name || JSON.stringify(editor.first?.obstacles) !== first) {
      return showError(`The changes are of the obstacles of “${copy.name}”: open it as it was, then reload the page.`);
    }
    await editor.run("open the copy", () => copy);
    showNote("");
  }
  /** Offers the copy of the last time, if there is one. Returns whether there is. */
  offer() {
    const copy = kept();
    if (!copy) return false;
    const take = async () => {
      if (copy.first !== undefined) return this.takeProblem(copy.text, copy.first);
      const bytes = new TextEncoder().encode(copy.text);
      const { workbench } = this.editor;
      if (await workbench.openScene({ files: [{ name: "copy.mp.json", bytes }] })) this.editor.changedSinceOpened();
    };
    const forget = () => {
      keep(null);
      showNote("");
    };
    const time = new Date(copy.time).toLocaleString();
    showNote(`“${copy.name}” had changes that were not saved. The page has a copy of ${time}.`, button("Open the copy", take), button("Discard it", forget));
    return true;
  }
}
