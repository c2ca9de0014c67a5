// @ts-check
// Unpacks the planner: the format of `.lzma` files, a third smaller than what browsers unpack themselves.

/** The bytes of a `.lzma` file, whose header has their number. It becomes the text of a worker, so it uses nothing from outside.
 * @param {Uint8Array} packed @returns {Uint8Array<ArrayBuffer>} */
export function unlzma(packed) {
  const head = new DataView(packed.buffer, packed.byteOffset, 18);
  const [context, low, places] = [packed[0] % 9, Math.floor(packed[0] / 9) % 5, Math.floor(packed[0] / 45)];
  const size = head.getUint32(5, true);
  if (places > 4 || head.getUint32(9, true) || packed[13]) throw new Error("the planner in this page is damaged");
  const out = new Uint8Array(size);
  // The range of the decoder and the place in it: as an array, they stay whole numbers of 32 bits.
  const [RANGE, CODE] = [0, 1];
  const coder = Uint32Array.of(0xffffffff, head.getUint32(14));
  let from = 18;
  // The probabilities, one kind after the other.
  const [MATCH, REP, REP0, REP1, REP2, LONG, SLOT, NEAR, ALIGN, LENGTH, AGAIN, LITERAL] = [0, 192, 204, 216, 228, 240, 432, 688, 816, 832, 1346, 1860];
  const likely = new Uint16Array(LITERAL + (0x300 << (context + low))).fill(1024);
  const shift = () => {
    if (coder[RANGE] >= 0x1000000) return;
    coder[RANGE] <<= 8;
    coder[CODE] = (coder[CODE] << 8) | packed[from++];
  };
  const bit = (/** @type {number} */ at) => {
    const zero = likely[at];
    const bound = (coder[RANGE] >>> 11) * zero;
    const one = coder[CODE] >= bound;
    if (one) {
      coder[RANGE] -= bound;
      coder[CODE] -= bound;
      likely[at] = zero - (zero >> 5);
    } else {
      coder[RANGE] = bound;
      likely[at] = zero + ((2048 - zero) >> 5);
    }
    shift();
    return one ? 1 : 0;
  };
  /** A number of so many bits, the highest first. @param {number} at @param {number} bits */
  const tree = (at, bits) => {
    let m = 1;
    for (let i = 0; i < bits; i++) m = 2 * m + bit(at + m);
    return m - (1 << bits);
  };
  /** The lowest first. @param {number} at @param {number} bits */
  const reverse = (at, bits) => {
    let [m, value] = [1, 0];
    for (let i = 0; i < bits; i++) {
      const b = bit(at + m);
      m = 2 * m + b;
      value |= b << i;
    }
    return value;
  };
  const evenly = (/** @type {number} */ bits) => {
    let value = 0;
    for (let i = 0; i < bits; i++) {
      coder[RANGE] >>>= 1;
      const one = coder[CODE] >= coder[RANGE];
      if (one) coder[CODE] -= coder[RANGE];
      value = 2 * value + (one ? 1 : 0);
      shift();
    }
    return value;
  };
  const lengthOf = (/** @type {number} */ at, /** @type {number} */ place) => {
    if (!bit(at)) return 2 + tree(at + 2 + 8 * place, 3);
    if (!bit(at + 1)) return 10 + tree(at + 130 + 8 * place, 3);
    return 18 + tree(at + 258, 8);
  };
  let [to, state, d0, d1, d2, d3] = [0, 0, 0, 0, 0, 0];
  while (to < size) {
    const place = to & ((1 << places) - 1);
    if (!bit(MATCH + 16 * state + place)) {
      const before = to ? out[to - 1] : 0;
      const at = LITERAL + 0x300 * (((to & ((1 << low) - 1)) << context) + (before >> (8 - context)));
      let m = 1;
      if (state >= 7) {
        for (let other = out[to - d0 - 1], same = true; same && m < 256; other <<= 1) {
          const expected = (other >> 7) & 1;
          const b = bit(at + 256 + 256 * expected + m);
          m = 2 * m + b;
          same = b === expected;
        }
      }
      while (m < 256) m = 2 * m + bit(at + m);
      out[to++] = m;
      state = state < 4 ? 0 : state < 10 ? state - 3 : state - 6;
      continue;
    }
    let length;
    if (!bit(REP + state)) {
      length = lengthOf(LENGTH, place);
      [d3, d2, d1] = [d2, d1, d0];
      const slot = tree(SLOT + 64 * Math.min(length - 2, 3), 6);
      d0 = slot;
      if (slot >= 4) {
        const bits = (slot >> 1) - 1;
        const base = (2 | (slot & 1)) << bits;
        d0 = slot < 14 ? base + reverse(NEAR + base - slot, bits) : base + 16 * evenly(bits - 4) + reverse(ALIGN, 4);
      }
      state = state < 7 ? 7 : 10;
    } else {
      let short = false;
      if (!bit(REP0 + state)) short = !bit(LONG + 16 * state + place);
      else {
        let d = d1;
        if (bit(REP1 + state)) {
          d = d2;
          if (bit(REP2 + state)) [d, d3] = [d3, d2];
          d2 = d1;
        }
        [d1, d0] = [d0, d];
      }
      length = short ? 1 : lengthOf(AGAIN, place);
      state = short ? (state < 7 ? 9 : 11) : state < 7 ? 8 : 11;
    }
    if (d0 >= to || from > packed.length) throw new Error("the planner in this page is damaged");
    for (const end = Math.min(to + length, size); to < end; to++) out[to] = out[to - d0 - 1];
  }
  return out;
}

/** The same in a worker, beside what the page draws. @param {Uint8Array<ArrayBuffer>} packed @returns {Promise<Uint8Array<ArrayBuffer>>} */
export function unlzmaBeside(packed) {
  const work = `const unlzma = ${unlzma}; onmessage = ({ data }) => { const bytes = unlzma(data); postMessage(bytes, [bytes.buffer]); };`;
  const address = URL.createObjectURL(new Blob([work], { type: "text/javascript" }));
  const worker = new Worker(address);
  /** @type {Promise<Uint8Array<ArrayBuffer>>} */
  const done = new Promise((resolve, reject) => {
    worker.onmessage = ({ data }) => resolve(data);
    worker.onerror = ({ message }) => reject(new Error(message));
    worker.postMessage(packed);
  });
  return done.finally(() => {
    worker.terminate();
    URL.revokeObjectURL(address);
  });
}
