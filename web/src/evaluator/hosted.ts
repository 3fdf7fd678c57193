/** The library in workers, with files in memory: a second one starts when the first is busy, or for a request to share. */

import { isDivisible, kindOf, together } from "./division";
import type { Evaluator, Reply, Request } from "./types";
import type { Asked, FromWorker, ToWorker } from "./worker";
import EngineWorker from "./worker?worker&inline";

/** A question of an engine, until it is answered. */
interface Waiting {
  id: number;
  kind: string;
  asked: Asked;
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

  ask(request: Request, signal?: AbortSignal): Promise<Reply> {
    const first = this.free() ?? this.soonest();
    const second = first.load === 0 && isDivisible(request) ? this.free(first) : null;
    return second ? together(request, [first, second], signal) : first.ask(request, signal);
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
  /** The worker has the first of them. */
  private readonly waiting: Waiting[] = [];
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
    return this.waiting.reduce((sum, { kind }) => sum + (this.times.get(kind) ?? UNKNOWN), 0);
  }

  async ask(request: Request, signal?: AbortSignal, parts: Uint8Array<ArrayBuffer>[] = []): Promise<Reply> {
    const kind = request.questions.map(kindOf).join();
    const message = await this.send(kind, { request: JSON.stringify(request), parts }, signal);
    if (!("reply" in message)) throw new Error("the engine answered another question");
    this.times.set(kind, Math.max(message.ms, 1));
    return JSON.parse(message.reply) as Reply;
  }

  async part(request: Request, index: number, count: number, signal?: AbortSignal): Promise<Uint8Array<ArrayBuffer>> {
    const message = await this.send("part", { request: JSON.stringify(request), part: [index, count] }, signal);
    if (!("bytes" in message)) throw new Error("the engine answered another question");
    return message.bytes;
  }

  private send(kind: string, asked: Asked, signal?: AbortSignal): Promise<FromWorker> {
    signal?.throwIfAborted();
    return new Promise((resolve, reject) => {
      const waiting = { id: ++this.last, kind, asked, resolve, reject };
      signal?.addEventListener("abort", () => this.abandon(waiting, signal), { once: true });
      if (this.waiting.push(waiting) === 1) this.next();
    });
  }

  private next(): void {
    const [first] = this.waiting;
    if (!first) return;
    const { id, asked } = first;
    const transfer = "parts" in asked ? asked.parts.map((part) => part.buffer) : [];
    this.worker.postMessage({ id, ...asked } satisfies ToWorker, transfer);
  }

  /** Nobody waits for the answer: a call that runs ends with its worker. */
  private abandon(waiting: Waiting, signal: AbortSignal): void {
    const place = this.waiting.indexOf(waiting);
    if (place < 0) return;
    this.waiting.splice(place, 1);
    waiting.reject(signal.reason as Error);
    if (place === 0) this.restart();
  }

  private restart(): void {
    this.worker.terminate();
    this.worker = this.started();
    this.next();
  }

  private started(): Worker {
    const worker = new EngineWorker();
    worker.onmessage = (event: MessageEvent<FromWorker>) => this.receive(event.data);
    worker.postMessage({ module: this.module, files: Object.entries(this.files) } satisfies ToWorker);
    return worker;
  }

  private receive(message: FromWorker): void {
    const [first] = this.waiting;
    // The last word of a worker that was ended.
    if (first?.id !== message.id) return;
    this.waiting.shift();
    if (!("failure" in message)) {
      first.resolve(message);
      return this.next();
    }
    first.reject(new Error(`the engine stopped (${message.failure}); it was started anew`));
    // A trap leaves the engine's memory as it was in the middle of a call.
    this.restart();
  }
}
