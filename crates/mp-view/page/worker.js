// The planner inside the page, in a worker of its own: the page stays responsive, and a worker that does not answer can be ended.

/** @typedef {{memory: WebAssembly.Memory, reserve: (length: number) => number, send: (length: number) => void,
 *  advance: (milliseconds: number) => number, take: () => number, taken: () => number}} Planner
 *  what the WebAssembly module exports: docs/formats/session.md, “In a worker” */
/** @typedef {{kind: "reply" | "event", bytes: Uint8Array<ArrayBuffer>}} FromPlanner */
/** @typedef {FromPlanner | {kind: "fault", text: string}} FromWorker */

/** How long the planner works before the worker reads its messages and passes events on, milliseconds. */
const SLICE = 50;

/** The program of the worker. It becomes the text of the worker, so it uses nothing from outside. @param {number} slice */
function work(slice) {
  /** @type {Promise<Planner> | null} */ let ready = null;
  let runs = false;
  const post = (/** @type {FromWorker} */ message, /** @type {Transferable[]} */ moved = []) => self.postMessage(message, { transfer: moved });
  const fault = (/** @type {unknown} */ error) => post({ kind: "fault", text: error instanceof Error ? error.message : String(error) });
  /** Posts the next message of the planner, if there is one. @param {Planner} planner @param {"reply" | "event"} kind */
  const pass = (planner, kind) => {
    const length = planner.take();
    if (!length) return false;
    const bytes = new Uint8Array(planner.memory.buffer, planner.taken() >>> 0, length >>> 0).slice();
    post({ kind, bytes }, [bytes.buffer]);
    return true;
  };
  // Messages of the page come in between two slices: a message to itself has its turn after those that wait.
  const turn = new MessageChannel();
  turn.port1.onmessage = () => ready?.then((planner) => {
    runs = planner.advance(slice) === 1;
    while (pass(planner, "event"));
    if (runs) turn.port2.postMessage(null);
  }).catch(fault);
  self.onmessage = ({ data }) => {
    if (!ready) {
      ready = WebAssembly.instantiate(data, { env: { now: () => performance.now() } }).then((made) => /** @type {any} */ (made).exports);
      ready.catch(fault);
      return;
    }
    ready.then((planner) => {
      const address = planner.reserve(data.length) >>> 0;
      new Uint8Array(planner.memory.buffer, address, data.length).set(data);
      planner.send(data.length);
      pass(planner, "reply");
      while (pass(planner, "event"));
      if (!runs) turn.port2.postMessage(null);
      runs = true;
    }).catch(fault);
  };
}

/** One worker with an instance of the planner. */
export class PlannerWorker {
  /** @param {WebAssembly.Module} module @param {(bytes: Uint8Array) => void} onevent @param {(text: string) => void} onfault */
  constructor(module, onevent, onfault) {
    const address = URL.createObjectURL(new Blob([`(${work})(${SLICE})`], { type: "text/javascript" }));
    this.worker = new Worker(address);
    /** @type {{resolve: (bytes: Uint8Array) => void, reject: (error: Error) => void}[]} */ this.waiting = [];
    const fail = (/** @type {string} */ text) => {
      this.end(text);
      onfault(text);
    };
    this.worker.onmessage = ({ data }) => {
      URL.revokeObjectURL(address);
      const message = /** @type {FromWorker} */ (data);
      if (message.kind === "reply") this.waiting.shift()?.resolve(message.bytes);
      else if (message.kind === "event") onevent(message.bytes);
      else if (message.kind === "fault") fail(message.text);
    };
    this.worker.onerror = (e) => fail(e.message);
    this.worker.postMessage(module);
  }
  /** Sends a request; replies come in the same order. @param {Uint8Array} bytes @returns {Promise<Uint8Array>} */
  send(bytes) {
    return new Promise((resolve, reject) => {
      this.waiting.push({ resolve, reject });
      this.worker.postMessage(bytes);
    });
  }
  /** Ends the worker, whatever it does. @param {string} why */
  end(why) {
    this.worker.terminate();
    for (const { reject } of this.waiting.splice(0)) reject(new Error(why));
  }
}
