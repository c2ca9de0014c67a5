// The gallery: the scenes that come with the program, in groups, each with a picture and a sentence; one click opens one.

import { button, el } from "mp/dom.js";
import { isTyping } from "mp/controls.js";

/** @import { Workbench } from "mp/workbench.js" */
/** @typedef {{title: string, scenes: [string, string][]}} Group names, each with a sentence */

export class Gallery {
  constructor(/** @type {Workbench} */ workbench) {
    this.workbench = workbench;
    /** Addresses of the pictures that have been drawn, by scene. @type {Map<string, string>} */ this.pictures = new Map();
    /** Pictures to draw, one at a time. @type {HTMLImageElement[]} */ this.waiting = [];
    this.drawing = false;
    if (!workbench.hello.scenes.length) return;
    workbench.viewer.addMenu(button("Gallery…", () => this.show(), { "aria-haspopup": "dialog", title: "Scenes that come with the program (G)" }));
    workbench.viewer.keys.push((e) => this.key(e));
    workbench.viewer.panels?.addHelp([["G", "the gallery of scenes"]]);
  }
  show() {
    const dialog = el("dialog", { "aria-label": "Gallery", class: "gallery" });
    /** @type {Group[]} */ const groups = this.workbench.hello.gallery;
    // Only what is seen is drawn.
    const seen = new IntersectionObserver((entries) => {
      for (const { isIntersecting, target } of entries) if (isIntersecting) this.want(/** @type {HTMLImageElement} */ (target), seen);
    });
    const open = (/** @type {string} */ scene) => {
      dialog.close();
      this.workbench.openScene({ scene });
    };
    const lists = groups.map(({ title, scenes }) => {
      const items = scenes.map(([name, about]) => {
        const text = el("span", {}, el("strong", {}, name), el("small", {}, about));
        const item = el("li", {}, el("button", { type: "button", value: name, title: about, "aria-label": name, onclick: () => open(name) }, ...this.picture(name, seen), text));
        return { item, words: `${name} ${about} ${title}`.toLowerCase() };
      });
      return { items, section: el("section", {}, el("h3", {}, title), el("ul", {}, ...items.map(({ item }) => item))) };
    });
    const search = el("input", { type: "search", placeholder: "part of a name or of what it is", "aria-label": "Search the scenes", oninput: () => {
      const wanted = search.value.trim().toLowerCase();
      for (const { items, section } of lists) {
        for (const { item, words } of items) item.hidden = !words.includes(wanted);
        section.hidden = items.every(({ item }) => item.hidden);
      }
    } });
    const count = groups.reduce((sum, { scenes }) => sum + scenes.length, 0);
    dialog.append(el("h2", {}, `Scenes that come with the program (${count})`), search, el("div", { class: "groups" }, ...lists.map(({ section }) => section)), button("Close", () => dialog.close()));
    dialog.addEventListener("close", () => {
      seen.disconnect();
      this.waiting = [];
      dialog.remove();
    });
    document.body.append(dialog);
    dialog.showModal();
  }
  /** The picture of a scene, if there are pictures. @param {string} name @param {IntersectionObserver} seen @returns {HTMLElement[]} */
  picture(name, seen) {
    if (!this.workbench.hello.thumbnails) return [];
    const image = el("img", { alt: "", width: 220, height: 150, "data-scene": name });
    const known = this.pictures.get(name);
    if (known) image.src = known;
    else seen.observe(image);
    return [image];
  }
  /** @param {HTMLImageElement} image @param {IntersectionObserver} seen */
  want(image, seen) {
    seen.unobserve(image);
    this.waiting.push(image);
    if (!this.drawing) this.draw();
  }
  async draw() {
    this.drawing = true;
    for (let image = this.waiting.shift(); image; image = this.waiting.shift()) {
      const scene = image.dataset.scene ?? "";
      // Without a picture there are words.
      const { png } = await this.workbench.session.request({ do: "thumbnail", scene }).catch(() => ({ png: null }));
      if (!png) continue;
      image.src = URL.createObjectURL(new Blob([png], { type: "image/png" }));
      this.pictures.set(scene, image.src);
    }
    this.drawing = false;
  }
  key(/** @type {KeyboardEvent} */ e) {
    if (e.key !== "g" || isTyping(e.target)) return false;
    this.show();
    return true;
  }
}
