// What is shown, as a picture or as a film.

/** @import { Viewer } from "mp/viewer.js" */

/** Pictures of a film in a second. */
const RATE = 30;
/** Bits of a film in a second. */
const BITS = 8e6;
/** Films, the one that most programs play first. */
const FILMS = ["video/mp4", "video/webm"];

/** @param {Viewer} viewer @returns {Promise<Blob>} */
export function pictureOf(viewer) {
  // The picture can be read only until the browser has shown it.
  viewer.draw();
  return new Promise((resolve, reject) => viewer.canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("This browser makes no picture of the scene."))), "image/png"));
}

/** The path from its start to its end, at the speed that is chosen. @param {Viewer} viewer @returns {Promise<Blob>} */
export async function filmOf({ canvas, timeline, ondraw }) {
  const type = FILMS.find((film) => globalThis.MediaRecorder?.isTypeSupported(film));
  if (!type || !timeline) throw new Error("This browser makes no films: use “mp render” instead.");
  const recorder = new MediaRecorder(canvas.captureStream(RATE), { mimeType: type, videoBitsPerSecond: BITS });
  /** @type {Blob[]} */ const parts = [];
  recorder.ondataavailable = ({ data }) => parts.push(data);
  const over = new Promise((resolve, reject) => {
    recorder.onstop = resolve;
    recorder.onerror = () => reject(new Error("The browser gave the film up."));
  });
  const { atEnd } = timeline;
  const watch = () => { if (!timeline.playing && recorder.state === "recording") recorder.stop(); };
  recorder.start();
  timeline.playOnce();
  ondraw.push(watch);
  await over.finally(() => {
    ondraw.splice(ondraw.indexOf(watch), 1);
    timeline.atEnd = atEnd;
  });
  return new Blob(parts, { type });
}
