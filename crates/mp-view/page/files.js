// Files that come into the page and leave it. What they hold is read by the session; here it is only guessed what a file is for.

import { el } from "mp/dom.js";

/** @typedef {{name: string, bytes: Uint8Array<ArrayBuffer>}} NamedFile */
/** @typedef {"viewer" | "scene" | "mesh" | "path" | "other"} FileKind `viewer`: a scene file of the viewer; `other`: what a scene may need */

/** The endings that are offered when files are chosen. */
export const ENDINGS = ".mpv,.mp.json,.env,.cfg,.toml,.urdf,.png,.pgm,.yaml,.yml,.txt,.off,.stl,.obj,.dae,.json,.csv";
export const MESH_ENDINGS = ".off,.txt,.stl,.obj,.dae";

/** @type {[RegExp, FileKind][]} */
const KINDS = [
  [/\.mpv$/i, "viewer"], [/\.mp\.json$/i, "scene"], [/\.(env|cfg|toml|urdf|png|pgm|yaml|yml)$/i, "scene"],
  [/\.(off|stl|obj|dae)$/i, "mesh"], [/\.(json|csv)$/i, "path"],
];

/** What a file is for, by its ending; of .txt by its first lines (docs/formats). @param {NamedFile} file @returns {FileKind} */
export function kindOf({ name, bytes }) {
  const known = KINDS.find(([ending]) => ending.test(name));
  if (known) return known[1];
  if (!/\.txt$/i.test(name)) return "other";
  const text = new TextDecoder().decode(bytes.subarray(0, 4000));
  const lines = text.split(/[\r\n]+/).map((line) => line.replace(/#.*/, "").trim()).filter((line) => line);
  const [first = "", second = ""] = lines;
  if (/^robot\b/i.test(first)) return "scene";
  if (/^\D*OFF\b/i.test(first)) return "mesh";
  // A count and then six numbers on a line, or two counts: configurations. A count and nine numbers: a triangle.
  const [count, numbers] = [first, second].map((line) => line.split(/\s+/).length);
  return count === 2 || (count === 1 && numbers === 6) ? "path" : "mesh";
}

/** Endings of scenes: first what is a scene for sure, last what a scene may name. */
const SCENES = [".mp.json", ".env", ".cfg", ".toml", ".txt", ".urdf", ".yaml", ".yml", ".png", ".pgm"];

/** The name of the file that is the scene, among files of this kind. @param {NamedFile[]} scenes @returns {string} */
export function mainOf(scenes) {
  const rank = (/** @type {string} */ name) => SCENES.findIndex((ending) => name.toLowerCase().endsWith(ending));
  const best = Math.min(...scenes.map(({ name }) => rank(name)));
  const first = scenes.filter(({ name }) => rank(name) === best);
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
