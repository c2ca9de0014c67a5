// A page that shows what a program sends: here this test is the program, as a script of Python is with `scene.view()`.

import assert from "node:assert/strict";
import { once } from "node:events";
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { join } from "node:path";
import { decode, encode } from "mp/message.js";
import { browserTest, mp, newPage, withFolder } from "./browser.mjs";

/** The frame of a message. @param {Uint8Array} bytes */
function framed(bytes) {
  const length = Buffer.alloc(4);
  length.writeUInt32LE(bytes.length);
  return Buffer.concat([length, bytes]);
}

/** What the page shows: the scene, the names of its paths, and which of them is chosen. @param {import("puppeteer-core").Page} page */
const shown = (page) => page.evaluate(async () => {
  await window.mpView.ready;
  const text = (selector) => document.querySelector(selector)?.textContent ?? "";
  const all = [...document.querySelectorAll("ul.paths li")];
  const names = all.map((row) => row.querySelector("span").firstChild.textContent);
  const chosen = names[all.findIndex((row) => row.querySelector("input").checked)] ?? "";
  return { scene: text("#title"), names, chosen, timeline: text("#timeline output.count"), hint: text("#hint"), alert: text("#alert") };
});

/** Waits until the page shows this. @param {import("puppeteer-core").Page} page @param {Partial<Awaited<ReturnType<typeof shown>>>} wanted texts that begin or are in it */
async function until(page, wanted) {
  let found;
  for (let i = 0; i < 200; i++) {
    found = await shown(page);
    if (Object.entries(wanted).every(([name, part]) => found[name]?.includes(part))) return found;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  return assert.fail(`${JSON.stringify(wanted)} is not in ${JSON.stringify(found)}`);
}

browserTest("a page shows the scenes and paths that a program sends", () => withFolder(async (folder) => {
  const file = (name) => join(folder, name);
  mp("plan", "easy", "--seed", "1", "--out", file("path.csv"), "--picture", file("path.png"));
  mp("render", "easy", "--out", file("page.html"));
  for (const scene of ["easy", "cubicles"]) mp("render", scene, ...(scene === "easy" ? [file("path.csv")] : []), "--out", file(`${scene}.mpv`));
  const page = readFileSync(file("page.html"), "utf8").replace("</head>", '<meta name="mp-session" content="shown"></head>');
  const { paths: [path] } = decode(readFileSync(file("easy.mpv")));
  // The first configuration alone.
  const one = (array, width) => array.subarray(0, width);
  const robot = path.poses.length / (path.trace.length / 3);
  const columns = path.rows.length / (path.trace.length / 3);
  const first = { name: "configuration", verified: false, length: 0, rows: one(path.rows, columns), poses: one(path.poses, robot), trace: one(path.trace, 3) };

  let stream = null;
  const server = createServer((request, response) => {
    if (request.url !== "/shown") return response.end(page);
    response.writeHead(200, { "Content-Type": "application/octet-stream" });
    response.flushHeaders();
    stream = response;
    server.emit("opened");
  }).listen(0, "127.0.0.1");
  await once(server, "listening");
  const opened = once(server, "opened");
  const tab = await newPage();
  try {
    await tab.page.goto(`http://127.0.0.1:${server.address().port}/`);
    await opened;
    await until(tab.page, { scene: "easy" });
    stream.write(framed(encode({ path: { ...path, name: "found" } })));
    await until(tab.page, { chosen: "found", timeline: `of ${path.trace.length / 3}` });
    // Nothing is sent from time to time, to learn whether the page is there.
    stream.write(framed(new Uint8Array(0)));
    stream.write(framed(encode({ path: first })));
    await until(tab.page, { chosen: "configuration", timeline: "1 of 1" });
    // Under the same name: in its place.
    stream.write(framed(encode({ path: { ...path, name: "configuration" } })));
    const last = await until(tab.page, { timeline: `of ${path.trace.length / 3}` });
    assert.deepEqual([last.names, last.chosen], [["found", "configuration"], "configuration"]);
    // What cannot be shown is said, and is not the end.
    stream.write(framed(encode({ path: { ...first, poses: new Float32Array(0) } })));
    await until(tab.page, { alert: "do not have the same number of configurations" });
    stream.write(framed(readFileSync(file("cubicles.mpv"))));
    await until(tab.page, { scene: "cubicles" });
    assert.deepEqual(tab.faults, []);
    stream.end();
    await until(tab.page, { scene: "cubicles", hint: "has ended" });
    assert.deepEqual(tab.faults, []);
  } finally {
    await tab.context.close();
    server.closeAllConnections();
    server.close();
  }
}));
