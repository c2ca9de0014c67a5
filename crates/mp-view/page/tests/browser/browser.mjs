// A browser for tests: headless Chromium with the page of `mp view`, driven through labels as a person or a screen reader has them.

import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, test } from "node:test";
import { fileURLToPath } from "node:url";
import puppeteer from "puppeteer-core";

/** The program, for commands that tests run. */
export const PROGRAM = process.env.MP ?? fileURLToPath(new URL("../../../../../target/debug/mp", import.meta.url));
const CHROMIUM = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find((path) => path && existsSync(path));
const FLAGS = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-compositing", "--force-device-scale-factor=1"];

/** Why these tests cannot run here, or false. */
export const missing = !CHROMIUM ? "no Chromium: install it, or name it in the variable CHROMIUM"
  : !existsSync(PROGRAM) ? `no program ${PROGRAM}: build it by “cargo build -p mp-motion-cli”, or name it in the variable MP` : false;
if (missing && process.env.MP_BROWSER_TESTS === "required") throw new Error(`The tests in a browser are required here, but there is ${missing}.`);

let told = false;
/** A test in the browser. Where it cannot run, one line for each file says why. @param {string} name
 * @param {(t: import("node:test").TestContext) => Promise<void>} run @param {string | false} [lacking] what else is missing for this test */
export function browserTest(name, run, lacking = false) {
  if (!missing) return test(name, { skip: lacking, timeout: 300_000 }, run);
  if (!told) test("tests in a browser", { skip: missing }, () => {});
  told = true;
}

/** The one browser of a file of tests; it is started when the first test needs it. */
let browser = null;
after(async () => (await browser)?.close());
/** A headless browser that draws in software. @param {string[]} [more] flags */
export const launch = (more = []) => puppeteer.launch({ executablePath: CHROMIUM, args: [...FLAGS, ...more], protocolTimeout: 600_000 });
function launched() {
  browser ??= launch();
  return browser;
}

/** A folder for a test. It is removed afterwards. @template T @param {(folder: string) => Promise<T>} use @returns {Promise<T>} */
export async function withFolder(use) {
  const folder = mkdtempSync(join(tmpdir(), "mp-view-"));
  try {
    return await use(folder);
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}

/** The folder of the planner for pages that the program finds. */
const PLANNERS = process.env.MP_PLANNERS ?? join(dirname(PROGRAM), "..", "planners");
process.env.MP_PLANNERS = PLANNERS;
/** Why pages cannot plan, or false. */
export const withoutPlanner = existsSync(join(PLANNERS, "planner.wasm"))
  ? false
  : "no planner for pages: “cargo xtask wasm” builds it";

/** Runs the program to its end, and fails when it fails. @param {...string} args */
export const mp = (...args) => execFileSync(PROGRAM, args, { stdio: ["ignore", "pipe", "pipe"], encoding: "utf8" });

/** Starts `mp view`. @param {string[]} args @returns {Promise<{address: string, end: () => Promise<void>}>} */
export async function serve(args) {
  const program = spawn(PROGRAM, ["view", ...args, "--no-browser"], { stdio: ["ignore", "pipe", "pipe"] });
  let said = "";
  program.stderr.on("data", (data) => (said += data));
  const exited = new Promise((resolve) => program.on("exit", resolve));
  const address = await new Promise((resolve, reject) => {
    let text = "";
    program.stdout.on("data", (data) => {
      text += data;
      const found = text.match(/http:\/\/127\.0\.0\.1:\d+\/\S*/);
      if (found) resolve(found[0]);
    });
    program.on("exit", (code) => reject(new Error(`mp view ended with ${code}: ${said}`)));
  });
  const end = async () => {
    program.kill("SIGINT");
    await exited;
  };
  return { address, end };
}

/** A tab in a context of its own. Without smoothed edges a picture is the same on every machine. @param {{width?: number, height?: number}} [size] */
export async function newPage({ width = 1200, height = 900 } = {}) {
  const context = await (await launched()).createBrowserContext();
  const page = await context.newPage();
  await page.setViewport({ width, height });
  await page.evaluateOnNewDocument(() => {
    const { getContext } = HTMLCanvasElement.prototype;
    HTMLCanvasElement.prototype.getContext = function (kind, options) {
      return getContext.call(this, kind, kind === "webgl2" ? { ...options, antialias: false } : options);
    };
  });
  const faults = [];
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
  return { page, context, faults };
}

/** Opens the page of `mp view SCENE` and calls `use` with it, the folder for its files, and the server. A page that throws, or
 * logs an error that is not expected, fails the test.
 * @param {string | string[]} scene what the command line names @param {(driver: Driver, folder: string, server: Awaited<ReturnType<typeof serve>>) => Promise<void>} use
 * @param {{width?: number, height?: number, expected?: RegExp}} [options] */
export const withPage = (scene, use, { expected, ...size } = {}) => withFolder(async (folder) => {
  const server = await serve([...[scene].flat(), "--folder", folder]);
  const { page, context, faults } = await newPage(size);
  try {
    await page.goto(server.address);
    const driver = new Driver(page);
    await driver.untilReady();
    await use(driver, folder, server);
    const surprising = faults.filter((fault) => !expected?.test(fault));
    if (surprising.length) throw new Error(`The page reports errors: ${surprising.join("; ")}`);
  } finally {
    await context.close();
    await server.end();
  }
});

/** How long a busy machine may take for what a person waits for, milliseconds. */
const PATIENCE = 60_000;
const selector = (role, name) => `::-p-aria([name="${name}"][role="${role}"])`;

/** How much of the picture is not background, 0 to 1. For the page, or a frame in it. */
export function coverage() {
  const canvas = document.getElementById("canvas");
  const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
  // The picture can be read only until the browser has shown it.
  window.mpView.draw();
  copy.drawImage(canvas, 0, 0);
  const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
  let other = 0;
  for (let i = 0; i < data.length; i += 4) if (Math.max(...[0, 1, 2].map((k) => Math.abs(data[i + k] - data[k]))) > 8) other++;
  return (4 * other) / data.length;
}

/** A page driven through labels. */
export class Driver {
  constructor(page) {
    this.page = page;
  }
  /** The one control with this role and name. */
  async control(role, name) {
    return this.page.waitForSelector(selector(role, name), { timeout: PATIENCE });
  }
  /** Clicks on a control, when it is enabled and stays where it is: runs and replies move the controls below them. */
  async click(role, name) {
    await this.page.locator(selector(role, name)).setTimeout(PATIENCE).click();
  }
  async press(name) {
    await this.click("button", name);
  }
  /** Waits until the page has its scene and its planner, if it is one with a planner. */
  async untilReady() {
    await this.page.evaluate(() => {
      const done = (state) => (window.stateForTests = state);
      window.mpView.planner.then(() => done("ready"), (error) => done(`failed: ${error.message}`));
    });
    assert.equal(await this.until(() => window.stateForTests), "ready");
  }
  /** Presses a key, with the focus on the picture. */
  async key(name) {
    await this.page.focus("[role=application]");
    await this.page.keyboard.press(name);
  }
  /** Waits until `condition` (a function for the page) gives something true, and returns it. */
  async until(condition, ...args) {
    return (await this.page.waitForFunction(condition, { timeout: PATIENCE, polling: 50 }, ...args)).jsonValue();
  }
  async choose(name, value) {
    await (await this.control("combobox", name)).select(value);
  }
  /** Types a value over that of a field. */
  async fill(role, name, value) {
    const field = await this.control(role, name);
    await field.evaluate((element) => element.select());
    await field.type(String(value));
    await this.page.keyboard.press("Tab");
  }
  /** Keys held together, such as Control and z. */
  async keys(...keys) {
    for (const key of keys) await this.page.keyboard.down(key);
    for (const key of keys.reverse()) await this.page.keyboard.up(key);
  }
  /** The options of a list. */
  async options(name) {
    return (await this.control("combobox", name)).$$eval("option", (all) => all.map((option) => option.textContent));
  }
  async value(role, name) {
    return (await this.control(role, name)).evaluate((element) => element.value);
  }
  /** Unfolds a part of the panel. */
  async unfold(title) {
    await this.page.evaluate((name) => {
      const summary = [...document.querySelectorAll("summary")].find((e) => e.textContent === name);
      if (!summary.parentElement.open) summary.click();
    }, title);
  }
  /** Drops files on the page: `content` is text or bytes. @param {{name: string, content: string | Uint8Array}[]} files */
  async drop(...files) {
    const packed = files.map(({ name, content }) => [name, Buffer.from(content).toString("base64")]);
    await this.page.evaluate((list) => {
      const transfer = new DataTransfer();
      for (const [name, text] of list) transfer.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
      window.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));
    }, packed);
  }
  /** Waits until the page says what went wrong, in words that match. @param {RegExp} words */
  async untilAlert(words) {
    return this.until((source) => {
      const box = document.querySelector("[role=alert]:not([hidden])");
      return box && new RegExp(source).test(box.textContent) && box.textContent;
    }, words.source);
  }
  /** The texts of the table of runs, the last run first. */
  async runs() {
    return this.page.$$eval("#runs .scroll tbody tr", (rows) => rows.map((row) => [...row.cells].map((cell) => cell.textContent)));
  }
  /** Waits until the last run has a result that matches, and returns its cells. @param {RegExp} words @param {number} [run] its number */
  async untilResult(words, run = 0) {
    return this.until((source, wanted) => {
      const row = document.querySelector("#runs .scroll tbody tr");
      const cells = row && [...row.cells].map((cell) => cell.textContent);
      return cells && (!wanted || cells[2] === String(wanted)) && new RegExp(source).test(cells[5]) && cells;
    }, words.source, run);
  }
  /** How much of the picture is not background, 0 to 1. */
  async drawn() {
    return this.page.evaluate(coverage);
  }
  /** What the page says went wrong. */
  async alert() {
    return this.page.$eval("[role=alert]", (element) => (element.hidden ? "" : element.textContent));
  }
  /** The pixel of a point of the world. */
  async pixelOf(point) {
    return this.page.evaluate(async (at) => {
      const { viewer } = await window.mpView.planner;
      const box = viewer.canvas.getBoundingClientRect();
      const [x, y] = viewer.camera.project(viewer.camera.matrices().both, at);
      return [x + box.left, y + box.top];
    }, point);
  }
  /** Looks at a corner of where the robot may be. */
  async lookAtCorner() {
    await this.page.evaluate(async () => {
      const { viewer } = await window.mpView.planner;
      viewer.camera.target = viewer.scene.limits.slice(0, 3).map(([low, high], k) => (k ? high : low));
      viewer.changed();
    });
  }
  /** Drags from a pixel to another, slowly enough for the page to follow. */
  async drag([x, y], [toX, toY]) {
    const { mouse } = this.page;
    await mouse.move(x, y);
    await mouse.down();
    await mouse.move((x + toX) / 2, (y + toY) / 2, { steps: 3 });
    await mouse.move(toX, toY, { steps: 3 });
    await mouse.up();
  }
}
