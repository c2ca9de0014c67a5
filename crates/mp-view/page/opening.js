// Files into the page and out of it: the menu, dropping files, what becomes of each, and saving.

import { ask, button, el, labelled, select, showError } from "mp/dom.js";
import { askRole, HELP } from "mp/editor.js";
import { ENDINGS, MESH_ENDINGS, chooseFiles, download, kindOf, readFiles } from "mp/files.js";
import { readPath, readScene } from "mp/scene.js";
import { mayDiscard, setUnsaved } from "mp/unsaved.js";

/** @import { Editor } from "mp/editor.js" */
/** @import { NamedFile } from "mp/files.js" */
/** @import { Message } from "mp/message.js" */
/** @typedef {"own" | "gempa"} Format */

export class Opening {
  /** @param {Editor} editor */
  constructor(editor) {
    this.editor = editor;
    this.workbench = editor.workbench;
    this.viewer = editor.viewer;
    this.session = editor.workbench.session;
    /** @type {Format} */ this.format = "own";
    this.save = button("Save…", () => this.askSave(), { title: "Save (Ctrl + S)" });
    this.undo = button("↶", () => editor.undo(), { "aria-label": "Undo" });
    this.redo = button("↷", () => editor.redo(), { "aria-label": "Redo" });
    this.said = el("span", { role: "status", class: "said" });
    const menu = [button("New", () => editor.create(), { title: "New environment" }), button("Open…", () => this.choose(), { title: "Open files (Ctrl + O)" }), this.save, this.undo, this.redo, this.said];
    for (const control of menu) this.viewer.addMenu(control);
    this.viewer.panels?.addHelp(HELP);
    editor.onchange.push(() => this.update());
    addEventListener("keydown", (e) => this.key(e));
    this.listenToDrops();
    this.update();
  }
  update() {
    const { history } = this.editor;
    if (history?.dirty) this.said.textContent = "";
    this.save.disabled = !this.workbench.open;
    for (const [control, word, label] of /** @type {[HTMLButtonElement, string, string | null][]} */ ([
      [this.undo, "Undo", history?.undoLabel ?? null], [this.redo, "Redo", history?.redoLabel ?? null]])) {
      control.disabled = label === null;
      control.title = label ? `${word}: ${label}` : `Nothing to ${word.toLowerCase()}`;
    }
  }
  key(/** @type {KeyboardEvent} */ e) {
    if (!(e.ctrlKey || e.metaKey) || e.altKey || e.shiftKey || document.querySelector("dialog[open]")) return;
    if (e.key === "o") this.choose();
    else if (e.key === "s" && this.workbench.open) this.askSave();
    else return;
    e.preventDefault();
  }
  listenToDrops() {
    addEventListener("dragover", (e) => {
      if (![...(e.dataTransfer?.types ?? [])].includes("Files")) return;
      e.preventDefault();
      document.body.classList.add("dropping");
    });
    addEventListener("dragleave", (e) => e.relatedTarget === null && document.body.classList.remove("dropping"));
    addEventListener("drop", (e) => {
      document.body.classList.remove("dropping");
      const files = [...(e.dataTransfer?.files ?? [])];
      if (!files.length) return;
      e.preventDefault();
      this.workbench.attempt(async () => this.take(await readFiles(files)));
    });
  }
  choose() { return this.workbench.attempt(async () => this.take(await chooseFiles(ENDINGS, true))); }

  chooseMesh() { return this.workbench.attempt(async () => this.addMeshes(await chooseFiles(MESH_ENDINGS, true))); }

  /** Does with files what they are for. @param {NamedFile[]} files */
  async take(files) {
    const of = (/** @type {string} */ kind) => files.filter((file) => kindOf(file) === kind);
    const [viewer, scenes, meshes, paths] = [of("viewer"), of("scene"), of("mesh"), of("path")];
    if (viewer.length) return this.showOnly(viewer[0]);
    if (scenes.length) {
      const needed = files.filter((file) => kindOf(file) !== "path");
      if (!(await this.workbench.openScene({ files: needed, ...(scenes.length === 1 && { main: scenes[0].name }) }))) return;
    } else if (meshes.length) await this.addMeshes(meshes);
    else if (!paths.length && files.length) throw new Error(`“${files[0].name}” is no file that is read here. Scenes, meshes and paths end in ${ENDINGS.replaceAll(",", " ")}.`);
    if (paths.length) await this.addPaths(paths);
  }
  /** A scene file of the viewer is shown without the session: there is nothing to plan in it. @param {NamedFile} file */
  async showOnly({ bytes }) {
    if (!(await mayDiscard())) return;
    const scene = readScene(bytes);
    this.workbench.leave();
    this.viewer.show(scene);
    setUnsaved(false);
    showError("");
  }
  /** @param {NamedFile[]} files */
  async addMeshes(files) {
    if (!files.length) return;
    if (!this.editor.history) await this.editor.create();
    if (!this.editor.history) return;
    for (const file of files) {
      const { file: name } = await this.session.request({ do: "mesh", files: [file] });
      const stem = file.name.replace(/\.[^.]*$/, "") || file.name;
      await this.editor.add(stem, { mesh: { file: name } }, await askRole(file.name));
    }
  }
  /** @param {NamedFile[]} files */
  async addPaths(files) {
    if (!this.workbench.open) throw new Error("A path is shown in its scene: open the scene first, or both files together.");
    const { scene } = this.viewer;
    /** @type {string[]} */ const faults = [];
    for (const file of files) {
      const reply = await this.session.request({ do: "path", files: [file] });
      const path = readPath(reply.path, scene.columns.length, scene.robot);
      this.viewer.choosePath(this.viewer.addPath(path));
      faults.push(...(reply.faults ?? []).map((/** @type {string} */ fault) => `${file.name}: ${fault}`));
    }
    showError(faults.join(" "));
  }
  /** Asks for name and format, and saves. */
  askSave() {
    const { document: edited } = this.editor;
    const name = el("input", { type: "text", "aria-label": "Name", value: edited?.name ?? this.viewer.scene.name });
    const format = select([["own", "our own (.mp.json), with names, colours and figures"], ["gempa", "GEMPA environment (.env) and its meshes"]], this.format, (v) => (this.format = /** @type {Format} */ (v)), { "aria-label": "Format" });
    const dialog = el("dialog", { "aria-label": "Save", class: "save" });
    const where = this.workbench.hello.folder ? `Files are written to ${this.workbench.hello.folder}.` : "The files are offered as downloads.";
    const form = el("form", { method: "dialog" },
      el("h2", {}, "Save the environment"), labelled("Name", name), labelled("Format", format), el("p", {}, where),
      el("div", { class: "buttons" }, button("Cancel", () => dialog.close()), el("button", { value: "save" }, "Save")));
    dialog.append(form);
    dialog.addEventListener("close", () => {
      dialog.remove();
      if (dialog.returnValue === "save") this.workbench.attempt(() => this.saveAs(name.value.trim() || "environment", this.format));
    });
    document.body.append(dialog);
    dialog.showModal();
    name.select();
  }
  /** @param {string} name @param {Format} format */
  async saveAs(name, format) {
    const { document: edited, history } = this.editor;
    const reply = await this.saved({ do: "save", document: edited, format, name });
    if (!reply) return;
    if (edited) history?.markSaved(edited);
    this.editor.refresh();
    const written = /** @type {string[] | undefined} */ (reply.written);
    if (!written?.length) download(reply.files ?? []);
    this.said.textContent = (written?.length ? `Saved: ${written.join(", ")}` : `Downloaded: ${reply.files.map((/** @type {NamedFile} */ f) => f.name).join(", ")}`);
  }
  /** The reply to a request to save; where a file is there already, it is asked whether to replace it. @param {Message} request @returns {Promise<Message | null>} */
  async saved(request) {
    try {
      return await this.session.request(request);
    } catch (error) {
      const exists = /exists/.test(error instanceof Error ? error.message : "");
      if (!exists || !(await ask(`${/** @type {Error} */ (error).message}.`, "Replace it", "Keep it"))) throw error;
      return this.session.request({ ...request, overwrite: true });
    }
  }
}
