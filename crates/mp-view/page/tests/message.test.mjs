// Messages: written and read, and broken on purpose.

import assert from "node:assert/strict";
import { test } from "node:test";
import { decode, encode } from "mp/message.js";

const message = () => ({
  do: "open",
  files: [{ name: "bench.txt", bytes: new Uint8Array([1, 2, 3]) }, { name: "ü", bytes: new Uint8Array(0) }],
  rows: [[1, 2], [3, 4]],
  trees: [{ nodes: new Float32Array([1.5, -2, 3]), parents: new Int32Array([-1]), survivors: new Uint32Array([7]) }],
  exact: new Float64Array([Math.PI]),
  nothing: null,
});

test("a message is read back as it was written", () => {
  assert.deepEqual(decode(encode(message())), message());
});

test("it is laid out as the format says", () => {
  const bytes = encode({ a: new Float32Array([1]), b: new Uint8Array([9]) });
  const size = new DataView(bytes.buffer).getUint32(4, true);
  assert.equal(String.fromCharCode(...bytes.subarray(0, 4)), "MPV1");
  assert.equal(size % 8, 0);
  const head = JSON.parse(new TextDecoder().decode(bytes.subarray(8, 8 + size)));
  assert.deepEqual(head, { a: { type: "f32", offset: 0, count: 1 }, b: { type: "u8", offset: 8, count: 1 } });
  assert.equal(bytes[8 + size + 8], 9);
});

test("it is read at any place in memory", () => {
  const bytes = encode(message());
  for (const shift of [1, 4, 8]) {
    const moved = new Uint8Array(bytes.length + shift);
    moved.set(bytes, shift);
    assert.deepEqual(decode(moved.subarray(shift)), message());
  }
});

test("long seeds keep all their digits", () => {
  const text = new TextEncoder().encode('{"report":{"seed":18446744073709551615}}'.padEnd(48));
  const bytes = new Uint8Array(8 + text.length);
  bytes.set([77, 80, 86, 49, text.length]);
  bytes.set(text, 8);
  assert.equal(decode(bytes).report.seed, "18446744073709551615");
});

test("what is no message is refused with a sentence", () => {
  const good = encode(message());
  const edited = (change) => {
    const bytes = good.slice();
    change(bytes);
    return bytes;
  };
  const withHead = (text) => {
    const head = new TextEncoder().encode(text.padEnd(Math.ceil(text.length / 8) * 8));
    const bytes = new Uint8Array(8 + head.length);
    bytes.set([77, 80, 86, 49, head.length]);
    bytes.set(head, 8);
    return bytes;
  };
  for (const [bytes, says] of [
    [new Uint8Array(3), /begin with MPV1/],
    [edited((b) => (b[0] = 0)), /begin with MPV1/],
    [edited((b) => (b[3] = 50)), /version 1.*MPV2/],
    [edited((b) => (b[4] += 1)), /multiple of 8/],
    [good.subarray(0, 40), /head reaches beyond/],
    [good.subarray(0, good.length - 9), /reaches beyond its end/],
    [withHead("[1]"), /not an object/],
    [withHead("{no"), /not JSON/],
    [withHead('{"a":{"type":"f32","offset":4,"count":0}}'), /not possible/],
    [withHead('{"a":{"type":"f32","offset":0,"count":-1}}'), /not possible/],
    [withHead('{"a":{"type":"f64","offset":0,"count":1e300}}'), /not possible|beyond/],
  ]) assert.throws(() => decode(bytes, "message"), says);
});

test("values that only look like arrays stay", () => {
  const head = { a: { type: "sphere", offset: 1, count: 2 }, b: { type: "f32" }, c: { type: "constructor", offset: 0, count: 0 } };
  assert.deepEqual(decode(encode(head)), head);
});
