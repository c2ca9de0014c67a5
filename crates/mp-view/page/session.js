// The page's connection to its planner: a server (`mp view`), or workers with the planner that is inside the page.

import { decode, encode } from "mp/message.js";
import { pageWith, unpack } from "mp/packed.js";
import { PlannerWorker } from "mp/worker.js";

/** @import { Message } from "mp/message.js" */
/** @typedef {{onevent: (event: Message) => void, onlost: (error: SessionError) => void, replay: () => Uint8Array[]}} Owner
 *  `replay`: the requests that bring a fresh session to the state of this one */
/** @typedef {{send: (bytes: Uint8Array<ArrayBuffer>, request: Message) => Promise<Uint8Array>, close: () => void,
 *  reconnect: () => Promise<void>}} Link  messages to the planner and back */

/** How long a run may take to end after a cancel before its worker is ended, milliseconds: a cancel has an effect within 100. */
const PATIENCE = 90;
/** Requests about one run. */
const OF_RUN = ["pause", "resume", "step", "cancel"];
/** Events that end a run. */
const ENDS = ["done", "timed", "failed"];

/** Why a request failed, and what to do. */
export class SessionError extends Error {
  /** @param {string} message @param {string | null} [help] @param {boolean} [gone] whether the planner does not answer at all */
  constructor(message, help = null, gone = false) {
    super(message);
    this.help = help; this.gone = gone;
  }
}

const gone = (/** @type {string} */ why) =>
  new SessionError(`The planner's server does not answer: ${why}.`, "What is shown stays. Press “Reconnect”; if the server was ended, start “mp view” again and open its new address.", true);

/** What the server says when it refuses. @param {Response} answer */
async function refusal(answer) {
  const why = (await answer.text().catch(() => "")).trim();
  return new SessionError(why || `The planner's server refused a request (${answer.status}).`);
}

/** The messages of a stream: each a length and its bytes. @param {ReadableStreamDefaultReader<Uint8Array>} reader */
export async function* framesOf(reader) {
  let rest = new Uint8Array(0);
  const take = async (/** @type {number} */ count) => {
    const out = new Uint8Array(count);
    let at = 0;
    while (at < count) {
      if (!rest.length) {
        const { done, value } = await reader.read();
        if (done) return null;
        rest = new Uint8Array(value);
      }
      const part = rest.subarray(0, count - at);
      out.set(part, at);
      at += part.length;
      rest = rest.subarray(part.length);
    }
    return out;
  };
  for (;;) {
    const length = await take(4);
    const message = length && (await take(new DataView(length.buffer).getUint32(0, true)));
    if (!message) return;
    yield message;
  }
}

/** A session behind the server that this page comes from. @implements {Link} */
class ServerLink {
  constructor(/** @type {Owner} */ owner) {
    this.owner = owner;
    /** @type {AbortController | null} */ this.stream = null;
    this.session = this.connect();
    this.session.catch(() => {});
  }
  /** Opens the stream of events; its first event names the session. @returns {Promise<string>} */
  connect() {
    const stream = (this.stream = new AbortController());
    return new Promise((resolve, reject) => {
      const lost = (/** @type {unknown} */ error) => {
        if (stream.signal.aborted) return;
        stream.abort();
        const why = error instanceof SessionError ? error : gone(error instanceof Error ? error.message : String(error));
        reject(why);
        this.owner.onlost(why);
      };
      this.listen(stream.signal, resolve).then(() => lost("the connection was closed"), lost);
    });
  }
  /** @param {AbortSignal} signal @param {(session: string) => void} named */
  async listen(signal, named) {
    const answer = await fetch("events", { signal, cache: "no-store" });
    if (!answer.ok || !answer.body) throw await refusal(answer);
    for await (const bytes of framesOf(answer.body.getReader())) {
      const event = decode(bytes, "message");
      if (event.event === "hello") named(String(event.session));
      else this.owner.onevent(event);
    }
  }
  /** @param {Uint8Array<ArrayBuffer>} bytes */
  async send(bytes) {
    const session = await this.session;
    const signal = this.stream?.signal;
    if (signal?.aborted) throw gone("the connection was closed");
    const answer = await fetch(`message/${encodeURIComponent(session)}`, { method: "POST", body: bytes, signal }).catch((error) => {
      throw gone(error instanceof Error ? error.message : String(error));
    });
    if (!answer.ok) throw await refusal(answer);
    return new Uint8Array(await answer.arrayBuffer());
  }
  async reconnect() {
    this.close();
    this.session = this.connect();
    this.session.catch(() => {});
    for (const bytes of this.owner.replay()) await this.send(/** @type {Uint8Array<ArrayBuffer>} */ (bytes));
  }
  close() { this.stream?.abort(); }
}

/** The planner inside the page. One worker answers requests; each run has a worker of its own. @implements {Link} */
class WorkerLink {
  /** @param {Promise<WebAssembly.Module>} module @param {Owner} owner */
  constructor(module, owner) {
    this.module = module; this.owner = owner;
    /** @type {Promise<PlannerWorker> | null} */ this.main = null;
    /** @type {Map<number, PlannerWorker>} */ this.runs = new Map();
    /** Called when a run ends. @type {Map<number, () => void>} */ this.ended = new Map();
  }
  /** A worker in the state of the session. @param {(bytes: Uint8Array) => void} onevent @param {(text: string) => void} onfault
   * @param {(worker: PlannerWorker) => void} made is called at once, before the state is there */
  async worker(onevent, onfault, made) {
    const worker = new PlannerWorker(await this.module, onevent, onfault);
    made(worker);
    for (const bytes of this.owner.replay()) await worker.send(bytes);
    return worker;
  }
  /** @param {Uint8Array} bytes @param {Message} request @returns {Promise<Uint8Array>} */
  async send(bytes, request) {
    if (request.do === "plan" || request.do === "time") return this.plan(bytes, request.run);
    if (OF_RUN.includes(request.do)) return this.toRun(bytes, request);
    if (request.do === "export" && request.format === "html") return this.exportPage(request);
    // A worker that stopped by a fault is replaced by the next request.
    this.main ??= this.worker(() => {}, () => (this.main = null), () => {});
    const forget = (/** @type {unknown} */ error) => {
      this.main = null;
      throw stopped(error instanceof Error ? error.message : String(error));
    };
    return this.main.then((worker) => worker.send(bytes)).catch(forget);
  }
  /** This page with what is asked for: the planner gives the scene, and the page has the rest. @param {Message} request */
  async exportPage(request) {
    const asked = { ...request, format: "mpv" };
    const reply = /** @type {Message} */ (decode(await this.send(encode(asked), asked), "message"));
    for (const file of reply.files ?? []) {
      file.name = file.name.replace(/mpv$/, "html");
      file.bytes = await pageWith(file.bytes);
    }
    return encode(reply);
  }
  /** @param {Uint8Array} bytes @param {number} run */
  async plan(bytes, run) {
    const end = (/** @type {Message} */ event) => {
      if (this.runs.delete(run)) this.owner.onevent(event);
      this.ended.get(run)?.();
      this.ended.delete(run);
    };
    const onevent = (/** @type {Uint8Array} */ message) => {
      const event = decode(message, "message");
      if (!ENDS.includes(String(event.event))) return this.owner.onevent(event);
      this.runs.get(run)?.end("The run has ended.");
      end(event);
    };
    const onfault = (/** @type {string} */ text) => {
      const { message, help } = stopped(text);
      end({ event: "failed", run, message, help });
    };
    const refuse = (/** @type {Error} */ error) => { throw stopped(error.message); };
    const worker = await this.worker(onevent, onfault, (made) => this.runs.set(run, made)).catch(refuse);
    const reply = await worker.send(bytes).catch(refuse);
    if (decode(reply, "message").error) {
      this.runs.delete(run);
      worker.end("The run was refused.");
    }
    return reply;
  }
  /** @param {Uint8Array} bytes @param {Message} request */
  async toRun(bytes, { do: what, run }) {
    const worker = this.runs.get(run);
    if (!worker) throw new SessionError("This run has ended.");
    if (what !== "cancel") return worker.send(bytes);
    // A search is interrupted at once, but what finishes a path may be long.
    const end = new Promise((resolve) => this.ended.set(run, () => resolve(true)));
    const late = new Promise((resolve) => setTimeout(resolve, PATIENCE, false));
    worker.send(bytes).catch(() => {});
    if (await Promise.race([end, late])) return encode({});
    this.ended.delete(run);
    if (this.runs.delete(run)) this.owner.onevent({ event: "failed", run, cancelled: true, message: "The run was cancelled.", help: null });
    worker.end("The run was cancelled.");
    return encode({});
  }
  async reconnect() {}

  close() {
    this.main?.then((worker) => worker.end("The page closed its planner.")).catch(() => {});
    for (const worker of this.runs.values()) worker.end("The page closed its planner.");
    this.runs.clear();
  }
}

const stopped = (/** @type {string} */ why) =>
  new SessionError(`The planner inside this page stopped: ${why}.`, "What is shown stays, and the next request starts the planner again. If the scene is large, use the program “mp view”, which has more memory.", true);

export class Session {
  /** @param {(owner: Owner) => Link} connect */
  constructor(connect) {
    /** Is called with each event. @type {(event: Message) => void} */ this.onevent = () => {};
    /** Is called when the planner is gone. @type {(error: SessionError) => void} */ this.onlost = () => {};
    /** @type {{what: string, bytes: Uint8Array}[]} */ this.history = [];
    this.link = connect({
      onevent: (event) => this.onevent(event),
      onlost: (error) => this.onlost(error),
      replay: () => this.history.map(({ bytes }) => bytes),
    });
  }
  /** Sends a request, which may hold typed arrays anywhere, and returns the reply, with typed arrays in place. Rejects with a
   * `SessionError`. @param {Message} request @returns {Promise<Message>} */
  async request(request) {
    const bytes = encode(request);
    const reply = /** @type {Message} */ (decode(await this.link.send(bytes, request), "message"));
    if (reply.error) throw new SessionError(String(reply.error.message), reply.error.help ?? null);
    this.remember(request.do, bytes);
    return reply;
  }
  /** Keeps the requests that make the present state: what was opened, the meshes added, the last edit, the parts of the motion that are done. @param {string} what @param {Uint8Array} bytes */
  remember(what, bytes) {
    if (what === "open" || what === "hello") this.history = [{ what, bytes }];
    if (what === "edit") this.history = this.history.filter((h) => h.what !== "edit");
    if (what === "edit" || what === "mesh" || what === "next") this.history.push({ what, bytes });
  }
  /** Connects again after `onlost`, to the same state. */
  reconnect() { return this.link.reconnect(); }

  close() { this.link.close(); }
}

/** The session that this page is made for, or null: such a page only shows. @returns {Session | null} */
export function sessionOfPage() {
  if (document.querySelector('meta[name="mp-session"][content="server"]')) return new Session((owner) => new ServerLink(owner));
  const packed = document.getElementById("planner")?.textContent;
  if (!packed) return null;
  const module = unpack(packed).then((bytes) => WebAssembly.compile(/** @type {BufferSource} */ (bytes)));
  module.catch(() => {});
  return new Session((owner) => new WorkerLink(module, owner));
}
