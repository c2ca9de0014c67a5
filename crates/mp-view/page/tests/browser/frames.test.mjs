// An exported page inside another page: in a notebook, a wiki, a report.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { browserTest, coverage, mp, newPage, withFolder, withoutPlanner } from "./browser.mjs";

/** The page in the frame, when it has drawn its scene. */
async function framed(page) {
  const frame = await (await page.waitForSelector("iframe")).contentFrame();
  await frame.waitForFunction(() => window.mpView && !document.body.classList.contains("loading"), { polling: 50, timeout: 60_000 });
  return frame;
}
/** The frame shows the scene and its path, and can be used. */
async function checked(frame) {
  assert.equal(await frame.$eval("[role=alert]", (box) => box.hidden), true);
  assert.equal(await frame.$eval("h1", (title) => title.textContent), "easy");
  assert.ok((await frame.evaluate(coverage)) > 0.02);
  await (await frame.waitForSelector('::-p-aria([name="All at once"][role="button"])')).click();
  await frame.waitForFunction(() => /shown$/.test(document.querySelector("#timeline output").textContent), { polling: 50, timeout: 60_000 });
}
/** Pages around the frame: one names a file, one holds the text, as notebooks do. */
const HOSTS = {
  src: () => '<!doctype html><title>Report</title><iframe src="easy.html" sandbox="allow-scripts" width="800" height="600"></iframe>',
  srcdoc: (text) => `<!doctype html><title>Report</title><iframe srcdoc="${text.replaceAll("&", "&amp;").replaceAll('"', "&quot;")}" sandbox="allow-scripts" width="800" height="600"></iframe>`,
};

for (const [kind, host] of Object.entries(HOSTS)) {
  browserTest(`an exported page works in a frame by ${kind}`, () => withFolder(async (folder) => {
    const [path, exported] = [join(folder, "easy.txt"), join(folder, "easy.html")];
    mp("plan", "easy", "--out", path, "--picture", join(folder, "easy.png"));
    mp("render", "easy", path, "--out", exported);
    writeFileSync(join(folder, "report.html"), host(readFileSync(exported, "utf8")));
    const { page, context, faults } = await newPage();
    await page.goto(String(pathToFileURL(join(folder, "report.html"))));
    await checked(await framed(page));
    assert.deepEqual(faults, []);
    await context.close();
  }));
}

browserTest("a page with a planner inside plans in a frame", () => withFolder(async (folder) => {
  mp("render", "easy", "--with-planner", "--out", join(folder, "easy.html"));
  writeFileSync(join(folder, "report.html"), HOSTS.src());
  const { page, context, faults } = await newPage();
  await page.goto(String(pathToFileURL(join(folder, "report.html"))));
  const frame = await framed(page);
  await (await frame.waitForSelector('::-p-aria([name="Plan"][role="button"]):not([disabled])', { timeout: 60_000 })).evaluate((button) => button.click());
  await frame.waitForFunction(() => /verified path/.test(document.querySelector("#runs .scroll tbody tr")?.textContent ?? ""), { polling: 50, timeout: 60_000 });
  await checked(frame);
  assert.deepEqual(faults, []);
  await context.close();
}), withoutPlanner);
