// A scene is built by menu and by handles, saved, and opened again.

import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { browserTest, withPage } from "./browser.mjs";

/** The document as the page has it. */
const documentOf = (driver) => driver.page.evaluate(async () => (await window.mpView.planner).document);
const names = (document) => document.obstacles.map((o) => o.name);
/** Waits until the document has so many obstacles. */
const untilObstacles = (driver, count) => driver.until(async (n) => (await window.mpView.planner).document.obstacles.length === n, count);
/** Waits until a part of the document is as given. */
const untilPose = (driver, index, k, value) =>
  driver.until(async (i, at, wanted) => Math.abs((await window.mpView.planner).document.obstacles[i].pose[at] - wanted) < 1e-9, index, k, value);

browserTest("a scene is built, changed, saved and opened again", () => withPage("easy", async (driver, folder) => {
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
  const drop = (chosen) => driver.drop(...chosen.map(({ name, text }) => ({ name, content: text })));
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

/** A pixel on a handle: `at` in the body's directions, as a part of the handles' length. */
const onHandle = async (driver, origin, at) => {
  const length = await driver.page.evaluate(async (point) => {
    const { viewer } = await window.mpView.planner;
    const { camera } = viewer;
    const eye = camera.eye();
    const back = camera.axes().back;
    const depth = back.reduce((sum, b, k) => sum + b * (eye[k] - point[k]), 0);
    return camera.perspective ? (92 * camera.pixel() * depth) / camera.distance : 92 * camera.pixel();
  }, origin);
  return driver.pixelOf(origin.map((x, k) => x + at[k] * length));
};
/** Counts the requests of the page by their names. */
const counted = (driver) => driver.page.evaluate(async () => {
  const { session } = await window.mpView.planner;
  const counts = (window.counts ??= {});
  if (!window.counting) {
    window.counting = true;
    const request = session.request.bind(session);
    session.request = (message) => {
      counts[message.do] = (counts[message.do] ?? 0) + 1;
      return request(message);
    };
  }
  return { ...counts };
});

browserTest("handles turn, scale and give up; start and goal are dragged with their clearance", () => withPage("easy", async (driver) => {
  await driver.press("New");
  await driver.until(async () => (await window.mpView.planner).document?.obstacles.length === 0);
  await driver.press("Add");
  await untilObstacles(driver, 1);
  const at = (await documentOf(driver)).obstacles[0].pose.slice(0, 3);
  await counted(driver);

  // A ring: a quarter turn about z, in steps by Shift. One message, at the end.
  await driver.press("Turn");
  await driver.page.keyboard.down("Shift");
  await driver.drag(await onHandle(driver, at, [Math.SQRT1_2, -Math.SQRT1_2, 0]), await onHandle(driver, at, [Math.SQRT1_2, Math.SQRT1_2, 0]));
  await driver.page.keyboard.up("Shift");
  await untilPose(driver, 0, 3, Math.PI / 2);
  assert.deepEqual(await counted(driver), { edit: 1 });

  // A cube: the body is turned, so its own x axis is y of the world.
  await driver.press("Scale");
  await driver.page.keyboard.down("Shift");
  await driver.drag(await onHandle(driver, at, [0, 1, 0]), await onHandle(driver, at, [0, 1.5, 0]));
  await driver.page.keyboard.up("Shift");
  await driver.until(async () => (await window.mpView.planner).document.obstacles[0].scale?.[0] === 1.5);
  assert.deepEqual((await documentOf(driver)).obstacles[0].scale, [1.5, 1, 1]);

  // Escape gives a drag up.
  await driver.press("Move");
  const [from, to] = [await onHandle(driver, at, [0.8, 0, 0]), await onHandle(driver, at, [2, 0, 0])];
  await driver.page.mouse.move(...from);
  await driver.page.mouse.down();
  await driver.page.mouse.move(...to, { steps: 4 });
  await driver.until(async (x) => (await window.mpView.planner).viewer.scene.bodies[1].pose[0] > x, at[0] + 0.2);
  await driver.page.keyboard.press("Escape");
  await driver.page.mouse.up();
  await driver.until(async (x) => Math.abs((await window.mpView.planner).viewer.scene.bodies[1].pose[0] - x) < 1e-9, at[0]);
  assert.deepEqual(await counted(driver), { edit: 2 });

  // The goal into the box: checked while it is dragged, and no message but checks. Undo brings it back.
  // From above, where a drag keeps the height.
  await driver.choose("Selected", "robot at the goal");
  const { goal } = await documentOf(driver);
  await driver.press("Top");
  await driver.drag(await onHandle(driver, goal.slice(0, 3), [0, 0, 0]), await driver.pixelOf(at));
  await driver.until(async () => (await window.mpView.planner).ends.verdicts.get(0)?.touching.length > 0);
  const counts = await counted(driver);
  assert.ok(counts.check >= 1 && counts.edit === 2, JSON.stringify(counts));
  await driver.press("Undo");
  await driver.until(async (x) => (await window.mpView.planner).viewer.scene.goals[0].row[0] === x, goal[0]);
}));

browserTest("in the plane bodies keep z; start and goal of a world are dragged, and its robot is not edited", () => withPage("rrs-low", async (driver) => {
  assert.equal((await driver.options("Selected")).length, 3 + (await documentOf(driver)).obstacles.length);
  await driver.choose("Selected", "robot at the start");
  const row = () => driver.page.evaluate(async () => (await window.mpView.planner).viewer.scene.start.row);
  const before = await row();
  await driver.drag(await onHandle(driver, [...before, 0], [0.8, 0, 0]), await onHandle(driver, [...before, 0], [1.2, 0, 0]));
  await driver.until(async (x) => (await window.mpView.planner).viewer.scene.start.row[0] > x, before[0]);
  assert.equal((await row())[1], before[1]);
  const visible = (label) => driver.page.$eval(`[aria-label='${label}']`, (element) => element.checkVisibility());
  assert.deepEqual([await visible("Add a body"), await visible("As obstacle or as robot")], [true, false]);

  await driver.press("New");
  await driver.until(async () => (await window.mpView.planner).document?.obstacles.length === 0);
  await driver.press("Add");
  await untilObstacles(driver, 1);
  await driver.unfold("Room");
  await driver.choose("The robot moves", "SE2");
  await driver.until(async () => (await window.mpView.planner).viewer.scene.planar);
  await driver.choose("Selected", "cube");
  const at = (await documentOf(driver)).obstacles[0].pose;
  await driver.drag(await onHandle(driver, at.slice(0, 3), [0, 0.8, 0]), await onHandle(driver, at.slice(0, 3), [0, 1.4, 0]));
  await driver.until(async (y) => (await window.mpView.planner).document.obstacles[0].pose[1] > y + 0.1, at[1]);
  const moved = (await documentOf(driver)).obstacles[0].pose;
  assert.deepEqual([moved[0], ...moved.slice(2)], [at[0], ...at.slice(2)]);
}));

browserTest("an arm is dragged by its gripper, and each part of its motion is planned from where the last one ended", () => withPage("carry", async (driver) => {
  const state = () => driver.page.evaluate(async () => {
    const { viewer, links, partsLeft } = (await window.mpView.planner);
    const { start, robot } = viewer.scene;
    return { row: start.row, place: start.poses.slice(7 * (robot - 1), 7 * robot - 4), turn: start.poses.slice(7 * robot - 4), links, partsLeft };
  });
  const { row, place, turn, partsLeft } = await state();
  await driver.choose("Selected", "robot at the start");
  await driver.drag(await onHandle(driver, place, [0.8, 0, 0]), await onHandle(driver, place, [1.4, 0, 0]));
  await driver.until(async (old) => (await window.mpView.planner).ends.verdicts.has("start") && String((await window.mpView.planner).viewer.scene.start.row) !== old, String(row));
  const drawn = await state();
  const shift = drawn.place.map((x, k) => x - place[k]);
  assert.ok(shift[0] > 1e-3 && Math.hypot(shift[1], shift[2]) < 1e-6, `${shift}`);
  assert.ok(drawn.turn.every((x, k) => Math.abs(x - turn[k]) < 1e-6), `${drawn.turn} ${turn}`);

  await driver.press("Plan");
  await driver.untilResult(/verified path/);
  const end = await driver.page.evaluate(async () => (await window.mpView.planner).viewer.scene.paths.at(-1).written.at(-1));
  await driver.press("Next part");
  await driver.until(async (left) => (await window.mpView.planner).partsLeft === left, partsLeft - 1);
  assert.deepEqual((await state()).row, end);
  await driver.press("Plan");
  await driver.untilResult(/verified path/);
}));

browserTest("unsaved changes are asked about; meshes and files of other kinds", () => withPage("easy", async (driver) => {
  const drop = (name, text) => driver.drop({ name, content: text });
  const count = (await documentOf(driver)).obstacles.length;
  const tetrahedron = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  await drop("spike.off", tetrahedron);
  await driver.press("An obstacle");
  await untilObstacles(driver, count + 1);
  const spike = (await documentOf(driver)).obstacles[count];
  assert.deepEqual([spike.name, spike.shape], ["spike", { mesh: { file: "spike.off" } }]);
  await drop("spike.off", tetrahedron);
  await driver.press("The robot");
  await driver.until(async () => (await window.mpView.planner).document.robot.name === "spike 2");

  // Asked, and kept.
  await driver.press("New");
  await driver.press("Keep them");
  await driver.page.waitForFunction(() => !document.querySelector("dialog[open]"));
  assert.equal((await documentOf(driver)).obstacles.length, count + 1);

  for (const [name, text, words] of [["broken.off", "OFF\n4 4", /broken\.off/], ["notes.md", "hello", /notes\.md/], ["a.mpv", "x", /scene file|MPV/], ["p.txt", "2\n0 0 0 0 0\n", /p\.txt/]]) {
    await drop(name, text);
    await driver.untilAlert(words);
    assert.equal((await documentOf(driver)).obstacles.length, count + 1, name);
  }
}));

browserTest("numbers of an end that the planner writes otherwise are no step of their own", () => withPage("easy", async (driver) => {
  const count = (await documentOf(driver)).obstacles.length;
  const labels = () => driver.page.evaluate(() => [/undo/i, /redo/i].map((word) => [...document.querySelectorAll("button")].find((b) => word.test(b.title)).title));
  const start = async () => (await documentOf(driver)).start;
  /** Waits until the planner has said something of the start as it is. */
  const untilChecked = () => driver.until(async () => {
    const { ends } = await window.mpView.planner;
    return ends.verdicts.has("start") && ends.unchecked.size === 0 && !ends.asking;
  });
  const first = await start();
  await driver.unfold("Start and goal");
  // A pitch beyond a quarter turn, and a roll beyond half a turn: the planner gives other angles for the same pose.
  await driver.fill("spinbutton", "beta rad", "-2");
  await driver.fill("spinbutton", "gamma rad", "4");
  const given = [...first.slice(0, 4), -2, 4];
  await untilChecked();
  await driver.press("Add");
  await untilObstacles(driver, count + 1);
  await untilChecked();
  const after = await labels();
  assert.deepEqual(await start(), given);
  assert.match(after[0], /add/i);
  await driver.press("Undo");
  await untilObstacles(driver, count);
  await untilChecked();
  assert.match((await labels())[1], /add/i);
  await driver.press("Undo");
  await driver.press("Redo");
  await driver.press("Redo");
  await untilObstacles(driver, count + 1);
  await untilChecked();
  assert.deepEqual(await labels(), after);
  assert.deepEqual(await start(), given);
}));

browserTest("what is done while another scene opens changes neither of them", () => withPage("easy", async (driver) => {
  const { name, obstacles } = await documentOf(driver);
  await driver.choose("Selected", obstacles[0].name);
  await driver.press("Gallery…");
  await driver.control("button", "gempa-1");
  // At once: before the program has answered.
  await driver.page.evaluate(() => {
    document.querySelector("dialog.gallery button[value=gempa-1]").click();
    for (const key of ["d", "d"]) window.dispatchEvent(new KeyboardEvent("keydown", { key, ctrlKey: true, bubbles: true, cancelable: true }));
  });
  await driver.until(async (before) => (await window.mpView.planner).document?.name !== before, name);
  await driver.until(() => document.querySelector("[aria-busy=true]") === null);
  const opened = await documentOf(driver);
  assert.equal(opened.name, "gempa-1");
  const drawn = await driver.page.evaluate(async () => {
    const { scene } = (await window.mpView.planner).viewer;
    return scene.bodies.slice(scene.robot).map((body) => body.name);
  });
  assert.deepEqual(drawn, names(opened));
  const undo = await driver.page.evaluate(() => [...document.querySelectorAll("button")].find((b) => /undo/i.test(b.title)).disabled);
  assert.equal(undo, true);
}));
