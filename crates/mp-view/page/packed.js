// @ts-check
// The bytes of the scene inside the page: base64 text, packed by gzip.

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

/** The scene in this text; one that is not packed is read too. @param {string} text @returns {Promise<Uint8Array>} */
export async function unpack(text) {
  const bytes = fromBase64(text);
  if (bytes[0] !== 0x1f || bytes[1] !== 0x8b) return bytes;
  try {
    const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Uint8Array(await new Response(plain).arrayBuffer());
  } catch {
    throw new Error("The scene in this page is damaged: it cannot be unpacked.");
  }
}
