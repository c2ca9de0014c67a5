// The colours of the picture, for a dark and a light background.

/** @typedef {[number, number, number]} Color red, green, blue between 0 and 1 */
/** @typedef {{background: Color, obstacle: Color, cut: Color, robot: Color, start: Color, goal: Color, path: Color,
 *  fromStart: Color, fromGoal: Color, wire: Color, edge: Color, picked: Color, other: Color}} Palette */

/** @param {string} hex @returns {Color} */
const color = (hex) => /** @type {Color} */ ([1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255));

/** @type {Palette} */
const LIGHT = {
  background: color("#f6f5f2"),
  obstacle: color("#d3c9ba"),
  cut: color("#9a8a75"),
  robot: color("#2f6fde"),
  start: color("#178a4c"),
  goal: color("#cf3535"),
  path: color("#c75f00"),
  fromStart: color("#3a66c4"),
  fromGoal: color("#c0453f"),
  wire: color("#857763"),
  edge: color("#2b2a28"),
  picked: color("#8a1fb8"),
  other: color("#5d6470"),
};

/** @type {Palette} */
const DARK = {
  background: color("#15181d"),
  obstacle: color("#b9b0a2"),
  cut: color("#7d7263"),
  robot: color("#4f90ff"),
  start: color("#35c274"),
  goal: color("#ff6460"),
  path: color("#ffa033"),
  fromStart: color("#76a9ff"),
  fromGoal: color("#ff8b84"),
  wire: color("#b9b0a2"),
  edge: color("#0a0b0d"),
  picked: color("#e49bff"),
  other: color("#a3abb8"),
};

/** @param {boolean} dark @returns {Palette} */
export const palette = (dark) => (dark ? DARK : LIGHT);

/** A colour for a component of a roadmap; neighbouring numbers differ clearly. @param {number} component @returns {Color} */
export function componentColor(component) {
  const hue = (0.58 + component * 0.381966) % 1;
  /** @param {number} shift */
  const channel = (shift) => 0.47 + 0.3 * Math.cos(2 * Math.PI * (hue + shift));
  return [channel(0), channel(-1 / 3), channel(-2 / 3)];
}
