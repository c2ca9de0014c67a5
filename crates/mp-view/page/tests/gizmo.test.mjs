// The mathematics of the handles, compared with formulas that do not come from it.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Camera } from "mp/camera.js";
import * as g from "mp/gizmo.js";
import { add, dot, place, rotate, scale } from "mp/math.js";

const near = (a, b, tolerance = 1e-9) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) <= tolerance, `${a} and ${b}`));

/** R = Rz(α)·Ry(β)·Rx(γ), written out. */
function matrix(a, b, c) {
  const [ca, sa, cb, sb, cc, sc] = [Math.cos(a), Math.sin(a), Math.cos(b), Math.sin(b), Math.cos(c), Math.sin(c)];
  return [
    [ca * cb, ca * sb * sc - sa * cc, ca * sb * cc + sa * sc],
    [sa * cb, sa * sb * sc + ca * cc, sa * sb * cc - ca * sc],
    [-sb, cb * sc, cb * cc],
  ];
}
const times = (m, v) => m.map((row) => dot(row, v));

const ANGLES = [];
for (const a of [-3, -1.2, 0, 0.7, 2.9]) for (const b of [-Math.PI / 2, -1, 0, 0.4, 1.5, Math.PI / 2]) for (const c of [-2.8, 0, 0.3, 1.9]) ANGLES.push([a, b, c]);

test("angles make the rotation of the file format", () => {
  for (const [a, b, c] of ANGLES) for (const axis of g.AXES) near(rotate(g.fromAngles(a, b, c), 0, axis), times(matrix(a, b, c), axis));
});

test("angles of a rotation give the same rotation, also where β is ±90°", () => {
  for (const angles of ANGLES) {
    const q = g.fromAngles(...angles);
    for (const axis of g.AXES) near(rotate(g.fromAngles(...g.toAngles(q)), 0, axis), rotate(q, 0, axis), 1e-7);
  }
  near(g.toAngles(g.fromAngles(0.3, -0.4, 2)), [0.3, -0.4, 2]);
});

test("a change moves six numbers and poses alike", () => {
  const six = [1, 2, 3, 0.3, -0.4, 2];
  const change = { ...g.NO_CHANGE, shift: [0.5, 0, -1], turn: g.turnAbout([0, 0, 1], 1.1) };
  const changed = g.changedSix(six, change);
  const pose = g.changedPose(g.poseOfSix(six), 0, [1, 2, 3], change);
  for (const p of [[0, 0, 0], [1, 0, 0], [0.2, -3, 1]]) near(place(g.poseOfSix(changed), 0, p), place(pose, 0, p));
  near(changed, [1.5, 2, 2, 1.4, -0.4, 2]);
  // Angles that do not turn stay as they are written, beyond a full turn too.
  near(g.changedSix([0, 0, 0, 9, 4, -7], { ...g.NO_CHANGE, shift: [1, 0, 0] }), [1, 0, 0, 9, 4, -7], 0);
});

test("a pose turns about the point that is given", () => {
  const pose = g.changedPose([2, 0, 0, 0, 0, 0, 1], 0, [1, 0, 0], { ...g.NO_CHANGE, turn: g.turnAbout([0, 0, 1], Math.PI / 2) });
  near(place(pose, 0, [0, 0, 0]), [1, 1, 0]);
  near(place(pose, 0, [1, 0, 0]), [1, 2, 0]);
});

/** A camera as the page has it: 800 × 600 pixels. */
function camera(view, perspective = true) {
  const made = new Camera([[-5, -5, -5], [5, 5, 5]]);
  Object.assign(made, { width: 800, height: 600, perspective });
  made.look(view);
  made.fit();
  return made;
}

/** Drags a handle from the pixel of a point of the world to that of another. */
function drag(view, { mode, axis, from, to, frame = { origin: [1, 2, 0.5], turn: [0, 0, 0, 1] }, planar = false, snap = 0, perspective = true }) {
  const made = camera(view, perspective);
  const { both } = made.matrices();
  const project = (p) => made.project(both, p);
  const handle = g.handlesOf(mode, frame, 2, planar).find((h) => h.axis === axis);
  const [first, last] = [project(from), project(to)];
  const taken = new g.Drag(handle, frame, made.ray(...first), first, project, made.axes().back, planar);
  return { change: taken.to(made.ray(...last), last, snap), handle, project, first };
}

test("an arrow follows the pointer along its axis, in every view", () => {
  for (const perspective of [true, false]) {
    for (const view of ["iso", "front", "top", "left"]) {
      for (const axis of [0, 1, 2]) {
        const along = g.AXES[axis];
        if (Math.abs(dot(along, camera(view).axes().back)) > 0.99) continue;
        const from = add([1, 2, 0.5], along);
        const { change } = drag(view, { mode: "move", axis, from, to: add(from, scale(along, 1.7)), perspective });
        near(change.shift, scale(along, 1.7), 1e-5);
      }
    }
  }
});

test("an arrow that points at the viewer does nothing", () => {
  const { change } = drag("top", { mode: "move", axis: 2, from: [1, 2, 1], to: [1.3, 2, 1], frame: { origin: [0, 0, 0], turn: [0, 0, 0, 1] }, perspective: false });
  near(change.shift, [0, 0, 0]);
});

test("the middle moves along the screen, in the plane along x and y", () => {
  const { change } = drag("front", { mode: "move", axis: 3, from: [1, 2, 0.5], to: [2, 2, 1.5] });
  near(change.shift, [1, 0, 1], 1e-5);
  const flat = drag("top", { mode: "move", axis: 3, from: [1, 2, 0.5], to: [3, -1, 0.5], planar: true });
  near(flat.change.shift, [2, -3, 0], 1e-5);
});

test("a ring follows the pointer around", () => {
  const origin = [1, 2, 0.5];
  const on = (angle) => add(origin, [2 * Math.cos(angle), 2 * Math.sin(angle), 0]);
  for (const angle of [0.3, 1.2, -2]) {
    const { change } = drag("iso", { mode: "turn", axis: 2, from: on(0.2), to: on(0.2 + angle) });
    const [z, w] = [Math.sin(angle / 2), Math.cos(angle / 2)];
    const sign = Math.sign(change.turn[3] * w);
    near(change.turn, [0, 0, sign * z, sign * w], 1e-5);
  }
});

test("a ring seen from its edge turns by the way on the screen", () => {
  // From the front the ring about z is a line. Its nearest point moves to the right when it turns forwards.
  const { change, project, first } = drag("front", { mode: "turn", axis: 2, from: [1, 0, 0.5], to: [1.2, 0, 0.5], perspective: false });
  const pixels = project([1.2, 0, 0.5])[0] - first[0];
  assert.ok(pixels > 1);
  near(change.turn, g.turnAbout([0, 0, 1], 0.1), 2e-3);
});

test("a scale cube goes along the body's own axis", () => {
  const turn = g.turnAbout([0, 0, 1], Math.PI / 2);
  const frame = { origin: [0, 0, 0], turn };
  const { change } = drag("top", { mode: "scale", axis: 0, from: [0, 2, 0], to: [0, 3, 0], frame });
  near(change.factor, [1.5, 1, 1], 1e-5);
  // Through the centre and beyond: a body never turns inside out.
  const small = drag("top", { mode: "scale", axis: 0, from: [0, 2, 0], to: [0, -3, 0], frame });
  assert.ok(small.change.factor[0] > 0 && small.change.factor[0] < 0.1);
  const all = drag("top", { mode: "scale", axis: 3, from: [0, 0, 0], to: [1, 0, 0], frame });
  assert.ok(all.change.factor[0] > 1 && all.change.factor[0] === all.change.factor[1] && all.change.factor[1] === all.change.factor[2]);
});

test("with Shift, places, angles and factors snap", () => {
  const moved = drag("front", { mode: "move", axis: 0, from: [2, 2, 0.5], to: [3.63, 2, 0.5], snap: 0.25, frame: { origin: [1.1, 2, 0.5], turn: [0, 0, 0, 1] } });
  near([1.1 + moved.change.shift[0], moved.change.shift[1], moved.change.shift[2]], [2.75, 0, 0]);
  const on = (angle) => add([1, 2, 0.5], [2 * Math.cos(angle), 2 * Math.sin(angle), 0]);
  const turned = drag("top", { mode: "turn", axis: 2, from: on(0), to: on(0.6), snap: 1 });
  near(turned.change.turn, g.turnAbout([0, 0, 1], Math.PI / 6));
  const scaled = drag("front", { mode: "scale", axis: 0, from: [2, 0, 0], to: [2.47, 0, 0], snap: 1, frame: { origin: [0, 0, 0], turn: [0, 0, 0, 1] } });
  near(scaled.change.factor, [1.2, 1, 1]);
});

test("steps to snap to are 1, 2 or 5 times a power of ten", () => {
  for (const pixel of [1e-4, 0.003, 0.02, 0.7, 12]) {
    const step = g.niceStep(pixel);
    assert.ok(step >= 12 * pixel * (1 - 1e-9) && step <= 30.1 * pixel, `${step} for ${pixel}`);
    assert.match(step.toExponential(), /^[125]e/);
  }
});

test("a pixel finds the nearest handle; fingers need less care", () => {
  const made = camera("iso");
  const { both } = made.matrices();
  const project = (p) => made.project(both, p);
  const handles = g.handlesOf("move", { origin: [0, 0, 0], turn: [0, 0, 0, 1] }, 2, false);
  for (const axis of [0, 1, 2]) {
    const [x, y] = project(scale(g.AXES[axis], 1.8));
    assert.equal(g.handleAt(handles, project, [x, y])?.axis, axis);
  }
  assert.equal(g.handleAt(handles, project, project([0, 0, 0]))?.axis, 3);
  const [x, y] = project([0, 0, 2]);
  assert.equal(g.handleAt(handles, project, [x, y - 15]), null);
  assert.equal(g.handleAt(handles, project, [x, y - 15], true)?.axis, 2);
});

test("in the plane there are x, y and the ring about z", () => {
  const axes = (mode) => g.handlesOf(mode, { origin: [0, 0, 0], turn: [0, 0, 0, 1] }, 1, true).map((h) => h.axis);
  assert.deepEqual(axes("move"), [0, 1, 3]);
  assert.deepEqual(axes("turn"), [2]);
});

test("words say the place, the angle and the factor", () => {
  const words = (mode, axis, change, point = [1.25, 2, 3]) => g.changeWords({ ...g.NO_CHANGE, ...change }, { mode, axis, points: [] }, point);
  assert.equal(words("move", 0, {}), "x 1.25 m");
  assert.equal(words("move", 3, {}), "1.25, 2, 3 m");
  assert.equal(words("turn", 2, { turn: g.turnAbout([0, 0, 1], -Math.PI / 4) }), "-45° about z");
  assert.equal(words("turn", 0, { turn: g.turnAbout([1, 0, 0], 1.5 * Math.PI) }), "-90° about x");
  assert.equal(words("scale", 1, { factor: [1, 2.5, 1] }), "× 2.5");
});
