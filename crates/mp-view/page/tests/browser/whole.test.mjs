// From an empty page to a page to send: a scene is built by menu, saved, opened, planned in, animated and exported.

import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { Driver, browserTest, mp, newPage, withPage } from "./browser.mjs";

const document_ = (driver) => driver.page.evaluate(async () => (await window.mpView.planner).document);
const untilObstacles = (driver, count) => driver.until(async (n) => (await window.mpView.planner).document?.obstacles.length === n, count);

/** Saves by the dialog and waits until the page says that the file is written. @param {Driver} driver @param {string} what @param {string} name */
async function save(driver, what, name) {
  await driver.press("Save…");
  const value = await (await driver.control("combobox", "What")).evaluate((select, wanted) => [...select.options].find((o) => o.textContent === wanted).value, what);
  await driver.choose("What", value);
  await driver.page.$eval("dialog[open] input[type=text]", (field, text) => (field.value = text), name);
  await driver.press("Save");
  await driver.until(() => /^Written/.test(document.querySelector("dialog[open] [role=status]").textContent));
  await driver.press("Close");
}

/** Chooses files by the menu. @param {Driver} driver @param {...string} files */
async function open(driver, ...files) {
  const [chooser] = await Promise.all([driver.page.waitForFileChooser(), driver.press("Open…")]);
  await chooser.accept(files);
}

/** Goes through the three ways to show a path. @param {Driver} driver */
async function animate(driver) {
  const time = () => driver.page.evaluate(() => document.querySelector("[aria-label=Configuration]").valueAsNumber);
  const last = await driver.page.evaluate(() => Number(document.querySelector("[aria-label=Configuration]").max));
  assert.ok(last > 2, `${last}`);
  // All at once: every configuration is drawn, and not only the robot.
  const items = () => driver.page.evaluate(() => window.mpView.draw() ?? window.mpView.stats().triangles);
  await driver.press("Step by step");
  const one = await items();
  await driver.press("All at once");
  assert.ok((await items()) > one);
  // Step by step, forwards and backwards.
  await driver.press("Step by step");
  await driver.press("First configuration");
  assert.equal(await time(), 0);
  for (const [label, wanted] of [["Next configuration", 1], ["Next configuration", 2], ["Previous configuration", 1], ["Last configuration", last]]) {
    await driver.press(label);
    await driver.until((t) => document.querySelector("[aria-label=Configuration]").valueAsNumber === t, wanted);
  }
  // By itself, from the start: it stood at the end.
  await driver.press("Automatic");
  await driver.until((t) => {
    const now = document.querySelector("[aria-label=Configuration]").valueAsNumber;
    return now > 0 && now < t;
  }, last);
  // The space bar stops it. Two buttons are called “Pause”: this one, and that of the run.
  await driver.key("Space");
  await driver.until(() => [...document.querySelectorAll("#timeline button")].some((button) => button.textContent === "Play"));
}

browserTest("a scene is built by menu, saved, opened, planned in, animated and exported", () => withPage("easy", async (driver, folder) => {
  // A gate: two pillars between start and goal, and a beam over them.
  await driver.press("New");
  await untilObstacles(driver, 0);
  for (const [i, [figure, y, z]] of [["cylinder", -1.5, 0], ["cylinder", 1.5, 0], ["cube", 0, 2.5]].entries()) {
    await driver.choose("Figure", figure);
    await driver.press("Add");
    await untilObstacles(driver, i + 1);
    for (const [field, value] of [["x, metres", 0], ["y, metres", y], ["z, metres", z]]) {
      await driver.fill("spinbutton", field, value);
      await driver.until(async (n, k, v) => (await window.mpView.planner).document.obstacles[n].pose[k] === v, i, "xyz".indexOf(field[0]), value);
    }
  }
  await driver.unfold("Room");
  await driver.fill("textbox", "Name of the environment", "gate");
  await driver.until(() => document.querySelector("h1").textContent === "gate");
  const built = await document_(driver);
  await save(driver, "the environment, to edit again (.mp.json)", "gate");

  // Opened again by the menu.
  await driver.press("New");
  await untilObstacles(driver, 0);
  await open(driver, join(folder, "gate.mp.json"));
  await untilObstacles(driver, 3);
  assert.deepEqual(await document_(driver), built);

  // Planned in: the path is verified, and the program agrees.
  await driver.press("Plan");
  await driver.untilResult(/verified path/);
  await save(driver, "the path, as text", "gate-path");
  assert.match(mp("check", join(folder, "gate.mp.json"), join(folder, "gate-path.txt")), /free|verified/);
  await animate(driver);

  // The page to send, which opens from its file without a server, shows the same.
  await save(driver, "this page, to send (HTML)", "gate");
  assert.deepEqual(readdirSync(folder).sort(), ["gate-path.txt", "gate.html", "gate.mp.json"]);
  const { page, context, faults } = await newPage();
  const sent = new Driver(page);
  await page.setOfflineMode(true);
  await page.goto(String(pathToFileURL(join(folder, "gate.html"))));
  await sent.untilReady();
  assert.equal(await page.$eval("h1", (title) => title.textContent), "gate");
  assert.match(await page.$eval(".paths", (list) => list.textContent), /verified/);
  assert.ok((await sent.drawn()) > 0.02);
  await animate(sent);
  assert.deepEqual(faults, []);
  await context.close();
  assert.ok(readFileSync(join(folder, "gate.html")).length < 1e6);
}));
