// Broken and hostile input: each gives a message, what was there stays, and the page goes on.

import assert from "node:assert/strict";
import { existsSync, mkdirSync, readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { Driver, browserTest, mp, newPage, withPage } from "./browser.mjs";

/** What is open: its title, its bodies, its paths. */
const state = (driver) => driver.page.evaluate(async () => {
  const { viewer, open, document } = await window.mpView.planner;
  return { name: viewer.scene.name, bodies: viewer.scene.bodies.length, paths: viewer.scene.paths.length, open, document };
});
/** The page still plans. */
async function plans(driver, run) {
  await driver.press("Plan");
  await driver.untilResult(/verified path/, run);
}

browserTest("broken files: a message, and the scene stays", () => withPage("easy", async (driver, folder) => {
  const [scene, other] = [join(folder, "easy.mpv"), join(folder, "other.txt")];
  mp("render", "easy", "--out", scene);
  mp("plan", "rrs-maze", "--out", other, "--picture", join(folder, "other.png"));
  const bytes = readFileSync(scene);
  const before = await state(driver);
  const missing = "Robot\nmissing-robot.off\n0 0 0 0 0 0\n1 0 0 0 0 0\n\nEnd\n";
  for (const [files, words] of [
    [[{ name: "empty.env", content: "" }], /empty\.env/],
    [[{ name: "empty.mp.json", content: "" }], /empty\.mp\.json/],
    [[{ name: "empty.off", content: "" }], /empty\.off/],
    [[{ name: "empty.mpv", content: "" }], /scene file|MPV|short|cut/],
    [[{ name: "cut.mpv", content: bytes.subarray(0, bytes.length / 2) }], /cut|short|beyond|end/],
    [[{ name: "head.mpv", content: bytes.subarray(0, 20) }], /cut|short|beyond|end/],
    [[{ name: "other.txt", content: readFileSync(other) }], /other\.txt/],
    [[{ name: "room.env", content: missing }], /missing-robot\.off/],
  ]) {
    await driver.drop(...files);
    await driver.untilAlert(words);
    assert.deepEqual(await state(driver), before, files[0].name);
    // So that the next message is a new one.
    await driver.press("Close this message");
  }
  await plans(driver, 1);
}));

browserTest("a file that cannot be written: a message, and another name is taken", () => withPage("easy", async (driver, folder) => {
  // A folder with the file's name: the administrator, too, cannot write a file there.
  mkdirSync(join(folder, "easy.mp.json"));
  const status = () => driver.page.$eval("dialog[open] [role=status]", (note) => note.textContent);
  await driver.press("Save…");
  await driver.press("Save");
  await driver.until(() => /easy\.mp\.json/.test(document.querySelector("dialog[open] [role=status] .bad")?.textContent ?? ""));
  await driver.click("checkbox", "replace a file with this name");
  await driver.press("Save");
  await driver.until(() => /easy\.mp\.json/.test(document.querySelector("dialog[open] [role=status] .bad")?.textContent ?? ""));
  assert.deepEqual(readdirSync(folder), ["easy.mp.json"], await status());
  await driver.page.$eval("dialog[open] input[type=text]", (field) => (field.value = "room"));
  await driver.press("Save");
  await driver.until(() => /^Written.*room\.mp\.json/.test(document.querySelector("dialog[open] [role=status]").textContent));
  assert.ok(existsSync(join(folder, "room.mp.json")));
  await driver.press("Close");
}));

browserTest("the server goes away: what is shown stays, and every request says so", () => withPage("easy", async (driver, _folder, server) => {
  await plans(driver, 1);
  await driver.press("Add");
  await driver.until(async () => (await window.mpView.planner).document.obstacles.length === 3);
  const before = await state(driver);
  await server.end();
  await driver.untilAlert(/server does not answer/);
  await driver.press("Reconnect");
  await driver.untilAlert(/server does not answer/);
  await driver.press("Plan");
  await driver.untilResult(/server does not answer/);
  await driver.press("Save…");
  const html = await (await driver.control("combobox", "What")).evaluate((select) => [...select.options].find((o) => /HTML/.test(o.textContent)).value);
  await driver.choose("What", html);
  await driver.press("Save");
  await driver.until(() => /server does not answer/.test(document.querySelector("dialog[open] [role=status]").textContent));
  await driver.press("Close");
  // The scene with its unsaved change is there, and is drawn.
  assert.deepEqual(await state(driver), before);
  assert.ok(await driver.page.evaluate(() => document.body.classList.contains("unsaved")));
  assert.ok((await driver.drawn()) > 0.02);
}, { expected: /ERR_|Failed to load resource/ }));

browserTest("two tabs at once are two sessions", () => withPage("easy", async (driver, _folder, server) => {
  const { page, context, faults } = await newPage();
  await page.goto(server.address);
  const second = new Driver(page);
  await second.untilReady();
  const before = await state(second);
  await driver.lookAtCorner();
  await driver.press("Add");
  await driver.until(async () => (await window.mpView.planner).document.obstacles.length === 3);
  await Promise.all([plans(driver, 1), plans(second, 1)]);
  const after = await state(second);
  assert.deepEqual([after.bodies, after.document], [before.bodies, before.document]);
  assert.equal((await state(driver)).document.obstacles.length, 3);
  await context.close();
  assert.deepEqual(faults, []);
  await plans(driver, 2);
}));

browserTest("names in files are shown as text, here and in the exported page", () => withPage("easy", async (driver, folder) => {
  const [title, body, robot] = ["</script><script>window.hostile = 1</script>", "<img src=x onerror='window.hostile = 2'>", "<!--<script>\u2028window.hostile = 3"];
  const scene = {
    version: 1, name: title, space: "SE3", bounds: null,
    robot: { name: robot, color: null, shape: { cube: { size: [1, 1, 1] } } },
    start: [-4, 0, 0, 0, 0, 0], goal: [4, 0, 0, 0, 0, 0],
    obstacles: [{ name: body, color: null, shape: { sphere: { radius: 1 } }, pose: [0, 0, 0, 0, 0, 0] }],
  };
  await driver.drop({ name: "hostile.mp.json", content: JSON.stringify(scene) });
  await driver.until((wanted) => document.querySelector("h1").textContent === wanted, title);
  const shownIn = async (page) => {
    const names = await page.$$eval(".bodies button.name", (buttons) => buttons.map((button) => button.textContent));
    assert.ok(names.includes(body) && names.includes(robot), names.join());
    assert.equal(await page.title(), title);
    assert.equal(await page.evaluate(() => document.querySelectorAll("img, script[src]").length + Number(window.hostile ?? 0)), 0);
  };
  await shownIn(driver.page);
  await plans(driver, 1);
  await driver.press("Save…");
  const value = await (await driver.control("combobox", "What")).evaluate((select) => [...select.options].find((o) => /HTML/.test(o.textContent)).value);
  await driver.choose("What", value);
  await driver.press("Save");
  await driver.until(() => /^Written/.test(document.querySelector("dialog[open] [role=status]").textContent));
  const [file] = readdirSync(folder);
  const { page, context, faults } = await newPage();
  await page.goto(String(pathToFileURL(join(folder, file))));
  await new Driver(page).untilReady();
  await shownIn(page);
  assert.deepEqual(faults, []);
  await context.close();
}));
