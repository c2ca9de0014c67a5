// The page and the pictures of `mp render` show the same scene: two programs that share no code for drawing.
//
// Compared is what is seen at each pixel: nothing, an obstacle, the robot at its start, or the robot at its goal. Light, shadow and
// colours of obstacles differ on purpose, and so do the grid under the scene, the letters and the dark edges of a picture: they are
// left to the 3%. `mp render` shows the robot through obstacles that stand before it, so the cameras look where none does.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { browserTest, mp, withFolder, withPage } from "./browser.mjs";

const [WIDTH, HEIGHT] = [640, 480];
/** Scenes, and the direction from which they are seen, radians. @type {[scene: string, yaw: number, pitch: number][]} */
const VIEWS = [["gempa-2", -1.2, 1.25], ["easy", -1.9, 1.3]];
/** The part of the pixels that may differ, of those where either picture has a body: harder than of the whole picture. */
const MOST = 0.03;

/** Compares the page's picture with that of a file, in the page. */
function compared([text, width, height]) {
  const classOf = (r, g, b) => {
    if (Math.min(r, g, b) > 222) return 0;
    if (g > r + 25 && g > b + 20) return 2;
    if (r > g + 50 && r > b + 50) return 3;
    return 1;
  };
  return createImageBitmap(new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))])).then((image) => {
    const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
    const classes = (source) => {
      context.drawImage(source, 0, 0);
      const { data } = context.getImageData(0, 0, width, height);
      return Uint8Array.from({ length: width * height }, (_, i) => classOf(data[4 * i], data[4 * i + 1], data[4 * i + 2]));
    };
    const theirs = classes(image);
    window.mpView.draw();
    const ours = classes(document.getElementById("canvas"));
    const counts = { all: width * height, either: 0, differ: 0, ours: [0, 0, 0, 0], theirs: [0, 0, 0, 0] };
    ours.forEach((c, i) => {
      counts.ours[c]++;
      counts.theirs[theirs[i]]++;
      if (c || theirs[i]) counts.either++;
      if (c !== theirs[i]) counts.differ++;
    });
    return counts;
  });
}

for (const [scene, yaw, pitch] of VIEWS) {
  browserTest(`the page and mp render draw the same scene: ${scene}`, (t) => withFolder((folder) => withPage(scene, async (driver) => {
    await driver.choose("Colours", "light");
    await driver.page.evaluate(([width, height]) => {
      Object.assign(document.getElementById("canvas").style, { position: "fixed", width: `${width}px`, height: `${height}px` });
    }, [WIDTH, HEIGHT]);
    await driver.until(([width, height]) => {
      const canvas = document.getElementById("canvas");
      return canvas.width === width && canvas.height === height;
    }, [WIDTH, HEIGHT]);
    const { eye, target, fov } = await driver.page.evaluate(async ([y, p]) => {
      const { camera } = (await window.mpView.planner).viewer;
      Object.assign(camera, { yaw: y, pitch: p });
      camera.fit();
      return { eye: camera.eye(), target: camera.target, fov: (360 / Math.PI) * Math.atan((camera.pixel() * camera.height) / (2 * camera.distance)) };
    }, [yaw, pitch]);
    const file = join(folder, "picture.png");
    mp("render", scene, "--size", `${WIDTH}x${HEIGHT}`, "--camera", `eye=${eye} target=${target} fov=${fov}`, "--out", file);
    const counts = await driver.page.evaluate(compared, [readFileSync(file).toString("base64"), WIDTH, HEIGHT]);
    t.diagnostic(`${((100 * counts.differ) / counts.all).toFixed(2)}% of the pixels differ, ${((100 * counts.differ) / counts.either).toFixed(2)}% of those with a body; ${counts.ours} and ${counts.theirs} of nothing, obstacle, start, goal`);
    assert.ok(Math.min(...counts.ours) > 300, `of each there is something to compare: ${counts.ours}`);
    assert.ok(counts.differ < MOST * counts.either, `${counts.differ} of ${counts.either} pixels with a body differ`);
    // Start and goal are small: a wrong place of theirs would not show in all pixels.
    for (const c of [2, 3]) assert.ok(Math.abs(counts.ours[c] - counts.theirs[c]) < 0.25 * counts.theirs[c], `${counts.ours} ${counts.theirs}`);
  })));
}
