// Saving: the environment, the path, the page and the scene, as files beside the scene or as downloads; pictures and films as downloads.

import { button, checkbox, el, labelled, select } from "mp/dom.js";
import { filmOf, pictureOf } from "mp/recording.js";

/** @import { Message } from "mp/message.js" */
/** @import { Path } from "mp/scene.js" */
/** @import { Workbench } from "mp/workbench.js" */

/** @typedef {"save" | "save_path" | "save_trajectory" | "export" | "picture" | "film"} Saving  the last two need no planner */
/** What can be saved: label, request, format. @type {[label: string, request: Saving, format: string][]} */
const KINDS = [
  ["the environment, to edit again (.mp.json)", "save", "own"],
  ["the environment for GEMPA (.env and meshes)", "save", "gempa"],
  ["the problem with its obstacles (.toml)", "save", "own"],
  ["the path, as text", "save_path", "txt"],
  ["the path, as JSON", "save_path", "json"],
  ["the path, as CSV", "save_path", "csv"],
  ["the trajectory, as CSV", "save_trajectory", "csv"],
  ["the trajectory for ROS, as JSON", "save_trajectory", "json"],
  ["the trajectory for ROS, as YAML", "save_trajectory", "yaml"],
  ["the trajectory with what it moves, for Foxglove (MCAP)", "save_trajectory", "mcap"],
  ["this page, to send (HTML)", "export", "html"],
  ["the scene for the viewer (MPV)", "export", "mpv"],
  ["the scene with its paths, for Blender (GLB)", "export", "glb"],
  ["a picture of what is shown (PNG)", "picture", "png"],
  ["a film of the path, played once as it is shown", "film", ""],
];
/** The one of these for a problem in a file; those before it are for environments. */
const PROBLEM = 2;

/** Gives a file to the browser to save. @param {string} name @param {Uint8Array} bytes */
export function download(name, bytes) {
  const address = URL.createObjectURL(new Blob([/** @type {BlobPart} */ (bytes)]));
  el("a", { href: address, download: name }).click();
  // The browser reads the address soon after the click.
  setTimeout(() => URL.revokeObjectURL(address), 60000);
}

/** Hands over what a request to save gave, and says where it is. @param {Message} reply @param {string | null} folder */
export function deliver(reply, folder) {
  const note = reply.note ? ` ${reply.note}` : "";
  if (reply.written?.length) return `Written to ${folder ?? "the folder"}: ${reply.written.join(", ")}.${note}`;
  const files = reply.files ?? [];
  for (const { name, bytes } of files) download(name, bytes);
  return `Saved: ${files.map((/** @type {{name: string}} */ f) => f.name).join(", ")}.${note}`;
}

/** A path's configurations, each as a list of numbers. @param {Path} path @param {number} columns @returns {number[][]} */
export const rowsOf = (path, columns) => path.written ?? Array.from({ length: path.count }, (_, i) => [...path.rows.subarray(i * columns, (i + 1) * columns)]);

/** A file name made of a scene's name. @param {string} name */
export const fileName = (name) => name.replace(/[^\p{L}\p{N}._-]+/gu, "-").replace(/^[.-]+|[.-]+$/g, "") || "scene";

/** The dialog that saves. */
export class SaveDialog {
  constructor(/** @type {Workbench} */ workbench) {
    this.workbench = workbench;
    /** The document as it is now, edited or not. @type {() => Message | null} */ this.document = () => workbench.document;
    /** The document as files of this name, for when the planner is gone. @type {(name: string) => Message} */ this.copy = () => ({});
    /** Called when a document was saved. @type {(document: Message) => void} */ this.onsaved = () => {};
    this.opener = button("Save…", () => this.show(), { "aria-haspopup": "dialog", title: "Save (Ctrl + S)" });
    this.opener.disabled = true;
    workbench.viewer.addMenu(this.opener);
    workbench.onopened.push(() => (this.opener.disabled = false));
    workbench.onleft.push(() => (this.opener.disabled = true));
  }
  /** @param {Saving | ""} [wanted] what is chosen at first */
  show(wanted = "") {
    const { viewer } = this.workbench;
    if (this.opener.disabled) return;
    const path = viewer.scene.paths[viewer.settings.path];
    const edited = this.document();
    /** @type {[string, string][]} */
    const options = KINDS.map(([label], i) => [String(i), label]);
    const can = { save_path: path, save_trajectory: path?.trajectory, export: true, picture: true, film: path };
    const possible = options.filter((_, i) => {
      const [, request] = KINDS[i];
      return request === "save" ? edited && (i === PROBLEM) === !edited.robot : can[request];
    });
    const first = possible.find(([i]) => KINDS[Number(i)][1] === wanted) ?? possible[0];
    const kind = select(possible, first[0], () => {});
    const name = el("input", { type: "text", value: fileName(String(edited?.name ?? viewer.scene.name)), required: true });
    const note = el("p", { role: "status" });
    const dialog = el("dialog", { "aria-label": "Save" });
    const save = async () => {
      const [, request, format] = KINDS[Number(kind.value)];
      note.textContent = "Saving…";
      const replace = overwrite.querySelector("input")?.checked ?? false;
      const problem = await this.save(request, format, name.value.trim(), replace).then((text) => void (note.textContent = text), (error) => error);
      if (!problem) return;
      note.replaceChildren(el("strong", { class: "bad" }, problem.message), el("small", {}, problem.help ?? ""));
    };
    const folder = this.workbench.hello.folder;
    const overwrite = checkbox("replace a file with this name", false, () => {});
    overwrite.hidden = !folder;
    const where = el("small", {}, folder ? `The file is written to ${folder}.` : "The file comes as a download.");
    dialog.append(el("h2", {}, "Save"), labelled("What", kind), labelled("Name", name), where, overwrite, note,
      el("div", { class: "buttons" }, button("Save", save, { class: "main" }), button("Close", () => dialog.close())));
    dialog.addEventListener("close", () => dialog.remove());
    document.body.append(dialog);
    dialog.showModal();
  }
  /** Saves, and says where the files are. @param {Saving} request @param {string} format @param {string} name
   * @param {boolean} overwrite whether files that are there already are replaced @returns {Promise<string>} */
  async save(request, format, name, overwrite) {
    const { viewer, session, hello, ends } = this.workbench;
    if (request === "picture" || request === "film") {
      const blob = await (request === "picture" ? pictureOf(viewer) : filmOf(viewer));
      const ending = blob.type.replace(/^\w+\/(\w+).*$/, "$1");
      return deliver({ files: [{ name: `${name}.${ending}`, bytes: new Uint8Array(await blob.arrayBuffer()) }] }, null);
    }
    const { scene, settings } = viewer;
    const columns = scene.columns.length;
    const path = scene.paths[settings.path];
    const edited = request === "save" ? this.document() : null;
    const what = {
      save: { document: edited && this.workbench.withEnds(edited) },
      save_path: { rows: path ? rowsOf(path, columns) : [] },
      save_trajectory: { knots: path?.trajectory?.knots },
      export: { paths: scene.paths.map((p) => ({ name: p.name, rows: rowsOf(p, columns) })), ...ends.request() },
    }[request];
    let gone = "";
    const reply = await session.request({ do: request, format, name, ...what, ...(overwrite ? { overwrite } : {}) }).catch((error) => {
      if (!error.gone || format !== "own" || !edited) throw error;
      gone = "The planner does not answer. ";
      return this.copy(name);
    });
    if (edited) this.onsaved(edited);
    return gone + deliver(reply, hello.folder);
  }
}
