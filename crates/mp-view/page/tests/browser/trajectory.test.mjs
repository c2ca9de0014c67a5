// A path of an arm gets times in the page: it is played in real time, plotted with its limits, and saved. With MP_PICTURES=write the picture
// of docs/viewer.md is stored.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { browserTest, mp, withFolder, withPage } from "./browser.mjs";
import { png } from "./png.mjs";

const [WIDTH, HEIGHT] = [1100, 860];
const PICTURE = fileURLToPath(new URL("../../../../../docs/pictures/viewer/trajectory.png", import.meta.url));

/** Waits for the trajectory of the path that is shown, and returns how long it takes. */
const timed = (driver, longer) => driver.until(async (least) => {
  const { viewer } = await window.mpView.planner;
  const { duration = 0 } = viewer.scene.paths[viewer.settings.path]?.trajectory ?? {};
  return duration > least && duration;
}, longer);
const seconds = (driver) => driver.page.$eval("#timeline output.count", (output) => output.textContent.split(" of ").map(parseFloat));

browserTest("a path gets times, is played in real time, plotted and saved", (t) => withPage("arm-6", async (driver, folder) => {
  await driver.press("Plan");
  await driver.untilResult(/verified path/, 1);
  await driver.press("Give it times");
  const duration = await timed(driver, 0);
  assert.ok(Math.abs((await seconds(driver))[1] - duration) < 0.01);
  await driver.choose("Plot along the path", "velocities");
  await driver.page.evaluate(() => window.mpView.setTime(0.4));
  if (process.env.MP_PICTURES === "write") {
    await driver.choose("Colours", "light");
    await driver.click("checkbox", "Trees and roadmap of the run");
    const pixels = await driver.page.evaluate(async (shot, width, height) => {
      const image = await createImageBitmap(new Blob([Uint8Array.from(atob(shot), (c) => c.charCodeAt(0))]));
      const context = new OffscreenCanvas(width, height).getContext("2d");
      context.drawImage(image, 0, 0);
      return [...context.getImageData(0, 0, width, height).data];
    }, await driver.page.screenshot({ encoding: "base64" }), WIDTH, HEIGHT);
    writeFileSync(PICTURE, png(Uint8Array.from(pixels), WIDTH, HEIGHT));
  }
  await driver.fill("spinbutton", "Velocity scale", 0.25);
  await driver.press("Give it times");
  const slower = await timed(driver, 1.05 * duration);

  // A second is a second, as the page itself measures it.
  await driver.press("Play the path");
  const [played, passed] = await driver.page.evaluate(async () => {
    const { viewer } = await window.mpView.planner;
    const { count, trajectory } = viewer.scene.paths[viewer.settings.path];
    const now = () => new Promise((resolve) => requestAnimationFrame((time) => resolve([time / 1000, (viewer.settings.time / (count - 1)) * trajectory.duration])));
    for (let i = 0; i < 3; i++) await now();
    const [first, from] = await now();
    let [last, to] = [first, from];
    while (last - first < 1) [last, to] = await now();
    // This stops it: drawing takes all of a processor.
    window.mpView.setTime(0);
    return [to - from, last - first];
  });
  t.diagnostic(`${played.toFixed(3)} s of the trajectory in ${passed.toFixed(3)} s`);
  assert.ok(Math.abs(played - passed) < 0.25, `${played} s of the trajectory in ${passed} s`);

  // Each joint has a plot with its limits, and a press in one leads to that time.
  for (const order of ["positions", "velocities", "accelerations"]) {
    await driver.choose("Plot along the path", order);
    const plots = await driver.page.$$eval(".joints svg", (all) => all.map((plot) => [plot.getAttribute("aria-label"), plot.querySelectorAll(".limit").length]));
    assert.equal(plots.length, 6);
    if (order !== "positions") assert.ok(plots.every(([label, limits]) => /limits -\d/.test(label) && limits === 2), plots.join());
  }
  await driver.choose("Plot along the path", "velocities");
  const box = await (await driver.page.$(".joints svg")).boundingBox();
  await driver.page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await driver.until((half) => Math.abs(parseFloat(document.querySelector("#timeline output.count").textContent) - half) < 0.1, slower / 2);

  // What is saved is the trajectory; the program proves it again.
  await driver.press("Save it…");
  await driver.page.click("dialog[open] .main");
  await driver.until(() => /^Written/.test(document.querySelector("dialog[open] [role=status]").textContent));
  await driver.press("Close");
  const file = join(folder, "arm-6.csv");
  assert.match(readFileSync(file, "utf8"), /^time/);
  assert.match(mp("check", "arm-6", file), /certified free/);

  // A trajectory belongs to its run.
  await driver.key("r");
  await driver.untilResult(/verified path/, 2);
  assert.match(await driver.page.$eval("#timeline output.count", (output) => output.textContent), /^\d+ of \d+$/);
  await driver.click("radio", "Show run 1");
  assert.ok(Math.abs((await seconds(driver))[1] - slower) < 0.01);
  await driver.fill("spinbutton", "Velocity scale", 0);
  await driver.press("Give it times");
  await driver.untilAlert(/the part of the limits of velocity is 0/);
}, { width: WIDTH, height: HEIGHT }));

browserTest("a path that is opened gets the times that the program gives it", () => withFolder(async (folder) => {
  const path = join(folder, "path.txt");
  mp("plan", "arm-6", "--out", path, "--picture", join(folder, "arm.png"));
  const lines = mp("time", "arm-6", path).trim().split("\n");
  await withPage(["arm-6", path], async (driver) => {
    await driver.press("Give it times");
    const duration = await timed(driver, 0);
    assert.ok(Math.abs(duration - parseFloat(lines.at(-1))) < 1e-8, `${duration} ${lines.at(-1)}`);
    assert.match(await driver.page.$eval(".paths", (list) => list.textContent), / s, length/);
  });
}));

browserTest("robots without joints get no times", () => withPage("easy", async (driver) => {
  assert.equal(await driver.page.$$eval("summary", (all) => all.filter((s) => s.textContent === "Trajectory" && !s.parentElement.hidden).length), 0);
}));
