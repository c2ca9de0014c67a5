// The field that pushes snakes, as an image below a world of the plane. The planner makes it: docs/formats/session.md, `field`.

import { palette } from "mp/colors.js";
import { brief, checkbox, el, labelled, legendOf, select, showError } from "mp/dom.js";
import { rowsOf } from "mp/saving.js";

/** @import { ImageSet } from "mp/buffers.js" */
/** @import { Palette } from "mp/colors.js" */
/** @import { Settings } from "mp/picture.js" */
/** @import { Picture, Renderer } from "mp/renderer.js" */
/** @import { Layer } from "mp/viewer.js" */
/** @import { Workbench } from "mp/workbench.js" */
/** @typedef {{origin: [number, number], cell: number, width: number, energy: Float32Array, range: number}} Field */

/** Cells along the longer side. */
const CELLS = 256;

/** The fields by name. @type {[string, string][]} */
export const FIELDS = [["clearance", "obstacles repel"], ["paper", "outlines repel (eq. 3 of RRS)"], ["risk", "risk along the path"]];

/** Red, green, blue and opacity of each cell: nothing where no obstacle pushes, full where the robot touches one. @param {Field} field
 * @param {[number, number, number]} color */
export function fieldPixels({ energy }, color) {
  const out = new Uint8Array(4 * energy.length);
  energy.forEach((e, i) => {
    for (let k = 0; k < 3; k++) out[4 * i + k] = Math.round(255 * color[k]);
    // The energy is ½ at contact, and more inside of obstacles.
    out[4 * i + 3] = Math.round(255 * Math.min(1, 2 * Math.max(0, e)));
  });
  return out;
}

/** @implements {Layer} */
export class FieldLayer {
  constructor(/** @type {Workbench} */ workbench) {
    this.workbench = workbench;
    /** @type {Field | null} */ this.field = null;
    /** @type {ImageSet | null} */ this.image = null;
    this.dark = false;
    this.asked = 0;
    this.box = checkbox("Field that pushes snakes", false, () => this.ask());
    this.box.title = "What pushes the edges of RRS and paths that are relaxed (I)";
    this.name = select(FIELDS, "clearance", () => this.ask());
    this.nameRow = labelled("Which field", this.name);
    this.range = el("input", { type: "text", value: "3%", size: 6, onchange: () => this.ask() });
    this.rangeRow = labelled("Range of the field", this.range);
    this.legend = el("p", { class: "legend", role: "status" });
    const { viewer } = workbench;
    viewer.addLayer(this);
    viewer.panels?.addShown(this.box, this.nameRow, this.rangeRow, this.legend);
    viewer.onpath.push(() => this.name.value === "risk" && this.ask());
    workbench.onopened.push(() => this.reset());
    workbench.onleft.push(() => this.reset());
    viewer.keys.push((e) => this.key(e));
    viewer.panels?.addHelp([["I", "show the field that pushes snakes (worlds of the plane)"]]);
    this.reset();
  }
  get wanted() { return this.box.querySelector("input")?.checked ?? false; }

  /** Only worlds of the plane have it; after an edit it is asked for again. */
  reset() {
    this.field = null;
    this.box.hidden = !(this.workbench.open && this.workbench.viewer.scene.areas.length);
    this.ask();
  }
  async ask() {
    const { session, viewer, ends } = this.workbench;
    const wanted = this.wanted && !this.box.hidden;
    this.nameRow.hidden = this.rangeRow.hidden = this.legend.hidden = !wanted;
    this.field = null;
    this.legend.textContent = "";
    viewer.changed();
    const asked = ++this.asked;
    if (!wanted) return;
    try {
      const range = this.range.value.trim() || null;
      const field = this.name.value;
      const shown = field === "risk" ? viewer.scene.paths[viewer.settings.path] : null;
      const path = shown ? { path: rowsOf(shown, viewer.scene.columns.length) } : {};
      const reply = /** @type {any} */ (await session.request({ do: "field", field, row: ends.request().start, range, cells: CELLS, ...path }));
      if (asked !== this.asked) return;
      this.field = reply;
      const words = `From no force to an obstacle that is touched. Obstacles push within ${brief(reply.range)} m.`;
      this.legend.replaceChildren(...legendOf(palette(viewer.settings.dark).pushed, words));
      viewer.changed();
    } catch (error) {
      if (asked === this.asked) showError(error);
    }
  }
  start(/** @type {Renderer} */ renderer) { this.image = renderer.image(); }

  /** @param {Settings} s @param {Palette} colors @returns {Picture["images"]} */
  images(s, colors) {
    const { field, image } = this;
    if (!field || !image) return [];
    const { width, cell, energy, origin } = field;
    const height = energy.length / width;
    if (image.owner !== field || this.dark !== s.dark) {
      this.dark = s.dark;
      image.write(field, width, height, fieldPixels(field, colors.pushed));
    }
    return [{ image, corner: [origin[0], origin[1], 0], right: [width * cell, 0, 0], up: [0, height * cell, 0] }];
  }
  key(/** @type {KeyboardEvent} */ e) {
    if (e.key !== "i" || this.box.hidden) return false;
    this.box.querySelector("input")?.click();
    return true;
  }
}
