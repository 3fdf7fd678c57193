/** The library in a worker, with the examples that lie beside the page. */

import type { FromWorker, ToWorker } from "./worker";
import type { Evaluator, OpenFile, Reply, Request, Store } from "./types";
import { save as download } from "../ui/download";
import EngineWorker from "./worker?worker&inline";

/** Examples beside the page: names of machine files, and all files by name. */
interface Examples {
  machines: string[];
  files: Record<string, string>;
}

type Waiting = { resolve: (reply: Reply) => void; reject: (failure: Error) => void };

export class Playground implements Evaluator, Store {
  readonly verb = "Download";
  private readonly waiting = new Map<number, Waiting>();
  private worker: Worker;
  private last = 0;

  private constructor(
    private readonly module: WebAssembly.Module,
    readonly examples: Examples,
    public chosen: string,
  ) {
    this.worker = this.started();
  }

  /** Loads engine and examples; `chosen` is the name of one of them, or empty. */
  static async load(chosen: string): Promise<Playground> {
    const [module, examples] = await Promise.all([
      WebAssembly.compileStreaming(fetch("engine.wasm")),
      fetch("examples.json").then((response) => response.json() as Promise<Examples>),
    ]);
    const known = examples.machines.includes(chosen) ? chosen : "trunnion.yaml";
    return new Playground(module, examples, known);
  }

  ask(request: Request): Promise<Reply> {
    const id = ++this.last;
    this.send({ id, request: JSON.stringify(request) });
    return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
  }

  open(): Promise<OpenFile> {
    return Promise.resolve({ machine: this.chosen, text: this.examples.files[this.chosen] ?? "" });
  }

  save(text: string): Promise<void> {
    download(this.chosen.split("/").pop() ?? "machine.yaml", new Blob([text], { type: "application/yaml" }));
    return Promise.resolve();
  }

  private send(message: ToWorker): void {
    this.worker.postMessage(message);
  }

  private started(): Worker {
    const worker = new EngineWorker();
    worker.onmessage = (event: MessageEvent<FromWorker>) => this.receive(event.data);
    worker.postMessage({ module: this.module, files: Object.entries(this.examples.files) } satisfies ToWorker);
    return worker;
  }

  private receive(message: FromWorker): void {
    const waiting = this.waiting.get(message.id);
    this.waiting.delete(message.id);
    if ("reply" in message) return waiting?.resolve(JSON.parse(message.reply) as Reply);
    waiting?.reject(new Error(`the engine stopped (${message.failure}); it was started anew`));
    // A trap leaves the engine's memory as it was in the middle of a call.
    this.worker.terminate();
    this.waiting.forEach((other) => other.reject(new Error("the engine was started anew")));
    this.waiting.clear();
    this.worker = this.started();
  }
}
