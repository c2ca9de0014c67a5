// Files that come into the page and leave it. What they hold is read by the session; here it is only guessed what a file is for.

import { el } from "mp/dom.js";

/** @typedef {{name: string, bytes: Uint8Array<ArrayBuffer>}} NamedFile */
/** @typedef {"viewer" | "scene" | "mesh" | "path" | "other"} FileKind `viewer`: a scene file of the viewer; `other`: what a scene may need */
/** @typedef {[ending: string, kind: FileKind | "text"][]} Endings the `endings` of the reply to `hello` */

/** The endings to offer when files are chosen. @param {Endings} endings @param {string[]} kinds */
export const offered = (endings, kinds = ["viewer", "scene", "mesh", "path", "text"]) => endings.filter(([, kind]) => kinds.includes(kind)).map(([ending]) => ending).join(",");

/** The place of a file's ending among all. @param {string} name @param {Endings} endings */
const placeOf = (name, endings) => endings.findIndex(([ending]) => name.toLowerCase().endsWith(ending));

/** What a file is for, by its ending; of .txt by its first lines (docs/formats). @param {NamedFile} file @param {Endings} endings @returns {FileKind} */
export function kindOf({ name, bytes }, endings) {
  const kind = endings[placeOf(name, endings)]?.[1] ?? "other";
  if (kind !== "text") return kind;
  const text = new TextDecoder().decode(bytes.subarray(0, 4000));
  const lines = text.split(/[\r\n]+/).map((line) => line.replace(/#.*/, "").trim()).filter((line) => line);
  const [first = "", second = ""] = lines;
  if (/^robot\b/i.test(first)) return "scene";
  if (/^\D*OFF\b/i.test(first)) return "mesh";
  // A count and then six numbers on a line, or two counts: configurations. A count and nine numbers: a triangle.
  const [count, numbers] = [first, second].map((line) => line.split(/\s+/).length);
  return count === 2 || (count === 1 && numbers === 6) ? "path" : "mesh";
}

/** The name of the file that is the scene, among files of this kind. @param {NamedFile[]} scenes @param {Endings} endings @returns {string} */
export function mainOf(scenes, endings) {
  const best = Math.min(...scenes.map(({ name }) => placeOf(name, endings)));
  const first = scenes.filter(({ name }) => placeOf(name, endings) === best);
  if (first.length > 1) throw new Error(`These are several scenes: ${first.map(({ name }) => name).join(", ")}. Open one at a time, with the files that it names.`);
  return first[0].name;
}

/** Reads files that were chosen or dropped. @param {Iterable<File>} files @returns {Promise<NamedFile[]>} */
export function readFiles(files) {
  return Promise.all([...files].map(async (file) => {
    const bytes = await file.arrayBuffer().catch(() => {
      throw new Error(`The file “${file.name}” cannot be read. If it is a folder, choose the files in it.`);
    });
    return { name: file.name, bytes: new Uint8Array(bytes) };
  }));
}

/** Lets people choose files; none when they close the dialog. @param {string} endings @param {boolean} several @returns {Promise<NamedFile[]>} */
export function chooseFiles(endings, several) {
  return new Promise((resolve, reject) => {
    const input = el("input", { type: "file", accept: endings, multiple: several, hidden: true, "aria-label": "Files" });
    const done = (/** @type {FileList | null} */ files) => {
      input.remove();
      readFiles(files ?? []).then(resolve, reject);
    };
    input.addEventListener("change", () => done(input.files));
    input.addEventListener("cancel", () => done(null));
    document.body.append(input);
    input.click();
  });
}
