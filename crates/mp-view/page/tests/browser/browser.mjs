// A browser for tests: headless Chromium with the page of `mp view`, driven through labels as a person or a screen reader has them.

import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import puppeteer from "puppeteer-core";

export const PROGRAM = process.env.MP ?? fileURLToPath(new URL("../../../../../target/debug/mp", import.meta.url));
const CHROMIUM = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find((path) => path && existsSync(path));

/** Why these tests cannot run here, or false. */
export const missing = !CHROMIUM ? "no Chromium: install it, or name it in the variable CHROMIUM"
  : !existsSync(PROGRAM) ? `no program ${PROGRAM}: build it by “cargo build -p mp-motion-cli”, or name it in the variable MP` : false;

/** The address that `mp view` prints. */
function addressOf(program) {
  return new Promise((resolve, reject) => {
    let text = "";
    program.stdout.on("data", (data) => {
      text += data;
      const found = text.match(/http:\/\/127\.0\.0\.1:\d+\/\S*/);
      if (found) resolve(found[0]);
    });
    program.on("exit", (code) => reject(new Error(`mp view ended with ${code}`)));
  });
}

const FLAGS = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

/** A headless browser that draws in software. @param {string[]} [more] flags */
export const launch = (more = []) => puppeteer.launch({ executablePath: CHROMIUM, args: [...FLAGS, ...more], protocolTimeout: 600_000 });

/** Opens the page of `mp view` and calls `test` with it. A page that throws, or logs an error, fails the test. */
export async function withPage(scene, test) {
  const folder = mkdtempSync(join(tmpdir(), "mp-view-"));
  const program = spawn(PROGRAM, ["view", scene, "--no-browser", "--folder", folder], { stdio: ["ignore", "pipe", "inherit"] });
  const browser = await launch();
  try {
    const page = await browser.newPage();
    await page.setViewport({ width: 1200, height: 900 });
    const faults = [];
    page.on("pageerror", (error) => faults.push(error.message));
    page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
    await page.goto(await addressOf(program));
    await page.evaluate(() => window.mpView.ready.then(() => window.mpView.planner));
    await test(new Driver(page), folder);
    if (faults.length) throw new Error(`The page reports errors: ${faults.join("; ")}`);
  } finally {
    await browser.close();
    program.kill("SIGINT");
    rmSync(folder, { recursive: true, force: true });
  }
}

/** A page driven through labels. */
export class Driver {
  constructor(page) {
    this.page = page;
  }
  /** The one control with this role and name. */
  async control(role, name) {
    return this.page.waitForSelector(`::-p-aria([name="${name}"][role="${role}"])`, { timeout: 15_000 });
  }
  async press(name) {
    await (await this.control("button", name)).click();
  }
  /** Waits until `condition` (a function for the page) gives something true, and returns it. */
  async until(condition, ...args) {
    return (await this.page.waitForFunction(condition, { timeout: 20_000, polling: 50 }, ...args)).jsonValue();
  }
  async choose(name, value) {
    await (await this.control("combobox", name)).select(value);
  }
  /** Types a value over that of a field. */
  async fill(role, name, value) {
    const field = await this.control(role, name);
    await field.click({ count: 3 });
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
