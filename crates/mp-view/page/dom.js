// Makes elements of the page. Text is set as text only: what a scene file says is never read as HTML.

/** @typedef {Record<string, string | number | boolean | ((event: Event) => void)>} Properties */

/** An element with attributes, listeners (`onclick: …`) and children. @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag @param {Properties} [properties] @param {(Node | string)[]} children @returns {HTMLElementTagNameMap[K]} */
export function el(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (typeof value === "function") element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false) element.setAttribute(name, String(value));
  }
  element.append(...children);
  return element;
}

/** The element of the page with this id. @param {string} id @returns {HTMLElement} */
export function byId(id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`This page is incomplete: it has no element “${id}”.`);
  return element;
}

/** Shows what went wrong, and what to do, at the top of the page; an empty text removes it.
 * @param {unknown} error @param {HTMLElement[]} actions buttons beside it */
export function showError(error, ...actions) {
  const box = byId("alert");
  const help = error instanceof Error && "help" in error && typeof error.help === "string" ? error.help : "";
  box.replaceChildren(error instanceof Error ? error.message : String(error), ...(help ? [el("small", {}, help)] : []), ...actions, el("button", { type: "button", class: "close", "aria-label": "Close this message", onclick: () => (box.hidden = true) }));
  box.hidden = error === "";
  box.classList.remove("note");
}

/** Shows something worth knowing where errors are shown. @param {string} text @param {HTMLElement[]} actions buttons beside it */
export function showNote(text, ...actions) {
  showError(text, ...actions);
  byId("alert").classList.add("note");
}

/** @param {string} label @param {() => void} press @param {Properties} [properties] */
export const button = (label, press, properties = {}) => el("button", { type: "button", ...properties, onclick: press }, label);

/** @param {string} label @param {boolean} checked @param {(on: boolean) => void} change */
export function checkbox(label, checked, change) {
  const input = el("input", { type: "checkbox", checked, onchange: () => change(input.checked) });
  return el("label", { class: "check" }, input, el("span", {}, label));
}

/** @param {[value: string, label: string][]} options @param {string} value @param {(value: string) => void} change @param {Properties} [properties] */
export function select(options, value, change, properties = {}) {
  const input = el("select", { ...properties, onchange: () => change(input.value) });
  input.append(...options.map(([v, text]) => el("option", { value: v, selected: v === value }, text)));
  return input;
}

/** A label before a control. @param {string} label @param {HTMLElement} control */
export const labelled = (label, control) => el("label", { class: "row" }, el("span", {}, label), control);

/** @param {{low: number, high: number, step: number | "any", value: number}} range @param {(value: number) => void} change @param {Properties} [properties] */
export function slider({ low, high, step, value }, change, properties = {}) {
  const input = el("input", { type: "range", min: low, max: high, step, ...properties, oninput: () => change(input.valueAsNumber) });
  input.valueAsNumber = value;
  return input;
}

/** Calls `go` where a pointer is pressed and dragged in an element: 0 is its left side, 1 its right. @param {HTMLElement | SVGElement} element
 * @param {(part: number) => void} go */
export function whileHeld(element, go) {
  const at = (/** @type {PointerEvent} */ e) => {
    const box = element.getBoundingClientRect();
    go(Math.max(0, Math.min(1, (e.clientX - box.left) / box.width)));
  };
  element.addEventListener("pointerdown", (/** @type {any} */ e) => (element.setPointerCapture(e.pointerId), at(e)));
  element.addEventListener("pointermove", (/** @type {any} */ e) => element.hasPointerCapture(e.pointerId) && at(e));
}

/** A list of names and values. @param {[string, string][]} facts */
export const factList = (facts) => el("dl", {}, ...facts.flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]));

/** A part of the panel that can be folded. @param {string} title @param {boolean} open @param {HTMLElement[]} content */
export const section = (title, open, content) => el("details", { open }, el("summary", {}, title), el("div", { class: "content" }, ...content));

/** A legend: a scale from clear to a colour, and what it means. @param {[number, number, number]} color @param {string} words */
export function legendOf(color, words) {
  const scale = el("span", { class: "scale", "aria-hidden": "true" });
  const rgb = color.map((x) => Math.round(255 * x)).join(" ");
  scale.style.background = `linear-gradient(to right, transparent, rgb(${rgb}))`;
  return [scale, words];
}

/** A number as a person reads it. @param {number} x @returns {string} */
export function brief(x) {
  if (!Number.isFinite(x)) return x > 0 ? "∞" : "–";
  if (Number.isInteger(x)) return x.toLocaleString("en").replaceAll(",", "\u202f");
  const size = Math.abs(x);
  return size >= 1e-4 && size < 1e6 ? String(Number(x.toPrecision(4))) : x.toExponential(2);
}

/** A coordinate, with enough digits to be pasted back. @param {number} x @returns {string} */
export const coordinate = (x) => (Number.isFinite(x) ? String(Number(x.toPrecision(12))) : brief(x));

/** Asks in a dialog; Escape means no. @param {string} question @param {string} yes @param {string} no @returns {Promise<boolean>} */
export function ask(question, yes, no) {
  return new Promise((resolve) => {
    const dialog = el("dialog", { "aria-label": question, role: "alertdialog" });
    const buttons = [button(no, () => dialog.close("no")), button(yes, () => dialog.close("yes"))];
    dialog.append(el("p", {}, question), el("div", { class: "buttons" }, ...buttons));
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(dialog.returnValue === "yes");
    });
    document.body.append(dialog);
    dialog.showModal();
  });
}
