// The page: reads the scene inside, or asks the planner for one, and shows it.

import { SafeCopy } from "mp/copy.js";
import { showError } from "mp/dom.js";
import { Editor } from "mp/editor.js";
import { EndsPanel } from "mp/endspanel.js";
import { FieldLayer } from "mp/field.js";
import { follow, follows } from "mp/following.js";
import { Gallery } from "mp/gallery.js";
import { Inspector } from "mp/inspector.js";
import { decode } from "mp/message.js";
import { Opening } from "mp/opening.js";
import { unpack } from "mp/packed.js";
import { PlanningPanel } from "mp/planning.js";
import { SaveDialog } from "mp/saving.js";
import { readScene } from "mp/scene.js";
import { sessionOfPage } from "mp/session.js";
import { TimingPanel } from "mp/timing.js";
import { Viewer } from "mp/viewer.js";
import { Workbench } from "mp/workbench.js";

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

/** Shows a scene file, or an empty picture. @param {Uint8Array | null} bytes @returns {Viewer} */
function show(bytes) {
  const scene = bytes && readScene(bytes);
  const viewer = new Viewer();
  if (scene) viewer.show(scene);
  viewer.draw();
  document.body.classList.remove("loading");
  return viewer;
}

/** Makes the page one that builds and plans. @param {Session} session @param {Viewer} viewer @returns {Promise<Workbench>} */
async function connect(session, viewer) {
  const workbench = new Workbench(viewer, session, await session.request({ do: "hello" }));
  const editor = new Editor(workbench);
  const copy = new SafeCopy(editor);
  const opening = new Opening(editor);
  const gallery = new Gallery(workbench);
  const saving = new SaveDialog(workbench);
  opening.saveBy(saving);
  saving.copy = (name) => copy.saved(name);
  new Inspector(editor, () => opening.chooseMesh());
  new PlanningPanel(workbench);
  new TimingPanel(workbench, () => saving.show("save_trajectory"));
  new EndsPanel(workbench);
  new FieldLayer(workbench);
  const { opened } = workbench.hello;
  if (opened) workbench.take(opened, "open");
  else if (viewer.scene.bodies.length) await openInside(workbench);
  if (copy.offer() || opened || viewer.scene.bodies.length) return workbench;
  if (workbench.hello.scenes.length) gallery.show();
  else await editor.create();
  return workbench;
}

/** Opens the scene inside the page also in the planner: by the request that is in the page, or as a shipped scene of this name.
 * @param {Workbench} workbench */
async function openInside(workbench) {
  const { session, viewer, hello } = workbench;
  const { name, columns, bodies, meshes } = viewer.scene;
  const packed = document.getElementById("open")?.textContent;
  const request = packed ? decode(await unpack(packed), "message") : hello.scenes.includes(name) ? { do: "open", scene: name } : null;
  if (!request) return;
  const reply = await session.request(request);
  const scene = readScene(reply.scene);
  // Large meshes are not in the page twice: they come from the files of the scene.
  if (meshes.length && meshes.every((mesh) => !mesh.triangles.length)) workbench.take(reply, "open", viewer.scene);
  // Another scene may have the same name.
  else if (scene.columns.length === columns.length && scene.bodies.length === bodies.length) workbench.adopt(reply);
}

/** @type {Viewer | null} */
let shown = null;
const session = sessionOfPage();
const viewer = (async () => (shown = show((await sceneInside()) ?? (session ? null : await sceneBeside()))))();
/** Resolves when the first picture is drawn; rejects when the scene cannot be shown. */
const ready = viewer.then(() => {});
/** Resolves when the planner is there, to null in a page without one. */
const planner = viewer.then((it) => session && connect(session, it));
planner.catch(showError);
if (follows()) viewer.then(follow).catch(showError);
ready.catch(() => {});

/** @returns {Viewer} */
function present() {
  if (!shown) throw new Error("No scene is shown.");
  return shown;
}

Object.assign(window, {
  mpView: {
    ready,
    planner,
    /** @param {number} part of the path: 0 is the start, 1 the end */
    setTime: (part) => present().timeline.scrub(part * present().timeline.last),
    /** @param {Animation | Mode} mode */
    setMode: (mode) => present().setMode(mode),
    draw: () => present().draw(),
    /** As a click on the picture. @param {number} x @param {number} y pixels */
    click: (x, y) => present().click(x, y),
    stats: () => present().stats,
  },
});
