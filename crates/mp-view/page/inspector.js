// The panel that builds: figures and meshes to add, the numbers of what is selected, and the room.

import { button, checkbox, coordinate, el, labelled, section, select } from "mp/dom.js";
import * as doc from "mp/document.js";
import { HANDLE_MODES } from "mp/editor.js";
import { niceStep, tidy } from "mp/gizmo.js";

/** @import { Document, DocumentBody, Environment, Part, Six, Three } from "mp/document.js" */
/** @import { Editor } from "mp/editor.js" */
/** @typedef {{label: string, hint?: string, value: number, step?: number, change: (value: number) => void}} Field */

/** The numbers of a pose: in short, and in words. */
const POSE = ["x", "y", "z", "α", "β", "γ"];
const POSE_HINTS = ["x, metres", "y, metres", "z, metres", "yaw about z, radians", "pitch about y, radians", "roll about x, radians"];
const SCALE_HINTS = ["x", "y", "z"].map((axis) => `scale along the body's own ${axis} axis`);
/** The step of the arrow keys in fields of angles, radians. */
const ANGLE_STEP = 0.05;

export class Inspector {
  /** @param {Editor} editor @param {() => void} openMesh lets people choose a mesh file */
  constructor(editor, openMesh) {
    this.editor = editor;
    this.modes = HANDLE_MODES.map(([mode, label]) => button(label, () => editor.setMode(mode), { title: "Handles (H)", value: mode }));
    this.chosen = el("select", { "aria-label": "Selected", onchange: () => editor.select(editor.parts()[this.chosen.selectedIndex - 1]?.selection ?? null) });
    this.figure = el("select", { "aria-label": "Figure" });
    this.as = select([["obstacle", "as obstacle"], ["robot", "as robot"]], "obstacle", () => {}, { "aria-label": "As obstacle or as robot" });
    this.mesh = button("Mesh…", openMesh, { title: "Add a mesh from a file" });
    this.adding = this.addControls();
    this.body = el("div", { class: "fields" });
    this.room = el("div", { class: "fields" });
    this.handles = el("span", { class: "segments", role: "group", "aria-label": "Handles" }, ...this.modes);
    this.roomSection = section("Room", false, [this.room]);
    this.unedited = el("small", {});
    this.panel = section("Build", true, [this.adding, this.unedited, labelled("Selected", this.chosen), this.handles, this.body]);
    editor.viewer.addPanel(this.panel);
    editor.viewer.addPanel(this.roomSection);
    editor.onchange.push(() => this.update());
    editor.onpreview.push((pose, scale) => this.preview(pose, scale));
    this.update();
  }
  addControls() {
    const { editor } = this;
    const add = () => {
      const { environment } = editor;
      const figure = this.sized(this.figure.value);
      return editor.add(this.figure.value, figure, environment && this.as.value === "robot" ? "robot" : "obstacle", doc.reachOf(figure));
    };
    return el("div", { class: "buttons", role: "group", "aria-label": "Add a body" }, this.figure, this.as, button("Add", add), this.mesh);
  }
  /** A new figure: of a size that suits the scene, where it is one of a file. @param {string} name */
  sized(name) {
    const { document, environment, viewer } = this.editor;
    const figure = document ? doc.figuresOf(document)[name] : doc.FIGURES[name];
    return environment || !document ? figure : doc.enlarged(figure, niceStep(viewer.camera.radius / 20, 1));
  }
  /** Offers the figures that the document can have. @param {Document | null} d */
  offer(d) {
    const names = Object.keys(d ? doc.figuresOf(d) : doc.FIGURES);
    const { figure, as, mesh } = this;
    if (names.join() !== [...figure.options].map((option) => option.value).join()) {
      figure.replaceChildren(...names.map((name) => el("option", { value: name, selected: name === "cube" }, name)));
    }
    as.hidden = Boolean(d && !d.robot);
    mesh.hidden = Boolean(d && !d.robot && d.plane);
  }
  /** Shows what the editor has. What has the focus keeps it. */
  update() {
    const { editor } = this;
    const { document: d, part } = editor;
    const parts = editor.parts();
    const { unedited } = editor.workbench;
    this.panel.hidden = !parts.length && !unedited;
    this.adding.hidden = !d;
    this.offer(d);
    this.unedited.textContent = unedited ?? "";
    this.roomSection.hidden = !d?.robot;
    const chosen = JSON.stringify(editor.selection);
    const options = parts.map(({ name, selection }) => el("option", { selected: JSON.stringify(selection) === chosen }, name));
    this.chosen.replaceChildren(el("option", {}, "nothing"), ...options);
    const { target, shownMode } = editor.handles;
    this.handles.hidden = !target;
    for (const mode of this.modes) {
      mode.hidden = !target?.modes.some((m) => m === mode.value);
      mode.setAttribute("aria-pressed", String(mode.value === shownMode));
    }
    const shape = d && part !== null ? doc.bodyOf(d, part).shape : null;
    renew(this.body, d && part !== null ? this.bodyFields(d, part) : [], JSON.stringify([part, d?.robot && d.space, shape && doc.shapeKind(shape)]));
    renew(this.room, d?.robot ? this.roomFields(d) : [], JSON.stringify([d?.robot && d.space, !d?.robot || !d.bounds]));
  }
  /** @param {Document} d @param {Part} part @returns {HTMLElement[]} */
  bodyFields(d, part) {
    const { editor } = this;
    const body = doc.bodyOf(d, part);
    const pose = doc.poseOf(d, part);
    const scale = doc.scaleOf(body);
    const metres = this.metres();
    const plane = !d.robot && d.plane;
    const flat = d.robot ? d.space === "SE2" && typeof part !== "number" : d.plane;
    const key = typeof part === "number" ? `#${part}` : part;
    // Fields outlive the document that they were made for, so what they change is the document of then.
    const label = (/** @type {string} */ verb) => `${verb} ${doc.bodyOf(editor.document ?? d, part).name}`;
    const change = (/** @type {string} */ verb, /** @type {Partial<doc.Obstacle>} */ changed) => editor.run(label(verb), (now) => doc.changeBody(now, part, changed));
    const rename = el("input", { type: "text", "aria-label": "Name", value: body.name, onchange: () => rename.value.trim() && change("rename", { name: rename.value.trim() }) });
    const sizes = doc.sizesOf(body.shape).map((size, i) => numberField({ label: size.name, hint: `${size.name}, metres`, value: size.value, step: metres, change: (v) =>
      editor.run(label("size of"), (now) => doc.changeBody(now, part, { shape: doc.sizesOf(doc.bodyOf(now, part).shape)[i].set(v) })) }));
    const place = pose.map((value, i) => this.poseField(value, i, metres, (v) =>
      editor.run(label(i < 3 ? "move" : "turn"), (now) => doc.movePart(now, part, /** @type {Six} */ (replaced(doc.poseOf(now, part), i, v))), `${key} ${i}`)))
      .filter((_, i) => !flat || i === 0 || i === 1 || i === 3);
    const factors = scale.slice(0, plane ? 2 : 3).map((value, i) => numberField({ label: "xyz"[i], hint: SCALE_HINTS[i], value, step: 0.1, change: (v) =>
      editor.run(label("scale"), (now) => doc.scalePart(now, part, /** @type {Three} */ (replaced(doc.scaleOf(doc.bodyOf(now, part)), i, v))), `${key} scale ${i}`) }));
    const copies = [button("Duplicate", () => editor.duplicate(), { title: "Ctrl + D" })];
    if (typeof part === "number") copies.push(button("Delete", () => editor.remove(), { title: "Delete" }));
    return [
      labelled("Name", rename),
      ...(!d.robot ? [] : [this.colorField(body, typeof part === "number" ? "own colour" : "own colour on paths", (color) => change("colour", { color }))]),
      this.shapeField(d, body, (shape) => change("shape of", { shape })),
      ...(sizes.length ? [group("Sizes, m", sizes)] : []),
      group(typeof part === "number" ? "Place, m; angles, rad" : `${part === "start" ? "Start" : "Goal"}: place, m; angles, rad`, place),
      group("Scale", factors),
      el("div", { class: "buttons" }, ...copies),
    ];
  }
  /** @param {number} value @param {number} i @param {number} metres @param {(value: number) => void} change */
  poseField(value, i, metres, change) {
    const field = numberField({ label: POSE[i], hint: POSE_HINTS[i], value, step: i < 3 ? metres : ANGLE_STEP, change });
    if (i >= 3) field.append(el("output", { class: "degrees" }, degrees(value)));
    return field;
  }
  /** @param {DocumentBody} body @param {string} label @param {(color: string | null) => void} change */
  colorField({ color }, label, change) {
    const input = el("input", { type: "color", value: color ?? "#808080", "aria-label": "Colour", disabled: !color, onchange: () => change(input.value) });
    const own = checkbox(label, Boolean(color), (on) => change(on ? input.value : null));
    return el("div", { class: "row" }, own, input);
  }
  /** @param {Document} d @param {DocumentBody} body @param {(shape: doc.DocumentShape) => void} change */
  shapeField(d, { shape }, change) {
    const names = Object.keys(doc.figuresOf(d));
    /** @type {[string, string][]} */ const kinds = names.map((name) => [name, name]);
    const kind = doc.shapeKind(shape);
    if (!names.includes(kind)) kinds.unshift([kind, "mesh" in shape ? `mesh ${shape.mesh.file}` : "given" in shape ? `${shape.given.kind} of the file` : kind]);
    return labelled("Shape", select(kinds, kind, (v) => names.includes(v) && change(this.sized(v)), { "aria-label": "Shape" }));
  }
  /** @param {Environment} d @returns {HTMLElement[]} */
  roomFields(d) {
    const { editor } = this;
    const name = el("input", { type: "text", "aria-label": "Name of the environment", value: d.name, onchange: () => name.value.trim() && editor.run("rename the environment", (now) => ({ ...now, name: name.value.trim() })) });
    const space = select([["SE3", "in space"], ["SE2", "in the plane z = 0"]], d.space, (v) => editor.run("change the space", (now) => !now.robot ? now : doc.setSpace(now, /** @type {"SE3" | "SE2"} */ (v))), { "aria-label": "The robot moves" });
    const own = checkbox("own bounds of the robot's origin", Boolean(d.bounds), (on) => editor.run("change the bounds", (now) => !now.robot ? now : doc.setBounds(now, on ? this.presentBounds() : null)));
    const fields = [labelled("Name", name), labelled("The robot moves", space), own];
    const { bounds } = d;
    if (!bounds) return fields;
    const rows = ["least", "greatest"].map((label, end) => group(`Bounds, ${label}, m`, bounds[end].flatMap((value, i) => (d.space === "SE2" && i === 2 ? [] : [numberField({
      label: "xyz"[i], hint: `${label} ${"xyz"[i]} of the robot's origin, metres`, value, step: this.metres(), change: (v) =>
        editor.run("change the bounds", (now) => {
          if (!now.robot) return now;
          const corners = now.bounds ?? bounds;
          return doc.setBounds(now, /** @type {[Three, Three]} */ (replaced(corners, end, replaced(corners[end], i, v))));
        }, `bounds ${end} ${i}`) })]))));
    return [...fields, ...rows];
  }
  /** The bounds that the planner uses now. @returns {[Three, Three]} */
  presentBounds() {
    const { limits, bounds } = this.editor.viewer.scene;
    const side = (/** @type {number} */ end) => /** @type {Three} */ ([0, 1, 2].map((i) => tidy(limits[i]?.[end] ?? bounds[end][i])));
    return [side(0), side(1)];
  }
  /** The step of the arrow keys in fields of metres. */
  metres() { return niceStep(this.editor.viewer.camera.radius / 100, 1); }

  /** Shows the numbers of a drag. @param {Six} pose @param {Three | null} scale */
  preview(pose, scale) {
    const values = new Map(pose.map((value, i) => [POSE_HINTS[i], value]));
    scale?.forEach((value, i) => values.set(SCALE_HINTS[i], value));
    for (const input of this.body.querySelectorAll("input")) {
      const value = values.get(input.title);
      if (value === undefined) continue;
      input.value = coordinate(value);
      const output = input.parentElement?.querySelector("output");
      if (output) output.textContent = degrees(value);
    }
  }
}

/** @param {number} radians */
const degrees = (radians) => `${Number(((radians * 180) / Math.PI).toFixed(1))}°`;

/** A list with another entry. @template T @param {readonly T[]} all @param {number} at @param {T} value */
const replaced = (all, at, value) => all.map((old, i) => (i === at ? value : old));

/** Shows fields. Fields of the same kind stay, and only their values change, so that nothing is lost of what is being typed.
 * @param {HTMLElement} within @param {HTMLElement[]} fields @param {string} kind */
function renew(within, fields, kind) {
  if (within.dataset.kind !== kind) {
    within.dataset.kind = kind;
    return within.replaceChildren(...fields);
  }
  const controls = (/** @type {ParentNode} */ root) => [...root.querySelectorAll("input, select, output")];
  const fresh = fields.flatMap((field) => (field.matches("input, select, output") ? [field] : controls(field)));
  controls(within).forEach((old, i) => {
    const now = fresh[i];
    if (old instanceof HTMLInputElement && now instanceof HTMLInputElement) {
      [old.checked, old.disabled, old.step] = [now.checked, now.disabled, now.step];
      const typing = old === document.activeElement && old.value !== old.defaultValue;
      old.defaultValue = now.defaultValue;
      if (!typing) old.value = now.value;
    } else if (old instanceof HTMLSelectElement && now instanceof HTMLSelectElement) {
      const { value } = now;
      old.replaceChildren(...now.children);
      old.value = value;
    } else old.textContent = now?.textContent ?? "";
  });
}

/** Fields side by side. @param {string} label @param {HTMLElement[]} fields */
const group = (label, fields) => el("fieldset", {}, el("legend", {}, label), ...fields);

/** A number; what is no number is not taken. @param {Field} field @returns {HTMLElement} */
function numberField({ label, hint = label, value, step = 1, change }) {
  const input = el("input", { type: "number", step, value: tidy(value), "aria-label": hint, title: hint, onchange: () => {
    if (Number.isFinite(input.valueAsNumber)) change(input.valueAsNumber);
    else input.value = input.defaultValue;
  } });
  return el("label", { class: "number" }, el("span", {}, label), input);
}
