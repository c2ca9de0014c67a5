// @ts-check
// What is inside the page: base64 text, packed by gzip, the planner as `.lzma`. And this page with another scene.

import { unlzmaBeside } from "mp/lzma.js";

/** The first byte of the planner: how `mp_store::packed` packs. */
const LZMA = 4;

/** The bytes of base64 text. @param {string} base64 @returns {Uint8Array<ArrayBuffer>} */
function fromBase64(base64) {
  /** @type {string} */ let binary;
  try {
    binary = atob(base64.trim());
  } catch {
    throw new Error("The scene in this page is damaged: it is not base64.");
  }
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** What is in this text; bytes that are not packed are read too. @param {string} text @returns {Promise<Uint8Array>} */
export async function unpack(text) {
  const bytes = fromBase64(text);
  if (bytes[0] === LZMA) return unlzmaBeside(bytes);
  if (bytes[0] !== 0x1f || bytes[1] !== 0x8b) return bytes;
  try {
    const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Uint8Array(await new Response(plain).arrayBuffer());
  } catch {
    throw new Error("The scene in this page is damaged: it cannot be unpacked.");
  }
}

/** This page as it came, with another scene inside and without a planner. @param {Uint8Array<ArrayBuffer>} scene
 * @returns {Promise<Uint8Array<ArrayBuffer>>} */
export async function pageWith(scene) {
  const packed = await new Response(new Blob([scene]).stream().pipeThrough(new CompressionStream("gzip"))).blob();
  /** @type {string} */
  const address = await new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(String(reader.result));
    reader.onerror = () => reject(reader.error);
    reader.readAsDataURL(packed);
  });
  const inside = document.createElement("script");
  inside.id = "scene";
  inside.type = "application/octet-stream";
  inside.textContent = address.slice(address.indexOf(",") + 1);
  const { mpPage } = /** @type {{mpPage: HTMLElement}} */ (/** @type {unknown} */ (window));
  const page = /** @type {HTMLElement} */ (mpPage.cloneNode(true));
  page.querySelector("#modules")?.before(inside);
  // eslint-disable-next-line no-restricted-properties -- it is read, not written
  return new TextEncoder().encode(`<!doctype html>\n${page.outerHTML}\n`);
}
