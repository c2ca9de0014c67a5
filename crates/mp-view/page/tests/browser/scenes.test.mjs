// Every shipped scene opens from the gallery, and something is drawn.

import assert from "node:assert/strict";
import { browserTest, mp, withPage } from "./browser.mjs";

browserTest("every shipped scene opens and is drawn", () => withPage([], async (driver) => {
  const names = mp("scenes").trim().split(/\s+/);
  assert.ok(names.length > 20, names.join());
  const shown = await driver.page.$$eval("dialog.gallery li button", (buttons) => buttons.map((button) => button.value));
  assert.deepEqual(shown.sort(), names.sort(), "without a scene the gallery is open");
  await driver.press("Close");
  for (const name of names) {
    await driver.key("g");
    await driver.press(name);
    await driver.until((wanted) => document.querySelector("h1").textContent === wanted, name);
    assert.equal(await driver.page.$eval("[role=alert]", (box) => box.hidden || box.classList.contains("note")), true, `${name}: ${await driver.alert()}`);
    const part = await driver.drawn();
    assert.ok(part > 0.02, `${name}: ${part} of the picture is not background`);
  }
}, { width: 800, height: 600 }));
