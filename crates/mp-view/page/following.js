// A page that a program has opened, a script or a notebook: it shows the scenes and paths that the program sends.

import { byId, showError } from "mp/dom.js";
import { decode } from "mp/message.js";
import { readPath, readScene } from "mp/scene.js";
import { framesOf } from "mp/session.js";

/** @import { Viewer } from "mp/viewer.js" */

/** Whether this is such a page. */
export const follows = () => document.querySelector('meta[name="mp-session"][content="shown"]') !== null;

/** Shows what comes until the program ends. What was shown stays. @param {Viewer} viewer */
export async function follow(viewer) {
  const answer = await fetch("shown", { cache: "no-store" });
  if (!answer.ok || !answer.body) throw new Error("The program that opened this page shows nothing here any more: let it show its scene again.");
  try {
    for await (const bytes of framesOf(answer.body.getReader())) if (bytes.length) attempt(() => take(viewer, bytes));
  } catch {
    // A stream that breaks off has ended too: its program is gone.
  }
  byId("hint").textContent = "The program that showed this has ended.";
}

/** What cannot be shown is said, and what comes after it is shown. @param {() => void} show */
function attempt(show) {
  try {
    show();
  } catch (error) {
    showError(error);
  }
}

/** Shows a scene file, or a path of the scene that is shown: in the place of the one with the same name.
 * @param {Viewer} viewer @param {Uint8Array} bytes */
function take(viewer, bytes) {
  const { path } = decode(bytes, "message");
  if (!path) return viewer.show(readScene(bytes), { keepCamera: true });
  const { scene } = viewer;
  const shown = readPath(path, scene.columns.length, scene.robot);
  const known = scene.paths.findIndex(({ name }) => name === shown.name);
  if (known < 0) return viewer.choosePath(viewer.addPath(shown));
  viewer.setPath(known, shown);
  if (viewer.settings.path !== known) viewer.choosePath(known);
}
