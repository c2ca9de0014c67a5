// Whether there are changes that no file has. The browser asks before such a page is closed.

import { ask } from "mp/dom.js";

let unsaved = false;

const warn = (/** @type {BeforeUnloadEvent} */ e) => e.preventDefault();

/** @param {boolean} on */
export function setUnsaved(on) {
  if (on === unsaved) return;
  unsaved = on;
  document.body.classList.toggle("unsaved", on);
  if (on) addEventListener("beforeunload", warn);
  else removeEventListener("beforeunload", warn);
}

export const isUnsaved = () => unsaved;

/** Asks whether unsaved changes may be lost, if there are any. @returns {Promise<boolean>} */
export const mayDiscard = async () => !unsaved || ask("The scene has changes that are not saved.", "Discard them", "Keep them");
