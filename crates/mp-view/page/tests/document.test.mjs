// The document's commands and its history.

import assert from "node:assert/strict";
import { test } from "node:test";
import * as d from "mp/document.js";

const empty = d.emptyDocument();
/** Freezes everything, so that a command that changes its document fails. */
const frozen = (value) => {
  if (value && typeof value === "object") Object.values(Object.freeze(value)).forEach(frozen);
  return value;
};
const room = frozen(d.addObstacle(d.addObstacle(empty, "cube", d.FIGURES.cube, [1, 2, 3, 0.1, 0.2, 0.3]), "cube", d.FIGURES.sphere, [0, 0, 5, 0, 0, 0]));

test("commands leave their document as it is, and change what they say", () => {
  const moved = d.movePart(room, 1, [9, 9, 9, 0, 0, 0]);
  assert.deepEqual(moved.obstacles[1].pose, [9, 9, 9, 0, 0, 0]);
  assert.equal(moved.obstacles[0], room.obstacles[0]);
  assert.deepEqual(d.movePart(room, "goal", [1, 2, 3, 4, 5, 6]).goal, [1, 2, 3, 4, 5, 6]);
  assert.equal(d.changeBody(room, "goal", { color: "#ff0000" }).robot.color, "#ff0000");
  assert.equal(d.changeBody(room, 0, { name: "box" }).obstacles[0].name, "box");
  assert.deepEqual(d.removeObstacle(room, 0).obstacles, [room.obstacles[1]]);
  const copy = d.duplicate(d.scalePart(room, 0, [1, 2, 1]), 0, [1, 0, 0]).obstacles[2];
  assert.deepEqual(copy, { name: "cube 3", color: null, shape: d.FIGURES.cube, scale: [1, 2, 1], pose: [2, 2, 3, 0.1, 0.2, 0.3] });
  assert.equal(d.duplicate(room, "start", [0, 0, 0]).obstacles[2].shape, room.robot.shape);
});

test("a scale of one is left out", () => {
  const scaled = d.scalePart(room, "start", [2, 2, 2]);
  assert.deepEqual(d.scaleOf(scaled.robot), [2, 2, 2]);
  assert.equal(JSON.stringify(d.scalePart(scaled, "goal", [1, 1, 1])), JSON.stringify(room));
});

test("names are not given twice", () => {
  assert.deepEqual(room.obstacles.map((o) => o.name), ["cube", "cube 2"]);
  assert.equal(d.freeName(room, "robot"), "robot 2");
  assert.equal(d.replaceRobot(room, "robot", d.FIGURES.cone).robot.name, "robot");
  assert.equal(d.replaceRobot(room, "cube", d.FIGURES.cone).robot.name, "cube 3");
});

test("every figure has sizes that can be set", () => {
  for (const [kind, figure] of Object.entries(d.FIGURES)) {
    assert.equal(d.shapeKind(figure), kind);
    const sizes = d.sizesOf(figure);
    assert.ok(sizes.length > 0);
    sizes.forEach((size, i) => {
      const values = d.sizesOf(size.set(7)).map((s) => s.value);
      assert.deepEqual(values, sizes.map((s, k) => (k === i ? 7 : s.value)), kind);
    });
  }
  assert.deepEqual(d.sizesOf({ mesh: { file: "bench.txt" } }), []);
});

test("the reach of a figure is that of its farthest point", () => {
  const reaches = Object.values(d.FIGURES).map((figure) => d.reachOf(figure).toFixed(3));
  assert.deepEqual(reaches, ["1.000", "1.414", "1.732", "1.414", "1.300", "1.225"]);
});

test("in the plane, start and goal have no z, β and γ", () => {
  const tilted = { ...room, start: [1, 2, 3, 0.4, 0.5, 0.6], bounds: [[-5, -6, -7], [5, 6, 7]] };
  const flat = d.setSpace(tilted, "SE2");
  assert.deepEqual(flat.start, [1, 2, 0, 0.4, 0, 0]);
  assert.deepEqual(flat.bounds, [[-5, -6, 0], [5, 6, 0]]);
  assert.deepEqual(flat.obstacles, room.obstacles);
  assert.deepEqual(d.movePart(flat, "goal", [1, 2, 3, 4, 5, 6]).goal, [1, 2, 0, 4, 0, 0]);
  assert.deepEqual(d.setSpace(flat, "SE3").bounds, [[-5, -6, -6], [5, 6, 6]]);
  assert.equal(d.setSpace(flat, "SE2"), flat);
});

test("undo and redo give back the very documents", () => {
  const history = new d.History(empty);
  const steps = [empty];
  for (let i = 0; i < 5; i++) {
    steps.push(d.addObstacle(history.document, "cube", d.FIGURES.cube, [i, 0, 0, 0, 0, 0]));
    history.commit(steps[i + 1], `add ${i}`);
  }
  assert.deepEqual([history.undoLabel, history.redoLabel], ["add 4", null]);
  for (let i = 4; i >= 0; i--) {
    assert.equal(history.before, steps[i]);
    history.undo();
    assert.equal(history.document, steps[i]);
    assert.equal(history.after, steps[i + 1]);
  }
  history.undo();
  assert.deepEqual([history.undoLabel, history.before, history.redoLabel], [null, null, "add 0"]);
  for (let i = 1; i <= 5; i++) {
    history.redo();
    assert.equal(history.document, steps[i]);
  }
  history.redo();
  assert.equal(history.document, steps[5]);
  // A command after an undo forgets what was undone.
  history.undo();
  history.commit(room, "room");
  assert.equal(history.redoLabel, null);
  history.undo();
  assert.equal(history.document, steps[4]);
});

test("moves by one slider are one step", () => {
  const history = new d.History(room);
  const at = (x) => d.movePart(room, "goal", [x, 0, 0, 0, 0, 0]);
  history.commit(at(1), "move", "goal");
  history.commit(at(2), "move", "goal");
  assert.equal(history.before, room);
  history.commit(d.movePart(at(2), "start", [1, 0, 0, 0, 0, 0]), "move", "start");
  history.commit(at(3), "move", "goal");
  history.undo();
  history.undo();
  assert.deepEqual(history.document.goal, [2, 0, 0, 0, 0, 0]);
  history.undo();
  assert.equal(history.document, room);
});

test("what was saved is not unsaved, also after undo and redo", () => {
  const history = new d.History(empty);
  assert.equal(history.dirty, false);
  history.commit(room, "room");
  assert.equal(history.dirty, true);
  history.markSaved(room);
  assert.equal(history.dirty, false);
  history.undo();
  assert.equal(history.dirty, true);
  history.redo();
  assert.equal(history.dirty, false);
  // A step that was saved is kept, even when the next one could join it.
  history.commit(d.movePart(room, "goal", [1, 0, 0, 0, 0, 0]), "move", "goal");
  history.markSaved(history.document);
  history.commit(d.movePart(room, "goal", [2, 0, 0, 0, 0, 0]), "move", "goal");
  history.undo();
  assert.equal(history.dirty, false);
});

test("a long history forgets its oldest steps only", () => {
  const history = new d.History(empty);
  for (let i = 0; i < 500; i++) history.commit({ ...empty, name: String(i) }, "rename");
  assert.equal(history.document.name, "499");
  let count = 0;
  for (; history.before; count++) history.undo();
  assert.ok(count >= 100 && count < 500);
  assert.equal(history.document.name, String(499 - count));
});
