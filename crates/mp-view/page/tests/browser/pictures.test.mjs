// The pictures of docs/viewer.md: scenes in all modes of surfaces and of the animation. They are compared with the stored ones; with
// MP_PICTURES=write they are stored.

import assert from "node:assert/strict";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { browserTest, newPage, withPage } from "./browser.mjs";
import { png } from "./png.mjs";

const FOLDER = fileURLToPath(new URL("../../../../../docs/pictures/viewer/", import.meta.url));
const WRITE = process.env.MP_PICTURES === "write";
/** Scene, name of the picture, planner, whether the search is shown, and the view: a button, and keys that turn and enlarge it.
 * @type {[scene: string, name: string, planner: string, search: boolean, view: string | null, keys: string[]][]} */
const SCENES = [
  ["gempa-1", "gempa-1", "rrt-connect", false, null, []],
  ["gempa-2", "gempa-2", "rrt-connect", false, null, []],
  ["gempa-3", "gempa-3", "rrt-connect", false, null, []],
  ["gempa-4", "gempa-4", "rrt-connect", false, null, []],
  ["arm", "arm", "rrt-connect", false, "Left", [...Array(5).fill("ArrowUp"), ...Array(8).fill("ArrowLeft"), "f", "+", "+", "+"]],
  ["rrs-maze", "rrs-maze", "rrt-connect", false, null, []],
  ["gempa-1", "roadmap", "prm", true, null, []],
];
const MODES = ["solid", "transparent", "wire"];
/** The ways to show a path: the button, and where on the path the picture is taken. @type {[string, number][]} */
const ANIMATIONS = [["All at once", 1], ["Step by step", 0.4], ["Automatic", 0.65]];
/** The size of each part of a sheet, pixels. */
const [WIDTH, HEIGHT] = [320, 240];
/** The grey of the lines between them. */
const LINE = 160;
/** Colours may differ by so much: the stored pictures have 256 of them. */
const NEAR = 40;
/** The share of the pixels of a part that may differ more: other versions of Chromium round the edges of triangles and lines
 * differently. A goal that is not drawn in gempa-4 makes 0.25%. */
const SHARE = 0.002;

/** A picture of the sheet: pixels as the page draws them, in base64. */
async function partOf(driver) {
  return driver.page.evaluate(([width, height]) => {
    const canvas = document.getElementById("canvas");
    const context = new OffscreenCanvas(width, height).getContext("2d");
    window.mpView.draw();
    context.drawImage(canvas, 0, 0, width, height);
    const { data } = context.getImageData(0, 0, width, height);
    let text = "";
    for (let i = 0; i < data.length; i += 8192) text += String.fromCharCode(...data.subarray(i, i + 8192));
    return btoa(text);
  }, [WIDTH, HEIGHT]);
}

/** All modes of a scene: surfaces from left to right, animations from top to bottom. */
async function sheetOf(driver) {
  // Where no part is, there are lines between them.
  const sheet = new Uint8Array(4 * 9 * WIDTH * HEIGHT).fill(LINE);
  for (const [y, [animation, time]] of ANIMATIONS.entries()) {
    await driver.press(animation);
    if (animation === "Automatic") await driver.until(async () => (await window.mpView.planner).viewer.settings.time % 1 > 0);
    // This stops it, too.
    await driver.page.evaluate((t) => window.mpView.setTime(t), time);
    for (const [x, mode] of MODES.entries()) {
      await driver.choose("Surfaces", mode);
      const part = Buffer.from(await partOf(driver), "base64");
      for (let row = 0; row < HEIGHT - 1; row++) sheet.set(part.subarray(4 * WIDTH * row, 4 * (WIDTH * (row + 1) - 1)), 4 * WIDTH * (3 * (HEIGHT * y + row) + x));
    }
  }
  return sheet;
}

/** The share of the pixels that differ from those of a stored picture, in the part of the sheet where it is largest. */
async function difference(page, sheet, stored) {
  return page.evaluate(async ([ours, theirs, width, height, near]) => {
    const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes(theirs)]));
    if (image.width !== 3 * width || image.height !== 3 * height) return 1;
    const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
    context.drawImage(image, 0, 0);
    const [a, b] = [bytes(ours), context.getImageData(0, 0, image.width, image.height).data];
    const counts = new Array(9).fill(0);
    for (let i = 0; i < a.length / 4; i++) {
      const [x, y] = [i % image.width, Math.floor(i / image.width)];
      if ([0, 1, 2].some((k) => Math.abs(a[4 * i + k] - b[4 * i + k]) > near)) counts[3 * Math.floor(y / height) + Math.floor(x / width)]++;
    }
    return Math.max(...counts) / (width * height);
  }, [Buffer.from(sheet).toString("base64"), stored.toString("base64"), WIDTH, HEIGHT, NEAR]);
}

for (const [scene, name, planner, search, view, keys] of SCENES) {
  // The part of the window that shows the scene is twice as large as a part of the sheet, so its lines are smooth in the sheet.
  browserTest(`pictures of ${name}`, (t) => withPage(scene, async (driver) => {
    await driver.choose("Planner", planner);
    await driver.press("Plan");
    await driver.untilResult(/verified path/);
    if (!search) await driver.click("checkbox", "Trees and roadmap of the run");
    await driver.choose("Colours", "light");
    await driver.page.evaluate(([width, height]) => {
      const canvas = document.getElementById("canvas");
      Object.assign(canvas.style, { position: "fixed", width: `${2 * width}px`, height: `${2 * height}px` });
    }, [WIDTH, HEIGHT]);
    await driver.until(([width, height]) => {
      const canvas = document.getElementById("canvas");
      return canvas.width === 2 * width && canvas.height === 2 * height;
    }, [WIDTH, HEIGHT]);
    await driver.press(view ?? "Fit");
    for (const key of keys) await driver.keys(...(key.startsWith("Arrow") ? ["Shift", key] : [key]));
    const sheet = await sheetOf(driver);
    const file = join(FOLDER, `${name}.png`);
    if (WRITE) {
      mkdirSync(FOLDER, { recursive: true });
      writeFileSync(file, png(sheet, 3 * WIDTH, 3 * HEIGHT));
      return;
    }
    const { page, context } = await newPage();
    const share = await difference(page, sheet, readFileSync(file)).finally(() => context.close());
    t.diagnostic(`${(100 * share).toFixed(2)}% of the pixels differ where most do`);
    assert.ok(share < SHARE, `${(100 * share).toFixed(2)}% of the pixels of a part differ from docs/pictures/viewer/${name}.png; if the change is right, “MP_PICTURES=write npm run test-browser” stores new pictures`);
  }));
}
