/** The worker of the playground: holds the engine and the files of the examples. */

import { Engine } from "./engine";

/** A request: all of it, perhaps with the parts of its map, or one part of its map. */
export type Asked =
  { request: string; parts: Uint8Array<ArrayBuffer>[] } | { request: string; part: [index: number, count: number] };

/** What the page sends: first the module with the files, then requests. */
export type ToWorker = { module: WebAssembly.Module; files: [string, string][] } | ({ id: number } & Asked);

export type FromWorker =
  | { id: number; reply: string; ms: number }
  | { id: number; bytes: Uint8Array<ArrayBuffer> }
  | { id: number; failure: string };

let engine: Promise<Engine> | undefined;

async function start(module: WebAssembly.Module, files: [string, string][]): Promise<Engine> {
  const started = await Engine.of(module);
  for (const [name, text] of files) started.put(name, text);
  return started;
}

async function answer(message: { id: number } & Asked): Promise<FromWorker> {
  const { id, request } = message;
  try {
    if (!engine) throw new Error("the engine was not started");
    const ready = await engine;
    if ("part" in message) return { id, bytes: ready.part(request, ...message.part) };
    const start = performance.now();
    const reply = ready.ask(request, message.parts);
    return { id, reply, ms: performance.now() - start };
  } catch (failure) {
    return { id, failure: String(failure) };
  }
}

self.onmessage = async (event: MessageEvent<ToWorker>) => {
  const message = event.data;
  if ("module" in message) {
    engine = start(message.module, message.files);
    return;
  }
  const answered = await answer(message);
  self.postMessage(answered, { transfer: "bytes" in answered ? [answered.bytes.buffer] : [] });
};
