// A page with the planner inside: it plans as the program does. A cancel ends a run at once, whatever it does, and what it has found stays.

import assert from "node:assert/strict";
import { statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { Driver, browserTest, mp, newPage, withFolder, withoutPlanner } from "./browser.mjs";

/** A cancel is answered within 100 ms, and some more where the processor draws and other programs run too; milliseconds. */
const LATEST_CANCEL = 300;

/** A page with a planner inside is small enough to send. */
const MOST_BYTES = 2_000_000;

/** Calls `use` with a page that has this scene and its planner inside. */
const withInside = (scene, use) => withFolder(async (folder) => {
  const file = join(folder, "page.html");
  mp("render", scene, "--with-planner", "--out", file);
  assert.ok(statSync(file).size < MOST_BYTES, `${statSync(file).size} bytes`);
  const { page, context, faults } = await newPage();
  await page.goto(String(pathToFileURL(file)));
  const driver = new Driver(page);
  await driver.untilReady();
  await use(driver);
  assert.deepEqual(faults, []);
  await context.close();
});

/** In the page: presses Cancel as soon as the last run is in a state, and says how long it takes until the run has ended. */
const cancelIn = (state) => new Promise((resolve) => {
  const [result, iterations] = [5, 7].map((k) => document.querySelector("#runs .scroll tbody tr").cells[k]);
  const cancel = [...document.querySelectorAll("[aria-label=Run] button")].find((button) => button.textContent === "Cancel");
  let begin = 0;
  const look = () => {
    const words = result.textContent;
    const going = /^(starting|planning|relaxing|finishing|paused)$/.test(words);
    if (begin && !going) resolve({ milliseconds: performance.now() - begin, words });
    else if (!begin && words === state && Number(iterations.textContent.replace(/\D/g, "")) > 0) {
      begin = performance.now();
      cancel.click();
    } else if (!begin && !going) resolve({ milliseconds: NaN, words });
  };
  new MutationObserver(look).observe(result.parentElement, { childList: true, characterData: true, subtree: true });
  look();
});

/** The path of the last run, and what the page says about it. */
const kept = (driver) => driver.page.evaluate(async () => {
  const { viewer } = await window.mpView.planner;
  const path = viewer.scene.paths[viewer.settings.path];
  return path && { verified: path.verified, ofRun: path.ofRun, count: path.count, written: path.written.length };
});

browserTest("a cancel while a path is finished keeps the path", (t) => withInside("mobile-arm", async (driver) => {
  // To finish a path here takes some seconds: a cancel finds it at work. What is measured is the answer, not how long a machine takes that draws
  // by software.
  await driver.page.setViewport({ width: 900, height: 500 });
  await driver.click("checkbox", "Trees and roadmap of the run");
  const times = [];
  for (const run of [1, 2]) {
    await driver.press("Plan");
    await driver.until((wanted) => document.querySelector("#runs .scroll tbody tr")?.cells[2].textContent === String(wanted), run);
    const { milliseconds, words } = await driver.page.evaluate(cancelIn, "finishing");
    t.diagnostic(`run ${run}: ${milliseconds.toFixed(0)} ms, ${words}`);
    assert.match(words, /cancelled/);
    times.push(milliseconds);
    const cells = await driver.untilResult(/A verified path stays/, run);
    assert.match(cells[9], /\d/, "its length is known");
    const path = await kept(driver);
    assert.ok(path.verified && path.ofRun && path.count > 10 && path.written > 1, JSON.stringify(path));
  }
  assert.ok(Math.min(...times) < LATEST_CANCEL, `${times} ms`);
  // It can be saved as any other path, and the planner is still there.
  await driver.press("Save…");
  const labels = await (await driver.control("combobox", "What")).$$eval("option", (all) => all.map((option) => option.textContent));
  assert.ok(labels.includes("the path, as text"), labels.join());
  await driver.page.keyboard.press("Escape");
}), withoutPlanner);

browserTest("a cancel while planning keeps the best path so far", (t) => withInside("easy", async (driver) => {
  await driver.choose("Planner", "rrt-star");
  await driver.unfold("How to search");
  await driver.fill("spinbutton", "Most seconds", "");
  const times = [];
  for (const run of [1, 2, 3]) {
    await driver.press("Plan");
    await driver.until((wanted) => {
      const cells = document.querySelector("#runs .scroll tbody tr")?.cells;
      return cells?.[2].textContent === String(wanted) && /\d/.test(cells[9].textContent);
    }, run);
    times.push((await driver.page.evaluate(cancelIn, "planning")).milliseconds);
    await driver.untilResult(/verified path/, run);
    assert.equal((await kept(driver)).verified, true);
  }
  t.diagnostic(`${times.map((time) => time.toFixed(0)).join(", ")} ms`);
  // Other programs of the machine can only make it longer.
  assert.ok(Math.min(...times) < LATEST_CANCEL, `${times} ms`);
}), withoutPlanner);

browserTest("a path gets times, and its planner ends with that", () => withInside("arm", async (driver) => {
  await driver.press("Plan");
  await driver.untilResult(/verified path/, 1);
  const trajectory = () => driver.until(async () => {
    const { viewer } = await window.mpView.planner;
    return viewer.scene.paths[viewer.settings.path].trajectory?.duration;
  });
  await driver.press("Give it times");
  const duration = await trajectory();
  await driver.fill("spinbutton", "Velocity scale", 0);
  await driver.press("Give it times");
  await driver.untilAlert(/velocity is 0/);
  assert.equal(await trajectory(), duration);
}), withoutPlanner);

browserTest("a page is saved, without the planner", () => withInside("arm", async (driver) => {
  await driver.press("Plan");
  await driver.untilResult(/verified path/, 1);
  const text = await driver.page.evaluate(async () => {
    const { viewer, session } = await window.mpView.planner;
    const { name, columns, paths } = viewer.scene;
    const asked = { do: "export", format: "html", name, paths: paths.map((p) => ({ name: p.name, rows: p.written.map((row) => row.slice(0, columns.length)) })) };
    const { files } = await session.request(asked);
    return [files[0].name, new TextDecoder().decode(files[0].bytes)];
  });
  assert.equal(text[0], "arm.html");
  await withFolder(async (folder) => {
    const file = join(folder, text[0]);
    writeFileSync(file, text[1]);
    assert.ok(statSync(file).size < 500_000, `${statSync(file).size} bytes`);
    const { page, context, faults } = await newPage();
    await page.goto(String(pathToFileURL(file)));
    assert.equal(await page.evaluate(() => window.mpView.ready.then(() => window.mpView.planner)), null);
    assert.match(await page.$eval(".paths", (list) => list.textContent), /verified/);
    assert.deepEqual(faults, []);
    await context.close();
  });
}), withoutPlanner);

/** A scene of each kind of robot. */
const SCENES = ["arm", "rrs-high", "parking", "warehouse", "wrench", "crossing", "easy", "cubicles"];
/** Sine and cosine of the C library differ in the last digits from those in a page. */
const LAST_DIGITS = 1e-9;
for (const scene of SCENES) {
  browserTest(`a page plans in ${scene} as the program does`, () => withInside(scene, async (driver) => {
    const { path } = JSON.parse(mp("plan", scene, "--json"));
    await driver.press("Plan");
    await driver.untilResult(/verified path/, 1);
    const written = await driver.page.evaluate(async () => {
      const { viewer } = await window.mpView.planner;
      return viewer.scene.paths[viewer.settings.path].written;
    });
    assert.equal(written.length, path.length);
    path.forEach((row, i) => row.forEach((value, k) => assert.ok(Math.abs(value - written[i][k]) < LAST_DIGITS, `${row}: ${written[i]}`)));
  }), withoutPlanner);
}
