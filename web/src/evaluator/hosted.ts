/** The library in workers, with files in memory: a second one starts when the first is busy, and shares the work. */

import type { FromWorker, ToWorker } from "./worker";
import type { Evaluator, Reply, Request } from "./types";
import EngineWorker from "./worker?worker&inline";

type Waiting = { kind: string; resolve: (reply: Reply) => void; reject: (failure: Error) => void };

/** What a question takes before one of its kind was answered, ms. */
const UNKNOWN = 20;

/** More of them would ask for more cores than a meeting's laptop has to spare. */
const MOST_WORKERS = 2;

export class Hosted implements Evaluator {
  private readonly engines: HostedEngine[] = [];
  /** What each kind of request took last, ms: quick ones do not wait behind long ones. */
  private readonly times = new Map<string, number>();

  constructor(
    private readonly module: WebAssembly.Module,
    private readonly files: Record<string, string>,
  ) {}

  ask(request: Request): Promise<Reply> {
    const kind = request.questions.map((of) => (typeof of === "string" ? of : Object.keys(of).join())).join();
    return this.free().ask(request, kind);
  }

  private free(): HostedEngine {
    const [free] = [...this.engines].sort((a, b) => a.load - b.load);
    const most = Math.min(MOST_WORKERS, navigator.hardwareConcurrency || 1);
    if (free && (free.load === 0 || this.engines.length >= most)) return free;
    const started = new HostedEngine(this.module, this.files, this.times);
    this.engines.push(started);
    return started;
  }
}

/** An engine in a worker. */
class HostedEngine {
  private readonly waiting = new Map<number, Waiting>();
  private worker: Worker;
  private last = 0;

  constructor(
    private readonly module: WebAssembly.Module,
    private readonly files: Record<string, string>,
    private readonly times: Map<string, number>,
  ) {
    this.worker = this.started();
  }

  /** What the requests without an answer will take, ms. */
  get load(): number {
    return [...this.waiting.values()].reduce((sum, { kind }) => sum + (this.times.get(kind) ?? UNKNOWN), 0);
  }

  ask(request: Request, kind: string): Promise<Reply> {
    const id = ++this.last;
    this.send({ id, request: JSON.stringify(request) });
    return new Promise((resolve, reject) => this.waiting.set(id, { kind, resolve, reject }));
  }

  private send(message: ToWorker): void {
    this.worker.postMessage(message);
  }

  private started(): Worker {
    const worker = new EngineWorker();
    worker.onmessage = (event: MessageEvent<FromWorker>) => this.receive(event.data);
    worker.postMessage({ module: this.module, files: Object.entries(this.files) } satisfies ToWorker);
    return worker;
  }

  private receive(message: FromWorker): void {
    const waiting = this.waiting.get(message.id);
    this.waiting.delete(message.id);
    if ("reply" in message) {
      if (waiting) this.times.set(waiting.kind, Math.max(message.ms, 1));
      return waiting?.resolve(JSON.parse(message.reply) as Reply);
    }
    waiting?.reject(new Error(`the engine stopped (${message.failure}); it was started anew`));
    // A trap leaves the engine's memory as it was in the middle of a call.
    this.worker.terminate();
    this.waiting.forEach((other) => other.reject(new Error("the engine was started anew")));
    this.waiting.clear();
    this.worker = this.started();
  }
}
