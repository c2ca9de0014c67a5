// The colours of the picture, for a dark and a light background.

/** @typedef {[number, number, number]} Color red, green, blue between 0 and 1 */
/** @typedef {{background: Color, obstacle: Color, cut: Color, robot: Color, start: Color, goal: Color, path: Color, compared: Color, rejected: Color, refused: Color,
 *  covered: Color, pushed: Color, fromStart: Color, fromGoal: Color, wire: Color, edge: Color, picked: Color, other: Color}} Palette */

/** @param {string} hex as #rrggbb @returns {Color} */
export const hexColor = (hex) => /** @type {Color} */ ([1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255));

/** Of everything: the colour in light and in dark surroundings. @type {Record<keyof Palette, [string, string]>} */
const COLORS = {
  background: ["#f6f5f2", "#15181d"],
  obstacle: ["#d3c9ba", "#b9b0a2"],
  cut: ["#9a8a75", "#7d7263"],
  robot: ["#2f6fde", "#4f90ff"],
  start: ["#178a4c", "#35c274"],
  goal: ["#cf3535", "#ff6460"],
  path: ["#c75f00", "#ffa033"],
  compared: ["#0b7d8a", "#3fd0de"],
  rejected: ["#d02020", "#ff5a50"],
  refused: ["#a3148c", "#ff6be6"],
  covered: ["#1d8f86", "#2fc4b8"],
  pushed: ["#b2182b", "#e0485a"],
  fromStart: ["#3a66c4", "#76a9ff"],
  fromGoal: ["#c0453f", "#ff8b84"],
  wire: ["#857763", "#b9b0a2"],
  edge: ["#2b2a28", "#0a0b0d"],
  picked: ["#8a1fb8", "#e49bff"],
  other: ["#5d6470", "#a3abb8"],
};

const [LIGHT, DARK] = [0, 1].map((i) => /** @type {Palette} */ (Object.fromEntries(Object.entries(COLORS).map(([k, c]) => [k, hexColor(c[i])]))));
/** @param {boolean} dark @returns {Palette} */
export const palette = (dark) => (dark ? DARK : LIGHT);

/** The colours of successive obstacles in space, as the rasteriser of mp-render has them. */
const OBSTACLES = ["#b4bdc9", "#c9bda9", "#acbfb3", "#c2b2bd", "#a9bcc4", "#cdc7ae"].map(hexColor);
/** @param {number} obstacle its number @returns {Color} */
export const obstacleColor = (obstacle) => OBSTACLES[obstacle % OBSTACLES.length];

/** A colour for a component of a roadmap; neighbouring numbers differ clearly. @param {number} first its first milestone @returns {Color} */
export function componentColor(first) {
  const hue = (0.58 + first * 0.381966) % 1;
  const channel = (/** @type {number} */ shift) => 0.47 + 0.3 * Math.cos(2 * Math.PI * (hue + shift));
  return [channel(0), channel(-1 / 3), channel(-2 / 3)];
}
