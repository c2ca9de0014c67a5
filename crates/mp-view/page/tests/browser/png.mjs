// Small pictures for the documentation: PNG with a palette of up to 256 colours.

import { crc32, deflateSync } from "node:zlib";

/** The colours of a picture, the most frequent first, at most 256: fine steps where there are few colours, coarser ones where there
 * are many. @param {Uint8Array} pixels red, green, blue, alpha @returns {{colors: number[][], index: Uint8Array}} */
function paletteOf(pixels) {
  const count = pixels.length / 4;
  const keyOf = (i) => ((pixels[4 * i] & 0xf8) << 8) | ((pixels[4 * i + 1] & 0xf8) << 3) | (pixels[4 * i + 2] >> 3);
  // Each coarse colour stands for the mean of its pixels.
  const sums = new Map();
  for (let i = 0; i < count; i++) {
    const key = keyOf(i);
    let sum = sums.get(key);
    if (!sum) sums.set(key, (sum = [0, 0, 0, 0]));
    for (let k = 0; k < 3; k++) sum[k] += pixels[4 * i + k];
    sum[3]++;
  }
  const frequent = [...sums.entries()].sort((a, b) => b[1][3] - a[1][3] || a[0] - b[0]);
  const colors = frequent.slice(0, 256).map(([, sum]) => [0, 1, 2].map((k) => Math.round(sum[k] / sum[3])));
  const numbers = new Map(frequent.map(([key, sum], n) => {
    if (n < 256) return [key, n];
    const distance = (color) => color.reduce((d, c, k) => d + (c - sum[k] / sum[3]) ** 2, 0);
    return [key, colors.reduce((best, color, m) => (distance(color) < distance(colors[best]) ? m : best), 0)];
  }));
  return { colors, index: Uint8Array.from({ length: count }, (_, i) => numbers.get(keyOf(i))) };
}

/** A part of a PNG file. @param {string} kind @param {Uint8Array} content */
function chunk(kind, content) {
  const named = Buffer.concat([Buffer.from(kind, "latin1"), content]);
  const [length, check] = [Buffer.alloc(4), Buffer.alloc(4)];
  length.writeUInt32BE(content.length);
  check.writeUInt32BE(crc32(named));
  return Buffer.concat([length, named, check]);
}

/** @param {Uint8Array} pixels red, green, blue, alpha @param {number} width @param {number} height */
export function png(pixels, width, height) {
  const { colors, index } = paletteOf(pixels);
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([8, 3, 0, 0, 0], 8);
  const rows = Buffer.alloc(height * (width + 1));
  for (let y = 0; y < height; y++) rows.set(index.subarray(y * width, (y + 1) * width), y * (width + 1) + 1);
  const signature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
  return Buffer.concat([signature, chunk("IHDR", head), chunk("PLTE", Buffer.from(colors.flat())), chunk("IDAT", deflateSync(rows, { level: 9 })), chunk("IEND", Buffer.alloc(0))]);
}
