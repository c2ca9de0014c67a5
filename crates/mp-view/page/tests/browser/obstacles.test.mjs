// Obstacles of arms, of robots alone, of worlds and of maps are edited as those of rigid bodies; what is saved is planned in again.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { browserTest, mp, withFolder, withPage } from "./browser.mjs";

const documentOf = (driver) => driver.page.evaluate(async () => (await window.mpView.planner).document);
const untilObstacles = (driver, count) => driver.until(async (n) => (await window.mpView.planner).document.obstacles.length === n, count);
/** Where the obstacle with this number is drawn. */
const drawnAt = (driver, index) => driver.page.evaluate(async (i) => {
  const { scene } = (await window.mpView.planner).viewer;
  return [...scene.bodies[scene.robot + i].pose];
}, index);
/** Waits until a number of the pose of an obstacle is as given. */
const untilPose = (driver, index, k, value) =>
  driver.until(async (i, at, wanted) => Math.abs((await window.mpView.planner).document.obstacles[i].pose[at] - wanted) < 1e-9, index, k, value);
/** Saves the problem, and waits until the page says where. */
async function save(driver, name) {
  await driver.press("Save…");
  await driver.fill("textbox", "Name", name);
  await driver.press("Save");
  await driver.until((file) => document.querySelector("dialog [role=status]")?.textContent.includes(file), `${name}.toml`);
  await driver.press("Close");
}
/** Writes a path into the folder, and checks it with the program in the problem that was saved. Returns what the program says is wrong, or nothing. */
async function checked(driver, folder, problem, rows, name) {
  await driver.page.evaluate(async (path, file) => {
    const { session } = await window.mpView.planner;
    await session.request({ do: "save_path", format: "json", name: file, rows: path });
  }, rows, name);
  try {
    mp("check", join(folder, `${problem}.toml`), join(folder, `${name}.json`));
    return "";
  } catch (error) {
    return error.stdout + error.stderr;
  }
}
/** What the planner says is wrong with a path through the present scene. */
const faultsOf = (driver, rows) => driver.page.evaluate(async (path) => {
  const { session } = await window.mpView.planner;
  return (await session.request({ do: "path", name: "path", rows: path })).faults;
}, rows);
/** The point of the trace of the path that is shown which is farthest from its ends. */
const middleOfTrace = (driver) => driver.page.evaluate(async () => {
  const { viewer } = await window.mpView.planner;
  const { trace, count } = viewer.scene.paths[viewer.settings.path];
  const at = (i) => [...trace.subarray(3 * i, 3 * i + 3)];
  const away = (i) => Math.min(...[0, count - 1].map((end) => Math.hypot(...at(end).map((x, k) => x - at(i)[k]))));
  return at(Array.from({ length: count }, (_, i) => i).reduce((best, i) => (away(i) > away(best) ? i : best)));
});
/** Plans, and waits for a verified path. */
async function plan(driver, run) {
  await driver.press("Plan");
  await driver.untilResult(/found|path|m$|rad|verified/, run);
  return driver.until(async (number) => {
    const { viewer } = await window.mpView.planner;
    const rows = document.querySelectorAll("#runs .scroll tbody tr");
    return rows.length === number && viewer.scene.paths[viewer.settings.path]?.written;
  }, run);
}

browserTest("an obstacle of an arm is added, dragged, deleted and saved, and plans go around it", () => withPage("arm", async (driver, folder) => {
  const names = (await documentOf(driver)).obstacles.map((o) => o.name);
  assert.ok(names.includes("table") && names.includes("lamp"), names.join());
  const old = await plan(driver, 1);
  const place = await middleOfTrace(driver);

  await driver.choose("Figure", "sphere");
  await driver.press("Add");
  await untilObstacles(driver, names.length + 1);
  const index = names.length;
  assert.equal(await driver.alert(), "");
  await driver.fill("spinbutton", "radius, metres", "0.06");
  for (const [k, axis] of ["x", "y", "z"].entries()) {
    await driver.fill("spinbutton", `${axis}, metres`, place[k].toFixed(4));
    await untilPose(driver, index, k, Number(place[k].toFixed(4)));
  }
  const faults = await faultsOf(driver, old);
  assert.ok(faults.some((fault) => fault.includes("sphere")), faults.join());
  const fresh = await plan(driver, 2);
  assert.deepEqual(await faultsOf(driver, fresh), []);
  assert.notDeepEqual(fresh, old);

  // The saved problem stands alone, and the program finds the path free in it, and the old one not.
  await save(driver, "with-ball");
  const text = readFileSync(join(folder, "with-ball.toml"), "utf8");
  assert.match(text, /An arm on a table.*\n(.*\n)*name = "lamp post"\ncylinder = \[0\.025, 0\.6\]\n/);
  assert.match(text, /\[\[obstacle\]\]\nname = "sphere"\nsphere = 0\.06\nat = /);
  assert.equal(await checked(driver, folder, "with-ball", fresh, "fresh"), "");
  assert.match(await checked(driver, folder, "with-ball", old, "old"), /sphere/);

  // A drag along x, undone; an obstacle of the file is deleted, and comes back.
  const before = (await documentOf(driver)).obstacles[index].pose;
  const length = await driver.page.evaluate(async () => 80 * (await window.mpView.planner).viewer.camera.pixel());
  const [from, to] = [0.8, 1.6].map((part) => [before[0] + part * length, before[1], before[2]]);
  await driver.drag(await driver.pixelOf(from), await driver.pixelOf(to));
  await driver.until(async (i, x) => (await window.mpView.planner).document.obstacles[i].pose[0] > x, index, before[0] + 0.4 * length);
  assert.ok(Math.abs((await drawnAt(driver, index))[0] - (await documentOf(driver)).obstacles[index].pose[0]) < 1e-9);
  await driver.page.focus("[role=application]");
  await driver.keys("Control", "z");
  await untilPose(driver, index, 0, before[0]);
  await driver.choose("Selected", "lamp post");
  await driver.press("Delete");
  await untilObstacles(driver, names.length);
  assert.ok(!(await driver.options("Selected")).includes("lamp post"));
  await driver.press("Undo");
  await untilObstacles(driver, names.length + 1);
  assert.deepEqual((await driver.options("Selected")).slice(-2), ["lamp", "sphere"]);
}));

browserTest("obstacles are added beside a robot alone; its ends stay, and are saved", () => {
  const robot = fileURLToPath(new URL("../../../../mp-scenes/assets/robots/arm-6.urdf", import.meta.url));
  return withPage(robot, async (driver, folder) => {
    const ends = () => driver.page.evaluate(async () => {
      const { scene } = (await window.mpView.planner).viewer;
      return [scene.start.row, scene.goals.map((goal) => goal.row)];
    });
    const before = await ends();
    await driver.unfold("Start and goal");
    await driver.page.evaluate(async () => {
      const { ends: all } = await window.mpView.planner;
      const row = [...all.at("start").row];
      row[0] += 0.05;
      all.set("start", row);
    });
    const moved = await ends();
    assert.notDeepEqual(moved, before);
    await driver.press("Add");
    await untilObstacles(driver, 1);
    assert.deepEqual(await ends(), moved);
    // It is moved far away: a second edit keeps the ends too.
    await driver.fill("spinbutton", "z, metres", "7");
    await untilPose(driver, 0, 2, 7);
    assert.deepEqual(await ends(), moved);
    const path = await plan(driver, 1);
    await save(driver, "robot-and-cube");
    const text = readFileSync(join(folder, "robot-and-cube.toml"), "utf8");
    assert.ok(text.includes(robot) && text.includes('name = "cube"'), text);
    assert.equal(await checked(driver, folder, "robot-and-cube", path, "path"), "");
  });
});

browserTest("obstacles are added beside the pixels of a map, turned and scaled", () => withFolder(async (maps) => {
  writeFileSync(join(maps, "room.yaml"), "image: room.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n");
  const pixels = Buffer.alloc(120 * 80, 254);
  for (let y = 0; y < 50; y++) for (let x = 58; x < 62; x++) pixels[y * 120 + x] = 0;
  writeFileSync(join(maps, "room.pgm"), Buffer.concat([Buffer.from("P5 120 80 255\n"), pixels]));
  await withPage(join(maps, "room.yaml"), async (driver, folder) => {
    const said = await driver.page.evaluate(() => document.body.innerText);
    assert.match(said, /The pixels of the map are not edited here: add obstacles beside them, or change the image\./);
    assert.deepEqual(await driver.options("Figure"), ["rectangle", "circle", "triangle"]);
    const old = await plan(driver, 1);
    const [x, y] = await middleOfTrace(driver);
    await driver.choose("Figure", "circle");
    await driver.press("Add");
    await untilObstacles(driver, 1);
    await driver.fill("spinbutton", "radius, metres", "0.15");
    await driver.fill("spinbutton", "x, metres", x.toFixed(3));
    await driver.fill("spinbutton", "y, metres", y.toFixed(3));
    await untilPose(driver, 0, 1, Number(y.toFixed(3)));
    const faults = await faultsOf(driver, old);
    assert.ok(faults.some((fault) => fault.includes("circle")), faults.join());

    // A rectangle that is turned and scaled is a polygon in the file, and stays a rectangle in the page.
    await driver.choose("Figure", "rectangle");
    await driver.press("Add");
    await untilObstacles(driver, 2);
    for (const [name, value] of [["side x, metres", 0.4], ["side y, metres", 0.1], ["x, metres", 5.5], ["y, metres", 0.5], ["yaw about z, radians", 0.5]]) {
      await driver.fill("spinbutton", name, value);
    }
    await driver.fill("spinbutton", "scale along the body's own x axis", "1.5");
    await driver.until(async () => (await window.mpView.planner).document.obstacles[1].scale?.[0] === 1.5);
    const [px, py, , , , , w] = await drawnAt(driver, 1);
    assert.ok(Math.abs(px - 5.5) < 1e-9 && Math.abs(py - 0.5) < 1e-9 && Math.abs(w - Math.cos(0.25)) < 1e-9);
    const fresh = await plan(driver, 2);
    assert.deepEqual(await faultsOf(driver, fresh), []);
    await save(driver, "with-things");
    const text = readFileSync(join(folder, "with-things.toml"), "utf8");
    assert.match(text, /circle = \[.*0\.15\]/);
    assert.match(text, /polygon = /);
    assert.equal(await checked(driver, folder, "with-things", fresh, "fresh"), "");

    // Opened again with its map, there are the same obstacles.
    const file = (from, name) => ({ name, content: readFileSync(join(from, name)) });
    await driver.drop(file(folder, "with-things.toml"), file(maps, "room.yaml"), file(maps, "room.pgm"));
    await driver.until(async () => (await window.mpView.planner).document.obstacles[1]?.shape.polygon);
    const again = await documentOf(driver);
    assert.deepEqual(again.obstacles.map((o) => o.name), ["circle", "rectangle"]);
    assert.ok(Math.abs(again.obstacles[1].pose[0] - 5.5) < 1e-9);
  });
}));

browserTest("changed obstacles of a problem outlive a reload; later parts of a motion say where they are edited", () => withPage("carry", async (driver) => {
  const before = await documentOf(driver);
  await driver.press("Add");
  await untilObstacles(driver, before.obstacles.length + 1);
  await driver.fill("spinbutton", "z, metres", "3");
  await untilPose(driver, before.obstacles.length, 2, 3);
  const made = (await documentOf(driver)).obstacles;
  await driver.until(() => Object.values(localStorage).some((text) => JSON.parse(JSON.parse(text).text).obstacles.at(-1).pose[2] === 3));
  driver.page.once("dialog", (dialog) => dialog.accept());
  await driver.page.reload();
  await driver.untilReady();
  await driver.untilAlert(/changes that were not saved/);
  assert.equal((await documentOf(driver)).obstacles.length, before.obstacles.length);
  await driver.press("Open the copy");
  await untilObstacles(driver, made.length);
  assert.deepEqual((await documentOf(driver)).obstacles, made);
  assert.ok(await driver.page.evaluate(() => document.body.classList.contains("unsaved")));

  await driver.press("Plan");
  await driver.untilResult(/verified path/);
  // Changes that no file has are asked about, as nothing is saved there.
  await driver.press("Next part");
  await driver.press("Discard them");
  await driver.until(() => /Obstacles are edited in the first part of the motion: open the scene again\./.test(document.body.innerText));
  assert.equal(await driver.page.$eval("[aria-label='Add a body']", (element) => element.checkVisibility()), false);
}));

browserTest("every kind of problem takes an obstacle, which is drawn where the document has it", () => withPage("easy", async (driver) => {
  for (const name of ["warehouse", "docks", "unicycle", "two-arms", "humanoid", "mobile-arm", "flyer", "tool-pose", "blade", "rrs-maze"]) {
    await driver.page.evaluate(async (scene) => (await window.mpView.planner).openScene({ scene }), name);
    const before = await documentOf(driver);
    assert.ok(before && !before.robot, name);
    await driver.press("Add");
    await untilObstacles(driver, before.obstacles.length + 1);
    assert.equal(await driver.alert(), "", name);
    const { drawn, document } = await driver.page.evaluate(async () => {
      const { viewer, document: now } = await window.mpView.planner;
      const { scene } = viewer;
      return { document: now, drawn: now.obstacles.map((_, i) => ({ name: scene.bodies[scene.robot + i].name, place: [...scene.bodies[scene.robot + i].pose].slice(0, 3) })) };
    });
    for (const [i, { name: called, pose }] of document.obstacles.entries()) {
      assert.equal(drawn[i].name, called, name);
      pose.slice(0, 3).forEach((x, k) => assert.ok(Math.abs(x - drawn[i].place[k]) < 1e-9, `${name}: ${called}`));
    }
    await driver.press("Undo");
    await untilObstacles(driver, before.obstacles.length);
  }
}));
