// Measures the page with large scenes, in headless Chromium, and prints a table for docs/benchmarks.md. The browser draws in
// software, so frame rates mean nothing: what is measured is the time of the page's own script.
//
//     npm run bench            all scenes
//     npm run bench -- 100000  only scenes whose name has this word

import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import { PROGRAM, launch, missing, withPage } from "../browser/browser.mjs";
import { box, grownTree, path, ring, scene } from "./scenes.mjs";

const SCENES = [
  ["10000 triangles", () => scene([ring(10_000)])],
  ["100000 triangles", () => scene([ring(100_000)])],
  ["1000000 triangles", () => scene([ring(1_000_000)])],
  ["10000000 triangles", () => scene([ring(10_000_000)])],
  ["1000 bodies of 1000 triangles", () => scene(Array.from({ length: 1000 }, (_, i) => ring(1000, i)))],
  ["path of 10000 configurations", () => scene([ring(1000)], { paths: [path(10_000)] })],
  ["trees of 100000 edges", () => scene([box()], { trees: [grownTree(50_000, 1), grownTree(50_000, 2)] })],
];
const HEAD = ["scene", "scene file, MB", "first picture, s", "script until then, ms", "script per frame, ms (most)", "draw calls", "slowest click, ms", "memory, MB"];

/** Drawings of which the median is taken; of scenes whose drawing in software takes many seconds, fewer. @param {Uint8Array} bytes */
const framesOf = (bytes) => (bytes.length > 1e8 ? 2 : 7);
const PLACE = /(<script id="scene"[^>]*>)[^<]*/;

/** The median. @param {number[]} values */
const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

/** The page with another scene inside. @param {string} html @param {Uint8Array} bytes */
function withScene(html, bytes) {
  const packed = gzipSync(bytes, { level: 1 }).toString("base64");
  return html.replace(PLACE, (_, begin) => begin + packed);
}

/** Runs in the page: the times of its script, milliseconds. @param {number} frames */
async function measure(frames) {
  const { mpView } = window;
  await mpView.ready;
  const opened = performance.now();
  const painted = () => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
  await painted();
  const times = [];
  for (let i = 0; i < frames; i++) {
    mpView.setTime(i / frames);
    mpView.draw();
    times.push(mpView.stats().milliseconds);
    await painted();
  }
  const { drawCalls } = mpView.stats();
  const clicks = [];
  let hits = 0;
  const { clientWidth, clientHeight } = document.getElementById("canvas");
  // Along a diagonal, to meet bodies as well as gaps.
  for (let i = 1; i < 24; i++) {
    const begin = performance.now();
    mpView.click((clientWidth * i) / 24, (clientHeight * i) / 24);
    clicks.push(performance.now() - begin);
    if (document.getElementById("hint").textContent) hits++;
  }
  if (!hits) throw new Error("No click has met anything.");
  for (let i = 0; i < 3; i++) {
    globalThis.gc();
    await new Promise((resolve) => setTimeout(resolve, 200));
  }
  const memory = performance.memory.usedJSHeapSize;
  return { opened, times, drawCalls, clicks, memory, alert: document.querySelector("[role=alert]").textContent };
}

/** A scene file in a page of its own. @param {import("puppeteer-core").Browser} browser @param {string} html @param {Uint8Array} bytes */
async function opened(browser, html, bytes) {
  const folder = mkdtempSync(join(tmpdir(), "mp-bench-"));
  try {
    const file = join(folder, "scene.html");
    writeFileSync(file, withScene(html, bytes));
    const page = await browser.newPage();
    await page.setViewport({ width: 1200, height: 900 });
    const session = await page.createCDPSession();
    await session.send("Performance.enable");
    await page.goto(`file://${file}`, { timeout: 300_000 });
    await page.evaluate(() => window.mpView.ready);
    const { metrics } = await session.send("Performance.getMetrics");
    const script = 1000 * metrics.find((m) => m.name === "TaskDuration").value;
    const found = await page.evaluate(measure, framesOf(bytes));
    await page.close();
    return { ...found, script };
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}

/** Runs in the page of `mp view`: a tree of 100,000 edges that grows by events of 2000 nodes. */
async function grow() {
  const { viewer } = await window.mpView.planner;
  const { RunPicture } = await import("mp/live.js");
  const layer = viewer.layers.find((it) => "rejected" in it && "all" in it);
  const run = new RunPicture(viewer.renderer);
  layer.all.add(run);
  layer.shown = run;
  const [events, frames] = [[], []];
  const count = 2000;
  for (let step = 0; step < 50; step++) {
    const nodes = new Float32Array(3 * count).map(() => Math.random());
    const parents = new Int32Array(count).map((_, i) => Math.floor(Math.random() * (step * count + i + 1)) - 1);
    const some = { tree: 0, nodes: new Uint32Array(200).map((_, i) => i), parents: new Int32Array(200).fill(-1) };
    const rewired = step ? [some] : [];
    const begin = performance.now();
    run.grow({ trees: [{ tree: 0, name: "from the start", from: step * count, nodes, parents }], rewired });
    events.push(performance.now() - begin);
    viewer.draw();
    frames.push(viewer.stats.milliseconds);
    await new Promise((resolve) => requestAnimationFrame(resolve));
  }
  return { events, frames, drawCalls: viewer.stats.drawCalls };
}

/** @param {number} x milliseconds */
const ms = (x) => (x < 10 ? x.toFixed(1) : Math.round(x).toString());

async function main() {
  if (missing) throw new Error(missing);
  const word = process.argv[2] ?? "";
  const folder = mkdtempSync(join(tmpdir(), "mp-bench-"));
  execFileSync(PROGRAM, ["render", "easy", "--out", join(folder, "base.html")]);
  const html = readFileSync(join(folder, "base.html"), "utf8");
  rmSync(folder, { recursive: true, force: true });
  console.log(`| ${HEAD.join(" | ")} |`);
  console.log(`| ${HEAD.map(() => "---").join(" | ")} |`);
  for (const [name, make] of SCENES.filter(([name]) => name.includes(word))) {
    // A browser for each: the memory of one scene does not count for the next.
    const browser = await launch(["--enable-precise-memory-info", "--js-flags=--expose-gc"]);
    try {
      const bytes = make();
      const it = await opened(browser, html, bytes);
      const frames = `${ms(median(it.times))} (${ms(Math.max(...it.times))})`;
      const cells = [name, (bytes.length / 1e6).toFixed(1), (it.opened / 1000).toFixed(1), ms(it.script), frames, it.drawCalls,
        ms(Math.max(...it.clicks)), Math.round(it.memory / 1e6)];
      console.log(`| ${cells.join(" | ")} |`);
      if (it.alert) console.log(`    the page says: ${it.alert}`);
    } finally {
      await browser.close();
    }
  }
  if ("events of 2000 nodes".includes(word)) {
    await withPage("easy", async ({ page }) => {
      const { events, frames, drawCalls } = await page.evaluate(grow);
      const times = (all) => `${ms(median(all))} ms (most ${ms(Math.max(...all))})`;
      console.log("\nA tree that grows to 100,000 edges by events of 2000 nodes and 200 rewired:");
      console.log(`${times(events)} an event, ${times(frames)} a picture, ${drawCalls} draw calls.`);
    });
  }
}

await main();
