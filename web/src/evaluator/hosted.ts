/** The library in workers, with files in memory: a second one starts when the first is busy, or for a request to share. */

import { isDivisible, kindOf, together } from "./division";
import type { Evaluator, Reply, Request } from "./types";
import type { Asked, FromWorker, ToWorker } from "./worker";
import EngineWorker from "./worker?worker&inline";

interface Waiting {
  kind: string;
  resolve: (message: FromWorker) => void;
  reject: (failure: Error) => void;
}

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
    const first = this.free() ?? this.soonest();
    const second = first.load === 0 && isDivisible(request) ? this.free(first) : null;
    return second ? together(request, first, second) : first.ask(request);
  }

  /** Returns an engine that does nothing, besides another one; starts it if need be. */
  private free(besides?: HostedEngine): HostedEngine | null {
    const free = this.engines.find((engine) => engine.load === 0 && engine !== besides);
    const most = Math.min(MOST_WORKERS, navigator.hardwareConcurrency || 1);
    if (free || this.engines.length >= most) return free ?? null;
    const started = new HostedEngine(this.module, this.files, this.times);
    this.engines.push(started);
    return started;
  }

  private soonest(): HostedEngine {
    return this.engines.reduce((best, engine) => (engine.load < best.load ? engine : best));
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

  async ask(request: Request, parts: Uint8Array<ArrayBuffer>[] = []): Promise<Reply> {
    const kind = request.questions.map(kindOf).join();
    const message = await this.send(kind, { request: JSON.stringify(request), parts });
    if (!("reply" in message)) throw new Error("the engine answered another question");
    this.times.set(kind, Math.max(message.ms, 1));
    return JSON.parse(message.reply) as Reply;
  }

  async part(request: Request, index: number, count: number): Promise<Uint8Array<ArrayBuffer>> {
    const message = await this.send("part", { request: JSON.stringify(request), part: [index, count] });
    if (!("bytes" in message)) throw new Error("the engine answered another question");
    return message.bytes;
  }

  private send(kind: string, asked: Asked): Promise<FromWorker> {
    const id = ++this.last;
    const transfer = "parts" in asked ? asked.parts.map((part) => part.buffer) : [];
    this.worker.postMessage({ id, ...asked } satisfies ToWorker, transfer);
    return new Promise((resolve, reject) => this.waiting.set(id, { kind, resolve, reject }));
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
    if (!("failure" in message)) return waiting?.resolve(message);
    waiting?.reject(new Error(`the engine stopped (${message.failure}); it was started anew`));
    // A trap leaves the engine's memory as it was in the middle of a call.
    this.worker.terminate();
    this.waiting.forEach((other) => other.reject(new Error("the engine was started anew")));
    this.waiting.clear();
    this.worker = this.started();
  }
}
