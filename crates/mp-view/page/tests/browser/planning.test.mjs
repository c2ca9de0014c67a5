// Planning in the page of `mp view`: runs, their table, start and goal, saving, and a server that goes away.

import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { missing, withPage } from "./browser.mjs";

/** The texts of the table of runs, the last run first. */
const runs = (driver) => driver.page.$$eval("#runs .scroll tbody tr", (rows) => rows.map((row) => [...row.cells].map((cell) => cell.textContent)));
/** Waits until the last run has a result as given, and returns its cells. */
const untilResult = (driver, pattern) => driver.until((source) => {
  const cells = [...document.querySelector("#runs .scroll tbody tr").cells].map((cell) => cell.textContent);
  return new RegExp(source).test(cells[5]) && cells;
}, pattern.source);
const key = async (driver, name) => {
  await driver.page.focus("[role=application]");
  await driver.page.keyboard.press(name);
};
/** What is drawn of the run's search: segments of its trees, and motions that were not free. */
const search = (driver) => driver.page.evaluate(async () => {
  const { layers } = (await window.mpView.planner).viewer;
  const { shown } = layers.find((layer) => "rejected" in layer);
  return { nodes: shown.trees.reduce((sum, tree) => sum + tree.count, 0), trees: shown.trees.length, rejected: shown.rejected.count };
});
const options = { skip: missing, timeout: 240_000 };

test("a run finds a verified path, and its tree is drawn", options, () => withPage("easy", async (driver) => {
  await driver.press("Plan");
  const cells = await untilResult(driver, /verified path/);
  assert.equal(cells[3], "rrt-connect");
  const { nodes, trees, rejected } = await search(driver);
  assert.equal(String(nodes), cells[8].replace(/\D/g, ""), "every node of the planner is drawn");
  assert.equal(trees, 2);
  assert.ok(rejected > 0);
  const rejectedDrawn = async () => {
    const { viewer } = await window.mpView.planner;
    window.mpView.draw();
    const { shown: it } = viewer.layers.find((layer) => "rejected" in layer);
    return viewer.picture.lines.some(({ set, count }) => set === it.rejected.set && count > 0);
  };
  assert.equal(await driver.page.evaluate(rejectedDrawn), false);
  await key(driver, "v");
  await driver.until(rejectedDrawn);

  // The path is on the timeline, and the robot stands at its middle.
  await driver.page.evaluate(() => window.mpView.setTime(0.5));
  assert.match(await driver.page.$eval("#timeline output", (output) => output.textContent), /^\d+ of \d+$/);

  // The same seed gives the same path; another planner is compared with it.
  await key(driver, "r");
  assert.deepEqual((await untilResult(driver, /verified path/)).slice(7), cells.slice(7));
  await driver.choose("Planner", "rrt");
  await driver.press("Plan");
  await driver.until(() => document.querySelectorAll("#runs .scroll tbody tr").length === 3);
  await untilResult(driver, /verified path/);
  await (await driver.control("checkbox", "Compare with run 1")).click();
  const compared = await driver.page.$$eval("#runs .facts thead th", (heads) => heads.map((head) => head.textContent));
  assert.deepEqual(compared, ["Run 3", "Run 1"]);
  const roles = await driver.page.evaluate(async () => {
    window.mpView.draw();
    return (await window.mpView.planner).viewer.picture.items.map((item) => item.role);
  });
  assert.ok(roles.includes("robot") && roles.includes("compared"));
}));

test("a run is paused, stepped, resumed and cancelled", options, () => withPage("rrs-low", async (driver) => {
  // It improves its path until its budget is used up.
  await driver.choose("Planner", "rrt-star");
  await driver.fill("spinbutton", "Iterations of a step", 50);
  await key(driver, "n");
  await untilResult(driver, /paused/);
  await driver.until(() => document.querySelector("#runs .scroll tbody tr").cells[7].textContent === "50");
  await key(driver, "n");
  await driver.until(() => document.querySelector("#runs .scroll tbody tr").cells[7].textContent === "100");
  await driver.press("Resume");
  await untilResult(driver, /planning/);
  await driver.press("Pause");
  await untilResult(driver, /paused/);
  const [row] = await runs(driver);
  await new Promise((resolve) => setTimeout(resolve, 300));
  assert.deepEqual((await runs(driver))[0], row, "a paused run does nothing");
  await key(driver, "t");
  await untilResult(driver, /planning/);
  const nodes = (await search(driver)).nodes;
  // The answer to a cancel is on the screen within 100 ms, as the page itself measures it, and some for a busy machine.
  const waited = await driver.page.evaluate(() => new Promise((resolve) => {
    const begin = performance.now();
    const cell = document.querySelector("#runs .scroll tbody tr").cells[5];
    new MutationObserver(() => /planning/.test(cell.textContent) || resolve(performance.now() - begin)).observe(cell, { childList: true, characterData: true, subtree: true });
    window.dispatchEvent(new KeyboardEvent("keydown", { key: "k" }));
  }));
  assert.ok(waited < 1000, `${waited} ms`);
  await untilResult(driver, /verified path|interrupted|cancelled/);
  assert.ok((await search(driver)).nodes >= nodes, "what was searched stays");
}));

test("a start in an obstacle is explained, and the nearest free one is taken", options, () => withPage("easy", async (driver) => {
  await driver.page.evaluate(() => [...document.querySelectorAll("summary")].find((s) => s.textContent === "Start and goal").click());
  await driver.until(() => /^Free/.test(document.querySelector(".verdict").textContent));
  await driver.fill("spinbutton", "x m", 1.2);
  await driver.until(() => /^Refused.*Touches/.test(document.querySelector(".verdict").textContent));
  await driver.press("Plan");
  await driver.until(() => /collision/.test(document.querySelector("[role=alert]").textContent));
  await driver.press("Take the nearest free configuration");
  await driver.until(() => /^Free/.test(document.querySelector(".verdict").textContent));
  await driver.press("Plan");
  const begin = Number(await driver.value("spinbutton", "x m"));
  await untilResult(driver, /verified path/);
  const rows = await driver.page.evaluate(async () => {
    const { viewer } = await window.mpView.planner;
    return viewer.scene.paths[viewer.settings.path].written;
  });
  assert.ok(Math.abs(rows[0][0] - begin) < 1e-6, `${rows[0]} ${begin}`);
}));

test("path, page and scene are saved beside the scene", options, () => withPage("easy", async (driver, folder) => {
  await driver.press("Plan");
  await untilResult(driver, /verified path/);
  const endings = { "the path, as text": "txt", "the path, as CSV": "csv", "this page, to send (HTML)": "html", "the scene for the viewer (MPV)": "mpv" };
  for (const [label, ending] of Object.entries(endings)) {
    await driver.press("Save…");
    await (await driver.control("combobox", "What")).evaluate((select, wanted) => {
      select.value = [...select.options].find((option) => option.textContent === wanted).value;
    }, label);
    await driver.page.click("dialog[open] .main");
    await driver.until(() => /^Written/.test(document.querySelector("dialog[open] [role=status]").textContent));
    await driver.press("Close");
    assert.ok(readdirSync(folder).includes(`easy.${ending}`), readdirSync(folder).join());
  }
  // The page that was saved shows the path without a planner.
  const saved = await driver.page.browser().newPage();
  await saved.goto(`file://${join(folder, "easy.html")}`);
  assert.equal(await saved.evaluate(() => window.mpView.ready.then(() => window.mpView.planner)), null);
  assert.match(await saved.$eval(".paths", (list) => list.textContent), /verified/);
  assert.match(readFileSync(join(folder, "easy.csv"), "utf8"), /^x/);
}));

test("a scene of the gallery is opened by one click", options, () => withPage("easy", async (driver) => {
  await key(driver, "g");
  await driver.press("arm");
  await driver.until(() => document.querySelector("h1").textContent === "arm");
  await driver.press("Plan");
  await untilResult(driver, /verified path/);
}));
