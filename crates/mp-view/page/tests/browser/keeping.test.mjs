// What a person has made is not lost: runs stay when the scene is edited, changes outlive a reload and the server, and what is shown is saved.

import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { browserTest, mp, withPage } from "./browser.mjs";

const untilObstacles = (driver, count) => driver.until(async (n) => (await window.mpView.planner).document?.obstacles.length === n, count);
const begin = async (driver) => {
  await driver.press("New");
  await untilObstacles(driver, 0);
};
/** A mesh. */
const SPIKE = { name: "spike.off", content: "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n" };
/** Lets downloads go into a folder. */
async function downloadsTo(driver, folder) {
  const client = await driver.page.createCDPSession();
  await client.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: folder, browserContextId: driver.page.browserContext().id });
}
/** Saves by the dialog, and returns what it says. */
async function save(driver, what, words) {
  await driver.press("Save…");
  const value = await (await driver.control("combobox", "What")).evaluate((select, wanted) => [...select.options].find((o) => o.textContent.startsWith(wanted)).value, what);
  await driver.choose("What", value);
  await driver.press("Save");
  const said = await driver.until((source) => {
    const text = document.querySelector("dialog[open] [role=status]").textContent;
    return new RegExp(source).test(text) && text;
  }, words.source);
  await driver.press("Close");
  return said;
}
const untilFile = async (folder, name) => {
  for (let i = 0; i < 200 && !readdirSync(folder).includes(name); i++) await new Promise((resolve) => setTimeout(resolve, 50));
  return readFileSync(join(folder, name));
};

browserTest("runs stay when the scene is edited, and an undo makes them its own again", () => withPage("easy", async (driver) => {
  const count = await driver.page.evaluate(async () => (await window.mpView.planner).document.obstacles.length);
  await driver.press("Plan");
  await driver.untilResult(/verified path$/);
  const shown = () => driver.page.evaluate(async () => {
    const { viewer } = await window.mpView.planner;
    return viewer.scene.paths[viewer.settings.path]?.name ?? "";
  });
  const path = await shown();
  assert.match(path, /run 1/);
  // In a corner, where the path does not lead.
  await driver.lookAtCorner();
  await driver.press("Add");
  await untilObstacles(driver, count + 1);
  await driver.untilResult(/of the scene before/, 1);
  assert.equal(await shown(), path);
  await driver.press("Plan");
  await driver.untilResult(/verified path$/, 2);
  const results = async () => (await driver.runs()).map((cells) => cells[5]);
  assert.deepEqual(await results(), ["verified path", "verified path, of the scene before"]);
  await driver.press("Undo");
  await untilObstacles(driver, count);
  await driver.untilResult(/of the scene before/, 2);
  assert.deepEqual(await results(), ["verified path, of the scene before", "verified path"]);
  // Another scene has runs of its own.
  await driver.press("New");
  await driver.until(() => !document.querySelector("#runs .scroll tbody tr"));
}));

browserTest("changes outlive a reload", () => withPage("easy", async (driver) => {
  await begin(driver);
  await driver.press("Add");
  await untilObstacles(driver, 1);
  await driver.drop(SPIKE);
  await driver.press("An obstacle");
  await untilObstacles(driver, 2);
  const made = await driver.page.evaluate(async () => (await window.mpView.planner).document);
  await driver.until(() => Object.keys(localStorage).some((key) => localStorage.getItem(key).includes("spike")));
  driver.page.on("dialog", (dialog) => dialog.accept());
  await driver.page.reload();
  await driver.untilReady();
  await driver.untilAlert(/changes that were not saved/);
  await driver.press("Open the copy");
  // The scene of the reload has as many obstacles.
  await driver.until(async (name) => (await window.mpView.planner).document?.obstacles[0]?.name === name, made.obstacles[0].name);
  const again = await driver.page.evaluate(async () => (await window.mpView.planner).document);
  assert.deepEqual(again.obstacles, made.obstacles);
  assert.ok(await driver.page.evaluate(() => document.body.classList.contains("unsaved")), "it is not saved yet");
  // Once saved, there is no copy any more.
  await save(driver, "the environment, to edit again", /^Written/);
  await driver.until(() => !Object.keys(localStorage).length);
}));

browserTest("without the server the environment is saved as a download", () => withPage("easy", async (driver, folder, server) => {
  await begin(driver);
  await driver.press("Add");
  await untilObstacles(driver, 1);
  await downloadsTo(driver, folder);
  await server.end();
  await driver.untilAlert(/server does not answer/);
  await save(driver, "the environment, to edit again", /does not answer.*Saved/);
  const { obstacles } = JSON.parse(await untilFile(folder, "environment.mp.json"));
  assert.equal(obstacles.length, 1);
  assert.match(mp("info", join(folder, "environment.mp.json")), /environment/);
}, { expected: /Failed to (load|fetch)|ERR_CONNECTION|ERR_INCOMPLETE/ }));

browserTest("without the server a problem is saved as a download, with its meshes and its ends", () => {
  const robot = fileURLToPath(new URL("../../../../mp-scenes/assets/robots/arm-6.urdf", import.meta.url));
  return withPage(robot, async (driver, folder, server) => {
    await downloadsTo(driver, folder);
    // What the page has the text of.
    await driver.page.evaluate(async () => {
      const { session } = await window.mpView.planner;
      const request = session.request.bind(session);
      session.request = async (asked) => {
        const reply = await request(asked);
        if (asked.content) window.keptForTests = asked.document;
        return reply;
      };
    });
    await driver.drop(SPIKE);
    await untilObstacles(driver, 1);
    await driver.until(() => window.keptForTests?.obstacles.length === 1);
    await driver.fill("spinbutton", "z, metres", "7");
    await driver.until(() => window.keptForTests.obstacles[0].pose[2] === 7);
    const start = await driver.page.evaluate(async () => {
      const { ends } = await window.mpView.planner;
      const row = [...ends.at("start").row];
      row[0] += 0.0625;
      ends.set("start", row);
      return row;
    });
    await driver.until((x) => window.keptForTests.start[0] === x, start[0]);
    await server.end();
    await driver.untilAlert(/server does not answer/);
    await save(driver, "the problem with its obstacles", /does not answer.*Saved/);
    const text = String(await untilFile(folder, "arm-6.toml"));
    assert.ok(text.includes(robot) && text.includes(`start = [${start[0]},`) && /at = \[.*, 7\]/.test(text), text);
    await untilFile(folder, "arm-6_spike_off.off");
    assert.match(mp("info", join(folder, "arm-6.toml")), /obstacle/);
    assert.ok(await driver.page.evaluate(() => !document.body.classList.contains("unsaved")));
    // The planner does not say any more what a later change gives.
    await driver.page.evaluate(async (row) => (await window.mpView.planner).ends.set("start", row), start.map((x) => x / 2));
    await save(driver, "the problem with its obstacles", /before the page had the text/);
  }, { expected: /Failed to (load|fetch)|ERR_CONNECTION|ERR_INCOMPLETE/ });
});

browserTest("what is shown is saved as a picture, a film and a scene for Blender", () => withPage("easy", async (driver, folder) => {
  await downloadsTo(driver, folder);
  await driver.press("Plan");
  await driver.untilResult(/verified path/);
  await save(driver, "a picture", /^Saved/);
  const png = await untilFile(folder, "easy.png");
  assert.equal(png.subarray(1, 4).toString(), "PNG");
  assert.ok(png.length > 5000, `${png.length} bytes`);
  await save(driver, "the scene with its paths, for Blender", /^Written/);
  assert.equal((await untilFile(folder, "easy.glb")).subarray(0, 4).toString(), "glTF");
  const film = await save(driver, "a film", /^Saved/);
  const [, name] = film.match(/(easy\.(mp4|webm))/);
  assert.ok((await untilFile(folder, name)).length > 5000);
}));

browserTest("a new body is at the middle of the view, where the robot may be", () => withPage("easy", async (driver) => {
  await begin(driver);
  await driver.unfold("Room");
  await driver.click("checkbox", "own bounds of the robot's origin");
  await driver.until(async () => (await window.mpView.planner).document.bounds);
  const added = (target) => driver.page.evaluate(async (at) => {
    const { viewer } = await window.mpView.planner;
    viewer.camera.target = at;
    viewer.changed();
  }, target).then(() => driver.press("Add"));
  await added([1, 2, 0]);
  await untilObstacles(driver, 1);
  await added([1000, 2, 0]);
  await untilObstacles(driver, 2);
  const { obstacles, bounds } = await driver.page.evaluate(async () => (await window.mpView.planner).document);
  const near = obstacles[0].pose;
  assert.ok(Math.hypot(near[0] - 1, near[1] - 2) < 2, `${near}`);
  for (const { pose } of obstacles) pose.slice(0, 3).forEach((x, k) => assert.ok(bounds[0][k] <= x && x <= bounds[1][k], `${pose}`));
}));

browserTest("what is typed of a configuration stays while answers come", () => withPage("rrs-low", async (driver) => {
  await driver.unfold("Start and goal");
  await driver.choose("Configuration", "0");
  const field = await driver.control("spinbutton", "x m");
  await field.evaluate((element) => element.select());
  await field.type("12");
  // Another number changes, and is answered.
  await driver.page.evaluate(() => {
    const slider = document.querySelector("input[aria-label='y as a slider']");
    slider.value = slider.min;
    slider.dispatchEvent(new Event("input"));
  });
  assert.equal(await driver.value("spinbutton", "x m"), "12");
  await driver.until(() => document.querySelector(".verdict").textContent && !document.querySelector(".verdict.old"));
  assert.equal(await driver.value("spinbutton", "x m"), "12");
  await field.type("00");
  await driver.page.keyboard.press("Tab");
  await driver.until(() => /outside the limits/.test(document.querySelector(".verdict").textContent));
  assert.equal(await driver.value("spinbutton", "x m"), "1200");
}));

browserTest("a goal out of bounds is taken to the nearest place in bounds", () => withPage("rrs-low", async (driver) => {
  await driver.unfold("Start and goal");
  await driver.choose("Configuration", "0");
  await driver.fill("spinbutton", "x m", 1000);
  await driver.until(() => /outside the limits/.test(document.querySelector(".verdict").textContent));
  await driver.press("Take the nearest place in bounds");
  await driver.until(() => /^Free/.test(document.querySelector(".verdict").textContent));
}));

browserTest("help is read from its top; a phone has the panel as a sheet and the timeline in one row", () => withPage("easy", async (driver) => {
  await driver.page.setViewport({ width: 390, height: 500 });
  await driver.press("Help");
  assert.deepEqual(await driver.page.$eval("#help", (dialog) => [dialog.scrollTop, dialog.scrollHeight > dialog.clientHeight]), [0, true]);
  await driver.page.keyboard.press("Escape");
  await driver.press("Plan");
  await driver.untilResult(/verified path/);
  const [panel, timeline, main] = await driver.page.evaluate(() => ["#panel", "#timeline", "main"].map((name) => document.querySelector(name).getBoundingClientRect().toJSON()));
  assert.ok(timeline.height < 60, `${timeline.height}`);
  assert.deepEqual([panel.width, panel.bottom], [390, main.bottom]);
  assert.ok(panel.height < main.height);
}));

browserTest("an empty scene has a grid and axes; obstacles that move are neither start nor goal", () => withPage("crossing", async (driver) => {
  const drawn = () => driver.page.evaluate(async () => {
    window.mpView.draw();
    const { viewer } = await window.mpView.planner;
    const lines = viewer.layers[0].lines(viewer.settings, { wire: [0, 0, 0] }).map(({ count }) => count);
    const items = viewer.picture.items.map(({ body, role, color }) => ({ part: viewer.scene.bodies[body].role, role, color: String(color) }));
    return { lines, items };
  });
  const { items, lines } = await drawn();
  assert.deepEqual(lines, []);
  const lorries = items.filter(({ part }) => part === "moving");
  const robot = items.filter(({ part }) => part === "robot");
  assert.ok(lorries.length && robot.length);
  assert.ok(lorries.every(({ role, color }) => role === "start" && robot.every((other) => other.color !== color)), JSON.stringify(items));
  await begin(driver);
  const empty = await drawn();
  assert.ok(empty.lines[0] > 10 && empty.lines[1] === 3, `${empty.lines}`);
  await driver.press("Add");
  await untilObstacles(driver, 1);
  assert.deepEqual((await drawn()).lines, []);
}));
