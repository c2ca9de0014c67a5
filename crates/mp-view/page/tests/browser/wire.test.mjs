// Pictures of wire: what surfaces hide is faint.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { browserTest, withFolder, withPage } from "./browser.mjs";

/** A wall, a higher box behind it, and a robot that starts behind the wall. */
const SCENE = `
[robot]
box = [0.5, 0.5, 0.5]
bounds = [[-4, -4, -4], [4, 4, 4]]

[motion]
start = [-1.5, 1, 0, 0, 0, 0]
goal = [3, -1, 0, 0, 0, 0]

[[obstacle]]
name = "wall"
box = [4, 0.2, 2]

[[obstacle]]
name = "behind"
box = [2, 0.5, 3]
pose = [0, 2, 0, 0, 0, 0]
`;
/** Points of the world, as the front view shows them: on edges of the box behind and of the wall, and the robot. */
const POINTS = { hidden: [1, 1.75, 0.3], above: [1, 1.75, 1.4], wall: [2, -0.1, 0.3], robot: [-1.5, 1, 0] };

/** How far the pixels at points are from the background, 0 to 255; of a point and its neighbours the farthest. In the page. */
async function strengths(points, modes) {
  const { viewer } = await window.mpView.planner;
  viewer.scene.bodies.forEach((body, i) => (viewer.settings.bodies[i].mode = modes[body.name] ?? modes.others));
  const { width, height } = viewer.canvas;
  const copy = new OffscreenCanvas(width, height).getContext("2d");
  window.mpView.draw();
  copy.drawImage(viewer.canvas, 0, 0);
  const { data } = copy.getImageData(0, 0, width, height);
  const { both } = viewer.camera.matrices();
  const at = (point) => {
    const [x, y] = viewer.camera.project(both, point).map((c) => Math.floor(c * viewer.ratio));
    const near = [-1, 0, 1].flatMap((i) => [-1, 0, 1].map((j) => 4 * ((y + i) * width + x + j)));
    return Math.max(...near.flatMap((o) => [0, 1, 2].map((k) => Math.abs(data[o + k] - data[k]))));
  };
  return Object.fromEntries(Object.entries(points).map(([name, point]) => [name, at(point)]));
}

browserTest("in pictures of wire, edges that surfaces hide are faint", () => withFolder((folder) => {
  const file = join(folder, "wire.toml");
  writeFileSync(file, SCENE);
  return withPage(file, async (driver) => {
    await driver.press("Front");
    await driver.press("Fit");
    const seen = (modes) => driver.page.evaluate(strengths, POINTS, modes);
    const wire = await seen({ others: "wire" });
    assert.ok(wire.above > 60 && wire.wall > 60, JSON.stringify(wire));
    assert.ok(wire.hidden > 4 && 4 * wire.hidden < wire.above, JSON.stringify(wire));
    // What is solid or transparent behind wire is not hidden, and hides edges itself.
    assert.ok((await seen({ robot: "solid", others: "wire" })).robot > 60);
    assert.ok((await seen({ robot: "transparent", others: "wire" })).robot > 20);
    const wall = await seen({ wall: "solid", others: "wire" });
    const without = await seen({ wall: "solid", behind: "solid", others: "wire" });
    assert.equal(wall.hidden, without.hidden, JSON.stringify([wall, without]));
    assert.ok(wall.above > 60);
  });
}));
