// Start and goals: checks one at a time, and only the last of several questions about one end.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Ends } from "mp/ends.js";
import { emptyScene } from "mp/scene.js";

/** A session that keeps its questions until they are answered. */
function waitingSession() {
  const asked = [];
  return { asked, request: ({ row }) => new Promise((resolve, reject) => asked.push({ row, resolve, reject })) };
}

const configuration = (...row) => ({ row, poses: [0, 0, 0, 0, 0, 0, 1] });
const verdict = (free, x) => ({ free, in_bounds: true, clearance: 0, touching: [], fault: null, nearest_free: null, poses: [x, 0, 0, 0, 0, 0, 1] });
const settle = () => new Promise((resolve) => setImmediate(resolve));

function ends() {
  const session = waitingSession();
  const it = new Ends(session);
  const scene = { ...emptyScene(), robot: 1, start: configuration(0), goals: [configuration(9)] };
  it.show(scene);
  return { it, session, scene };
}

test("one check is in flight, and the last row wins", async () => {
  const { it, session } = ends();
  for (const x of [1, 2, 3]) it.set("start", [x], { settled: false });
  assert.deepEqual(session.asked.map((q) => q.row), [[1]]);
  session.asked[0].resolve(verdict(true, 1));
  await settle();
  assert.deepEqual(session.asked.map((q) => q.row), [[1], [3]]);
  // The answer about a row of before shows where the robot was, but is no verdict about this one.
  assert.equal(it.at("start").poses[0], 1);
  assert.equal(it.verdicts.has("start"), false);
  session.asked[1].resolve(verdict(false, 3));
  await settle();
  assert.equal(it.verdicts.get("start").free, false);
  assert.equal(it.at("start").refused, true);
  assert.equal(session.asked.length, 2);
});

test("poses that came with the row are not replaced by older ones", async () => {
  const { it, session } = ends();
  it.set(0, [1], { poses: [1, 0, 0, 0, 0, 0, 1] });
  it.set(0, [2], { poses: [2, 0, 0, 0, 0, 0, 1] });
  session.asked[0].resolve(verdict(true, 1));
  await settle();
  assert.equal(it.at(0).poses[0], 2);
});

test("a run gets the ends that were moved", () => {
  const { it } = ends();
  assert.deepEqual(it.request(), { start: null, goals: null });
  it.set("start", [1]);
  assert.deepEqual(it.request(), { start: [1], goals: null });
  it.set(0, [5]);
  assert.deepEqual(it.request(), { start: [1], goals: [[5]] });
});

test("an answer about a scene of before changes nothing", async () => {
  const { it, session, scene } = ends();
  it.set("start", [1]);
  it.show({ ...scene, start: configuration(7) });
  session.asked[0].resolve(verdict(false, 1));
  await settle();
  assert.equal(it.at("start").poses[0], 0);
  assert.equal(it.verdicts.size, 0);
  assert.deepEqual(it.request(), { start: null, goals: null });
});

test("an end that cannot be checked has its error, and the next check goes on", async () => {
  const { it, session } = ends();
  it.set("start", [1]);
  it.set(0, [2]);
  session.asked[0].reject(new Error("gone"));
  await settle();
  assert.equal(it.errors.get("start").message, "gone");
  assert.deepEqual(session.asked[1].row, [2]);
});
