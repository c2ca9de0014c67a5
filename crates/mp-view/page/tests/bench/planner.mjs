// How long planning takes in a page, against the program: node tests/bench/planner.mjs MP PAGE.html SCENE …
// PAGE.html is made by `mp render SCENE --out PAGE.html --with-planner`; one page for each scene.

import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { unlzma } from "../../lzma.js";

const RUNS = 9;
const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

/** A part of a page by its id, unpacked. */
const part = (html, id) => unlzma(Buffer.from(html.match(new RegExp(`id="${id}"[^>]*>([^<]*)<`))[1], "base64"));

/** The bytes of a message without arrays. */
function message(head) {
  const json = Buffer.from(JSON.stringify(head));
  const padded = Buffer.concat([json, Buffer.alloc((8 - (json.length % 8)) % 8, 32)]);
  const begin = Buffer.alloc(8);
  begin.write("MPV1");
  begin.writeUInt32LE(padded.length, 4);
  return Buffer.concat([begin, padded]);
}

/** The reports of some runs in the module of a page. */
async function inPage(file, seeds) {
  const html = readFileSync(file, "latin1");
  const { instance } = await WebAssembly.instantiate(part(html, "planner"), { env: { now: () => performance.now() } });
  const { memory, reserve, send, advance, take, taken } = instance.exports;
  const next = () => {
    const length = take();
    if (!length) return null;
    const bytes = Buffer.from(memory.buffer, taken() >>> 0, length);
    return JSON.parse(bytes.subarray(8, 8 + bytes.readUInt32LE(4)).toString());
  };
  const ask = (bytes) => {
    const address = reserve(bytes.length) >>> 0;
    new Uint8Array(memory.buffer, address, bytes.length).set(bytes);
    send(bytes.length);
    const reply = next();
    if (reply.error) throw new Error(reply.error.message);
  };
  ask(part(html, "open"));
  return seeds.map((seed, run) => {
    ask(message({ do: "plan", run, request: { planner: "rrt-connect", seed } }));
    while (advance(15));
    let report;
    for (let event = next(); event; event = next()) report = event.report ?? report;
    return report;
  });
}

const [program, ...rest] = process.argv.slice(2);
console.log("| scene | program, ms | page, first run, ms | page, ms | ratio | largest difference of two numbers of the paths |");
console.log("|---|---|---|---|---|---|");
for (let i = 0; i + 1 < rest.length; i += 2) {
  const [file, scene] = rest.slice(i, i + 2);
  const reports = await inPage(file, Array(RUNS + 1).fill(1));
  const native = JSON.parse(execFileSync(program, ["plan", scene, "--planner", "rrt-connect", "--seed", "1", "--json"], { stdio: ["ignore", "pipe", "ignore"], cwd: tmpdir() }));
  const times = Array.from({ length: RUNS }, () => JSON.parse(execFileSync(program, ["plan", scene, "--planner", "rrt-connect", "--seed", "1", "--json"], { stdio: ["ignore", "pipe", "ignore"], cwd: tmpdir() })).time_s);
  const path = reports[0].path;
  const same = native.path.length === path.length && native.iterations === reports[0].iterations && native.collision_checks === reports[0].collision_checks;
  const off = same ? Math.max(...path.flatMap((row, r) => row.map((x, k) => Math.abs(x - native.path[r][k])))) : Infinity;
  const [first, ...later] = reports.map((report) => 1e3 * report.time_s);
  const own = 1e3 * median(times);
  console.log(`| ${scene} | ${own.toFixed(1)} | ${first.toFixed(0)} | ${median(later).toFixed(1)} | ${(median(later) / own).toFixed(1)} | ${off.toExponential(0)} |`);
}
