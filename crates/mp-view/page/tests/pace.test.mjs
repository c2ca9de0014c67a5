import assert from "node:assert/strict";
import { test } from "node:test";
import { Pace } from "mp/pace.js";

test("while the view moves, as many lines are drawn as a frame has time for", () => {
  const pace = new Pace();
  // Nothing has moved: all of them.
  pace.took(1, 1000);
  assert.equal(pace.share, 1);
  pace.took(1, 10);
  // What a frame takes where software draws: bodies, and a roadmap of 340,000 edges.
  const frame = (lines) => 40 + 330 * lines;
  pace.moved(() => {});
  assert.equal(pace.share, 1);
  let slow = 0;
  for (let i = 0; i < 20; i++) {
    if (frame(pace.share) > 100) slow++;
    pace.took(pace.share, frame(pace.share));
  }
  assert.ok(slow <= 2 && frame(pace.share) < 90 && pace.share > 0.08, `${slow} ${pace.share}`);
  // When it is faster again, all come back.
  for (let i = 0; i < 3; i++) pace.took(pace.share, 15);
  assert.equal(pace.share, 1);
  clearTimeout(pace.timer);
});

test("all lines are drawn when the view is still", async () => {
  const pace = new Pace();
  const still = new Promise((resolve) => pace.moved(() => resolve("still")));
  pace.took(1, 1000);
  assert.ok(pace.share < 0.1);
  assert.equal(await still, "still");
  assert.equal(pace.share, 1);
});
