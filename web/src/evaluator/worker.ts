/** The worker of the playground: holds the engine and the files of the examples. */

import { Engine } from "./engine";

/** What the page sends: first the module with the files, then requests. */
export type ToWorker = { module: WebAssembly.Module; files: [string, string][] } | { id: number; request: string };

export type FromWorker = { id: number; reply: string; ms: number } | { id: number; failure: string };

let engine: Promise<Engine> | undefined;

async function start(module: WebAssembly.Module, files: [string, string][]): Promise<Engine> {
  const started = await Engine.of(module);
  for (const [name, text] of files) started.put(name, text);
  return started;
}

async function answer(id: number, request: string): Promise<FromWorker> {
  try {
    if (!engine) throw new Error("the engine was not started");
    const ready = await engine;
    const start = performance.now();
    const reply = ready.ask(request);
    return { id, reply, ms: performance.now() - start };
  } catch (failure) {
    return { id, failure: String(failure) };
  }
}

self.onmessage = async (event: MessageEvent<ToWorker>) => {
  const message = event.data;
  if ("module" in message) engine = start(message.module, message.files);
  else self.postMessage(await answer(message.id, message.request));
};
