// Files into the page: the menu, dropping files, and what becomes of each.

import { button, showError } from "mp/dom.js";
import { askRole, HELP } from "mp/editor.js";
import { chooseFiles, kindOf, mainOf, offered, readFiles } from "mp/files.js";
import { readPath, readScene } from "mp/scene.js";
import { mayDiscard, setUnsaved } from "mp/unsaved.js";

/** @import { Editor } from "mp/editor.js" */
/** @import { Endings, NamedFile } from "mp/files.js" */
/** @import { Document } from "mp/document.js" */
/** @import { SaveDialog } from "mp/saving.js" */

export class Opening {
  /** @param {Editor} editor */
  constructor(editor) {
    this.editor = editor;
    this.workbench = editor.workbench;
    this.viewer = editor.viewer;
    this.session = editor.workbench.session;
    /** @type {Endings} */ this.endings = editor.workbench.hello.endings;
    this.undo = button("↶", () => editor.undo(), { "aria-label": "Undo" });
    this.redo = button("↷", () => editor.redo(), { "aria-label": "Redo" });
    this.viewer.addMenu(button("New", () => editor.create(), { title: "New environment" }));
    this.viewer.addMenu(button("Open…", () => this.choose(), { title: "Open files (Ctrl + O)" }));
    this.viewer.panels?.addHelp(HELP);
    editor.onchange.push(() => this.update());
    addEventListener("keydown", (e) => this.key(e));
    this.listenToDrops();
    this.update();
  }
  /** Saves what is edited by this dialog; what comes after it in the menu. @param {SaveDialog} saving */
  saveBy(saving) {
    this.saving = saving;
    saving.document = () => this.editor.document;
    saving.onsaved = (document) => {
      this.editor.history?.markSaved(/** @type {Document} */ (document));
      this.editor.refresh();
    };
    this.viewer.addMenu(this.undo);
    this.viewer.addMenu(this.redo);
  }
  update() {
    const { history } = this.editor;
    for (const [control, word, label] of /** @type {[HTMLButtonElement, string, string | null][]} */ ([
      [this.undo, "Undo", history?.undoLabel ?? null], [this.redo, "Redo", history?.redoLabel ?? null]])) {
      control.disabled = label === null;
      control.title = label ? `${word}: ${label}` : `Nothing to ${word.toLowerCase()}`;
    }
  }
  key(/** @type {KeyboardEvent} */ e) {
    if (!(e.ctrlKey || e.metaKey) || e.altKey || e.shiftKey || document.querySelector("dialog[open]")) return;
    if (e.key === "o") this.choose();
    else if (e.key === "s") this.saving?.show();
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
  choose() { return this.workbench.attempt(async () => this.take(await chooseFiles(offered(this.endings), true))); }

  chooseMesh() { return this.workbench.attempt(async () => this.addMeshes(await chooseFiles(offered(this.endings, ["mesh", "text"]), true))); }

  /** Does with files what they are for. @param {NamedFile[]} files */
  async take(files) {
    const of = (/** @type {string} */ kind) => files.filter((file) => kindOf(file, this.endings) === kind);
    const [viewer, scenes, meshes, paths] = [of("viewer"), of("scene"), of("mesh"), of("path")];
    if (viewer.length) return this.showOnly(viewer[0]);
    if (scenes.length) {
      const needed = files.filter((file) => kindOf(file, this.endings) !== "path");
      if (!(await this.workbench.openScene({ files: needed, main: mainOf(scenes, this.endings) }))) return;
    } else if (meshes.length) await this.addMeshes(meshes);
    else if (!paths.length && files.length) throw new Error(`“${files[0].name}” is no file that is read here. Scenes, meshes and paths end in ${offered(this.endings).replaceAll(",", " ")}.`);
    if (paths.length) await this.addPaths(paths);
  }
  /** A scene file of the viewer is shown without the session: there is nothing to plan in it. @param {NamedFile} file */
  async showOnly({ bytes }) {
    const scene = readScene(bytes);
    if (!(await mayDiscard())) return;
    this.workbench.leave();
    this.viewer.show(scene);
    setUnsaved(false);
    showError("");
  }
  /** @param {NamedFile[]} files */
  async addMeshes(files) {
    if (!files.length) return;
    if (!this.editor.history) await this.editor.create();
    const { document } = this.editor;
    if (!document) return;
    if (!document.robot && document.plane) throw new Error("A world in the plane has no meshes. Add a rectangle, a circle or a triangle.");
    for (const file of files) {
      const { file: name, bounds } = await this.session.request({ do: "mesh", files: [file] });
      const reach = Math.hypot(...[0, 1, 2].map((k) => Math.max(-bounds[0][k], bounds[1][k])));
      const stem = file.name.replace(/\.[^.]*$/, "") || file.name;
      await this.editor.add(stem, { mesh: { file: name } }, document.robot ? await askRole(file.name) : "obstacle", reach);
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
      this.viewer.choosePath(this.viewer.addPath({ ...path, written: reply.written }));
      faults.push(...(reply.faults ?? []).map((/** @type {string} */ fault) => `${file.name}: ${fault}`));
    }
    showError(faults.join(" "));
  }
}
