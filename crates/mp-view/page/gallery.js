// The gallery: the scenes that come with the program; one click opens one.

import { button, el } from "mp/dom.js";
import { isTyping } from "mp/controls.js";

/** @import { Workbench } from "mp/workbench.js" */

export class Gallery {
  constructor(/** @type {Workbench} */ workbench) {
    this.workbench = workbench;
    if (!workbench.hello.scenes.length) return;
    workbench.viewer.addMenu(button("Gallery…", () => this.show(), { "aria-haspopup": "dialog", title: "Scenes that come with the program (G)" }));
    workbench.viewer.keys.push((e) => this.key(e));
    workbench.viewer.panels?.addHelp([["G", "the gallery of scenes"]]);
  }
  show() {
    const dialog = el("dialog", { "aria-label": "Gallery", class: "gallery" });
    const open = (/** @type {string} */ scene) => {
      dialog.close();
      this.workbench.openScene({ scene });
    };
    /** @type {string[]} */ const names = this.workbench.hello.scenes;
    const items = names.map((name) => el("li", {}, button(name, () => open(name))));
    const search = el("input", { type: "search", placeholder: "part of a name", "aria-label": "Search the scenes", oninput: () => {
      names.forEach((name, i) => (items[i].hidden = !name.includes(search.value.trim().toLowerCase())));
    } });
    dialog.append(el("h2", {}, `Scenes that come with the program (${names.length})`), search, el("ul", {}, ...items), button("Close", () => dialog.close()));
    dialog.addEventListener("close", () => dialog.remove());
    document.body.append(dialog);
    dialog.showModal();
  }
  key(/** @type {KeyboardEvent} */ e) {
    if (e.key !== "g" || isTyping(e.target)) return false;
    this.show();
    return true;
  }
}
