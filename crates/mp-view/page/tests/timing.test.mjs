// Trajectories: what their plots show.

import assert from "node:assert/strict";
import { test } from "node:test";
import { endsOf, numbersOf } from "mp/jointplots.js";

test("plots have room for limits that are near, and for those of velocities always", () => {
  const [low, high] = endsOf([0, 1], [-9, 1.5], false);
  assert.ok(low < 0 && low > -1 && high > 1.5 && high < 2, `${low} ${high}`);
  assert.ok(endsOf([0, 1], [-9, 9], true)[0] < -9);
  const [least, most] = endsOf([2, 2], null, false);
  assert.ok(least < 2 && most > 2);
});

test("numbers are those of the joint", () => {
  const trajectory = { velocities: Float64Array.from([0, 1, 2, 3]), accelerations: Float64Array.from([4, 5, 6, 7]) };
  const path = { rows: Float64Array.from([8, 9, 10, 11]), count: 2, trajectory };
  assert.deepEqual([0, 1, 2].map((order) => numbersOf(path, 1, order)), [[9, 11], [1, 3], [5, 7]]);
});
