// Messages and scene files are laid out alike: MPV1, the length of the head, the head as JSON, and arrays that the head names.
// Here a message is one plain object, with its arrays in place as typed arrays.

/** @typedef {Record<string, unknown>} Json */
/** @typedef {Record<string, any>} Message what a session sends; its members are in docs/formats/session.md */

const KINDS = { f32: Float32Array, f64: Float64Array, u32: Uint32Array, i32: Int32Array, u8: Uint8Array };

/** @param {number} n */
const toEight = (n) => Math.ceil(n / 8) * 8;

/** @param {unknown} value @returns {value is ArrayBufferView} */
const isArray = (value) => ArrayBuffer.isView(value) && !(value instanceof DataView);

/** The name of an array's type in heads. @param {ArrayBufferView} array @returns {string} */
function kindOf(array) {
  const kind = Object.entries(KINDS).find(([, Kind]) => array instanceof Kind)?.[0];
  if (!kind) throw new Error("A message can only have arrays of the types f32, f64, u32, i32 and u8.");
  return kind;
}

/** The bytes of a message. @param {object} message with typed arrays where arrays are to be @returns {Uint8Array<ArrayBuffer>} */
export function encode(message) {
  /** @type {{array: ArrayBufferView, offset: number}[]} */ const arrays = [];
  let size = 0;
  const text = JSON.stringify(message, (_, value) => {
    if (!isArray(value)) return value;
    const offset = size;
    arrays.push({ array: value, offset });
    size += toEight(value.byteLength);
    return { type: kindOf(value), offset, count: /** @type {Uint8Array} */ (value).length };
  });
  const head = new TextEncoder().encode(text);
  const begin = 8 + toEight(head.length);
  const bytes = new Uint8Array(begin + size);
  bytes.fill(32, 8, begin);
  bytes.set([77, 80, 86, 49]);
  new DataView(bytes.buffer).setUint32(4, begin - 8, true);
  bytes.set(head, 8);
  for (const { array, offset } of arrays) bytes.set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength), begin + offset);
  return bytes;
}

/** Reads a message or a scene file. The arrays share the memory of `given` where that is possible.
 * @param {Uint8Array} given @param {string} [what] it is, for messages of errors @returns {Json} */
export function decode(given, what = "scene file") {
  const check = (/** @type {boolean} */ holds, /** @type {string} */ sentence) => { if (!holds) throw new Error(sentence); };
  // Arrays of numbers can be read in place only where the bytes begin at a multiple of 8 in memory.
  const bytes = given.byteOffset % 8 === 0 ? given : given.slice();
  check(bytes.length >= 8 && String.fromCharCode(...bytes.subarray(0, 3)) === "MPV", `This is not a ${what}: it does not begin with MPV1.`);
  check(bytes[3] === 49, `This page reads ${what}s of version 1; this one begins with MPV${String.fromCharCode(bytes[3])}.`);
  const size = new DataView(bytes.buffer, bytes.byteOffset).getUint32(4, true);
  check(size % 8 === 0, `The ${what} is damaged: the length of its head is not a multiple of 8.`);
  check(8 + size <= bytes.length, `The ${what} is too short: its head reaches beyond its end.`);
  const source = new TextDecoder().decode(bytes.subarray(8, 8 + size));
  const begin = bytes.byteOffset + 8 + size;
  /** @param {string} name @param {{type: string, offset: number, count: number}} entry */
  const array = (name, { type, offset, count }) => {
    const Kind = KINDS[/** @type {keyof typeof KINDS} */ (type)];
    const whole = Number.isSafeInteger(offset) && Number.isSafeInteger(count) && offset >= 0 && count >= 0;
    check(whole && offset % 8 === 0, `In the ${what}, the array “${name}” has an offset or a count that is not possible.`);
    const end = 8 + size + offset + count * Kind.BYTES_PER_ELEMENT;
    check(end <= bytes.length, `The ${what} is too short: the array “${name}” reaches beyond its end.`);
    return new Kind(/** @type {ArrayBuffer} */ (bytes.buffer), begin + offset, count);
  };
  /** @type {unknown} */ let head;
  try {
    // A seed may have more digits than a number holds; it is only shown, so it becomes text.
    head = JSON.parse(source.replace(/(?<!\\)"seed":\s*(\d{16,})/g, '"seed":"$1"'));
  } catch {
    throw new Error(`The ${what} is damaged: its head is not JSON.`);
  }
  check(typeof head === "object" && head !== null && !Array.isArray(head), `The ${what} is damaged: its head is not an object.`);
  return /** @type {Json} */ (withArrays("", head, array));
}

/** Puts typed arrays where the head names them. @param {string} name @param {any} value @param {(name: string, entry: any) => unknown} array
 * @returns {unknown} */
function withArrays(name, value, array) {
  if (typeof value !== "object" || value === null) return value;
  if (Array.isArray(value)) {
    // Long lists of numbers hold no arrays.
    if (typeof value[0] === "object") value.forEach((entry, i) => (value[i] = withArrays(name, entry, array)));
    return value;
  }
  if (Object.hasOwn(KINDS, value.type) && "offset" in value && "count" in value) return array(name, value);
  for (const key of Object.keys(value)) value[key] = withArrays(key, value[key], array);
  return value;
}
