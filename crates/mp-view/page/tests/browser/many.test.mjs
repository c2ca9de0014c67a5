// Panning and clicking with the tree of a long search: what a frame costs is counted, as clocks of busy machines say little.

import assert from "node:assert/strict";
import { browserTest, withPage } from "./browser.mjs";

const NODES = 34_000;

/** Counts what a frame hands to the graphics card, from now on. */
const countWork = (driver) => driver.page.evaluate(async () => {
  const { gl } = (await window.mpView.planner).viewer.renderer;
  const work = (window.work = { copies: 0, corners: 0, bytes: 0 });
  const wrap = (name, count) => {
    const original = gl[name].bind(gl);
    gl[name] = (...args) => {
      count(...args);
      return original(...args);
    };
  };
  wrap("drawArraysInstanced", (mode, first, corners, copies) => (work.copies += copies));
  wrap("drawArrays", (mode, first, corners) => { if (mode === gl.LINES) work.corners += corners; });
  wrap("bufferData", (target, data) => (work.bytes += data.byteLength ?? data));
  wrap("bufferSubData", (target, at, data) => (work.bytes += data.byteLength));
});
/** Does something in the page, and returns the work of each frame until the view is still. @param {(viewer: any) => void} act runs in the page */
const framesOf = (driver, act) => driver.page.evaluate(async (source) => {
  const { viewer } = await window.mpView.planner;
  const frames = [];
  const listener = () => {
    frames.push({ ...window.work });
    Object.assign(window.work, { copies: 0, corners: 0, bytes: 0 });
  };
  Object.assign(window.work, { copies: 0, corners: 0, bytes: 0 });
  viewer.ondraw.push(listener);
  const send = (type, x, y) => {
    const box = viewer.canvas.getBoundingClientRect();
    const place = { clientX: box.left + x, clientY: box.top + y };
    viewer.canvas.dispatchEvent(new PointerEvent(type, { pointerId: 1, pointerType: "mouse", bubbles: true, button: 0, buttons: type === "pointerup" ? 0 : 1, ...place }));
  };
  const frame = () => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
  await new Function("viewer", "send", "frame", `return (${source})(viewer, send, frame)`)(viewer, send, frame);
  while (viewer.pace.timer !== undefined) await new Promise((resolve) => setTimeout(resolve, 20));
  await frame();
  viewer.ondraw.splice(viewer.ondraw.indexOf(listener), 1);
  return frames;
}, act.toString());

browserTest("a pan or a click with 34,000 nodes writes nothing again, and copies no strip for an edge", () => withPage("maze", async (driver) => {
  await driver.choose("Planner", "rrt-star");
  await driver.unfold("How to search");
  await driver.fill("spinbutton", "Most nodes", NODES);
  await driver.fill("spinbutton", "Most seconds", 200);
  if (await driver.page.$eval("::-p-aria([name='stop at the first path'][role='checkbox'])", (box) => box.checked)) await driver.click("checkbox", "stop at the first path");
  await driver.press("Plan");
  const run = await driver.until(() => {
    const cells = [...(document.querySelector("#runs .scroll tbody tr")?.cells ?? [])].map((cell) => cell.textContent);
    return /verified path/.test(cells[5]) && cells[8];
  });
  assert.equal(Number(run.replace(/\D/g, "")), NODES);
  await countWork(driver);

  // With time for all of it each frame has every edge, as a line and not as a strip.
  const pan = await framesOf(driver, async (viewer, send, frame) => {
    const took = viewer.pace.took;
    viewer.pace.took = () => {};
    viewer.pace.possible = 1;
    send("pointerdown", 300, 200);
    for (let i = 1; i <= 5; i++) {
      send("pointermove", 300 + 9 * i, 200 + 4 * i);
      await frame();
    }
    send("pointerup", 345, 220);
    viewer.pace.took = took;
  });
  assert.ok(pan.length >= 5);
  for (const { copies, corners, bytes } of pan) assert.ok(corners >= 2 * NODES && copies < 3000 && bytes < 20_000, JSON.stringify(pan));

  // A click on a node finds it, and writes its mark only.
  const [x, y] = await driver.page.evaluate(async () => {
    const { viewer } = await window.mpView.planner;
    const { nodes } = viewer.layers.find((layer) => layer.shown).shown.trees[0];
    return viewer.camera.project(viewer.camera.matrices().both, [...nodes.subarray(3 * 20_000, 3 * 20_000 + 3)]);
  });
  const click = await framesOf(driver, new Function("viewer", "send", `send("pointerdown", ${x}, ${y}); send("pointerup", ${x}, ${y});`));
  assert.match(await driver.page.$eval("#hint", (hint) => hint.textContent), /Node [\d\s]+ of the tree/);
  for (const { copies, bytes } of click) assert.ok(copies < 3000 && bytes < 20_000, JSON.stringify(click));

  // Where frames take too long, a moving view has fewer lines, and a still one all of them.
  const slow = await framesOf(driver, async (viewer, send, frame) => {
    const took = viewer.pace.took;
    viewer.pace.took = () => {};
    viewer.pace.possible = 0.1;
    send("pointerdown", 300, 200);
    send("pointermove", 320, 210);
    await frame();
    send("pointerup", 320, 210);
    viewer.pace.took = took;
  });
  assert.ok(slow[0].corners >= 0.2 * NODES && slow[0].corners < 0.3 * NODES, JSON.stringify(slow));
  assert.ok(slow.at(-1).corners >= 2 * NODES, JSON.stringify(slow));
}));
