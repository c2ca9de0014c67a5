// A scene is built by menu and by handles, saved, and opened again.

import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { missing, withPage } from "./browser.mjs";

/** The document as the page has it. */
const documentOf = (driver) => driver.page.evaluate(async () => (await window.mpView.planner).document);
const names = (document) => document.obstacles.map((o) => o.name);
/** Waits until the document has so many obstacles. */
const untilObstacles = (driver, count) => driver.until(async (n) => (await window.mpView.planner).document.obstacles.length === n, count);
/** Waits until a part of the document is as given. */
const untilPose = (driver, index, k, value) =>
  driver.until(async (i, at, wanted) => Math.abs((await window.mpView.planner).document.obstacles[i].pose[at] - wanted) < 1e-9, index, k, value);

test("a scene is built, changed, saved and opened again", { skip: missing, timeout: 240_000 }, () => withPage("easy", async (driver, folder) => {
  await driver.press("New");
  await driver.until(async () => (await window.mpView.planner).document?.obstacles.length === 0);

  // Every figure.
  const figures = ["sphere", "cone", "cube", "cylinder", "torus", "tetrahedron"];
  for (const [i, figure] of figures.entries()) {
    await driver.choose("Figure", figure);
    await driver.press("Add");
    await untilObstacles(driver, i + 1);
  }
  assert.deepEqual(names(await documentOf(driver)), figures);
  assert.equal(await driver.alert(), "");

  // Numbers: the last figure is selected.
  await driver.fill("spinbutton", "x, metres", "3.5");
  await untilPose(driver, 5, 0, 3.5);
  await driver.fill("spinbutton", "yaw about z, radians", "0.5");
  await untilPose(driver, 5, 3, 0.5);
  await driver.fill("textbox", "Name", "roof");
  await driver.until(async () => (await window.mpView.planner).document.obstacles[5].name === "roof");

  // A handle: the arrow of x, along which the box moves and nothing else.
  await driver.choose("Selected", "cube");
  const before = (await documentOf(driver)).obstacles[2].pose;
  const length = await driver.page.evaluate(async () => 80 * (await window.mpView.planner).viewer.camera.pixel());
  const [from, to] = [0.8, 1.6].map((part) => [before[0] + part * length, before[1], before[2]]);
  await driver.drag(await driver.pixelOf(from), await driver.pixelOf(to));
  await driver.until(async (x) => (await window.mpView.planner).document.obstacles[2].pose[0] > x, before[0] + 0.4 * length);
  const moved = (await documentOf(driver)).obstacles[2].pose;
  assert.ok(Math.abs(moved[0] - before[0] - 0.8 * length) < 0.2 * length, `${before} ${moved}`);
  assert.deepEqual(moved.slice(1), before.slice(1));

  // Undo and redo, by keys and by buttons.
  await driver.page.focus("[role=application]");
  await driver.keys("Control", "z");
  await untilPose(driver, 2, 0, before[0]);
  await driver.press("Redo");
  await untilPose(driver, 2, 0, moved[0]);

  // Duplicate and delete.
  await driver.press("Duplicate");
  await untilObstacles(driver, 7);
  await driver.press("Delete");
  await untilObstacles(driver, 6);

  // An edit that the session refuses changes nothing.
  await driver.choose("Selected", "torus");
  await driver.fill("spinbutton", "radius of the tube, metres", "5");
  await driver.until(() => !document.querySelector("[role=alert]").hidden);
  assert.match(await driver.alert(), /torus|tube/);
  assert.equal((await documentOf(driver)).obstacles[4].shape.torus.tube, 0.3);
  await driver.until(() => [...document.querySelectorAll("input")].find((e) => e.title === "radius of the tube, metres").value === "0.3");

  // Saved as our own and as GEMPA environment.
  const built = await documentOf(driver);
  for (const [format, label] of [["0", "own"], ["1", "gempa"]]) {
    await driver.press("Save…");
    await driver.choose("What", format);
    await driver.fill("textbox", "Name", `room-${label}`);
    await driver.press("Save");
    await driver.until((name) => [...document.querySelectorAll("dialog [role=status]")].some((e) => e.textContent.includes(name)), `room-${label}`);
    await driver.press("Close");
  }
  assert.equal(await driver.page.evaluate(() => document.body.classList.contains("unsaved")), false);
  const files = readdirSync(folder).map((name) => ({ name, text: readFileSync(join(folder, name), "utf8") }));
  assert.ok(files.some((f) => f.name === "room-own.mp.json") && files.some((f) => f.name === "room-gempa.env"), files.map((f) => f.name).join());

  // Opened again, as files that are dropped on the page: the same scene.
  const drop = (chosen) => driver.page.evaluate((list) => {
    const transfer = new DataTransfer();
    for (const { name, text } of list) transfer.items.add(new File([text], name));
    window.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));
  }, chosen);
  const shown = () => driver.page.evaluate(async () => {
    const { viewer } = await window.mpView.planner;
    return viewer.scene.bodies.slice(viewer.scene.robot).map((body) => body.pose);
  });
  const poses = await shown();
  await driver.press("New");
  await untilObstacles(driver, 0);
  await drop(files.filter((f) => f.name === "room-own.mp.json"));
  await untilObstacles(driver, 6);
  const again = await documentOf(driver);
  assert.deepEqual({ ...again, name: "" }, { ...built, name: "" });
  assert.deepEqual(await shown(), poses);
  await driver.press("New");
  await untilObstacles(driver, 0);
  await drop(files.filter((f) => f.name !== "room-own.mp.json"));
  await untilObstacles(driver, 6);
  (await shown()).forEach((pose, i) => pose.forEach((x, k) => assert.ok(Math.abs(x - poses[i][k]) < 1e-9, `${pose} ${poses[i]}`)));
}));
