// The page: reads the scene inside, or asks the planner for one, and shows it.

import { showError } from "mp/dom.js";
import { unpack } from "mp/packed.js";
import { readScene } from "mp/scene.js";
import { sessionOfPage } from "mp/session.js";
import { Viewer } from "mp/viewer.js";
import { Workbench } from "mp/workbench.js";

/** @import { Message } from "mp/message.js" */
/** @import { Animation } from "mp/picture.js" */
/** @import { Mode } from "mp/renderer.js" */
/** @import { Session } from "mp/session.js" */

/** The bytes of the scene in this page, or null. @returns {Promise<Uint8Array | null>} */
async function sceneInside() {
  const inside = document.getElementById("scene")?.textContent?.trim();
  return inside ? unpack(inside) : null;
}

/** The bytes of the scene beside a page without planner. @returns {Promise<Uint8Array>} */
async function sceneBeside() {
  const none = "This page holds no scene, and there is no file scene.mpv beside it.";
  if (location.protocol === "file:") throw new Error(none);
  const answer = await fetch("scene.mpv").catch(() => null);
  if (!answer?.ok) throw new Error(none);
  return new Uint8Array(await answer.arrayBuffer());
}

/** @type {Viewer | null} */
let viewer = null;

/** @returns {Viewer} */
function present() {
  if (!viewer) throw new Error("No scene is shown.");
  return viewer;
}

/** Shows a scene file. @param {Uint8Array | null} bytes */
function show(bytes) {
  const scene = bytes && readScene(bytes);
  viewer = new Viewer();
  if (scene) viewer.show(scene);
  viewer.draw();
  document.body.classList.remove("loading");
}

/** Makes the page one that builds and plans. @param {Session} session @param {Viewer} viewer @param {boolean} shown whether a scene is shown */
async function connect(session, viewer, shown) {
  const workbench = new Workbench(viewer, session, await session.request({ do: "hello" }));
  const { opened, scenes } = workbench.hello;
  if (opened) workbench.take(opened, "open");
  else if (shown) await openInside(workbench, scenes);
  return workbench;
}

/** Opens the scene inside the page also in the planner, as a shipped scene of this name.
 * @param {Workbench} workbench @param {string[]} shipped */
async function openInside(workbench, shipped) {
  const { session, viewer } = workbench;
  const name = viewer.scene.name;
  if (!shipped.includes(name)) return;
  const reply = await session.request({ do: "open", scene: name });
  const { columns, bodies } = readScene(reply.scene);
  if (columns.length === viewer.scene.columns.length && bodies.length === viewer.scene.bodies.length) workbench.adopt(reply);
}

/** Resolves when the first picture is drawn; rejects when the scene cannot be shown. */
const session = sessionOfPage();
const ready = (async () => {
  const inside = await sceneInside();
  show(inside ?? (session ? null : await sceneBeside()));
  return inside !== null;
})();
/** Resolves when the planner is there, to null in a page without one. */
const planner = ready.then((shown) => session && connect(session, present(), shown));
for (const step of [ready, planner]) step.catch(showError);

Object.assign(window, {
  mpView: {
    ready,
    planner,
    /** @param {number} part of the path: 0 is the start, 1 the end */
    setTime: (part) => {
      const { timeline } = present();
      timeline.scrub(part * timeline.last);
    },
    /** @param {Animation | Mode} mode */
    setMode: (mode) => present().setMode(mode),
    draw: () => present().draw(),
    stats: () => present().stats,
  },
});
