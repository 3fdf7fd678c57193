/** What the page knows of the machine: answers to its text as it is now and as it was kept last. */

import type { Answers, MachineDialogue } from "./editor/questions";
import { Abandoned, Newest } from "./evaluator/newest";
import {
  accepted,
  type Chain,
  type Diagnostic,
  type ErrorNumber,
  type Evaluator,
  type Over,
  type Part,
  type Question,
  refusals,
  DEFAULTS,
  type Request,
  type Settings,
  type Sources,
  type StatedPart,
  type VolumeMap,
} from "./evaluator/types";

/** Answers to one text. */
export interface Findings {
  chain: Chain;
  /** The errors of its axes, in words by name. */
  words: Record<string, string>;
  /** Errors that are one number, in this file or in one that it reads. */
  numbers: Record<string, ErrorNumber>;
  map: VolumeMap | null;
  /** Why there is no map. */
  refused: string[];
  sources: Sources | null;
  budget: Budget | null;
}

/** True if errors have values; else what bounds lead to decides. */
function isMeasured({ map, sources }: Findings): boolean {
  return map !== null && map.from !== "bounds" && !!sources?.errors.length;
}

/** True for the findings of the text as it is, with all effort: the time to ask what takes longer. */
export function isSettled(state: State): state is State & { now: Findings } {
  return state.now !== null && !state.stale && !state.effort.draft;
}

/** A part in place of the volume, with texts of files that are not on the disk. */
export interface Scope {
  asked: Part | StatedPart;
  more: Record<string, string>;
}

/** The parts of a budget that are shown. */
export interface Budget {
  over: Over;
  poses: number;
  samples: number;
  statistic: string;
  position_um: {
    rss: number;
    worst_case: number;
    monte_carlo: { percentiles: Record<string, { value: number; low: number; high: number }> };
  };
  tighten: { error: string; tolerance: number; unit: string; um_of_p95: number; um_of_p95_sigma: number }[];
}

/** How much is computed: little while a slider is held, all of it afterwards. */
export interface Effort {
  draft: boolean;
  /** True if a draft is of fewer poses, or of fewer drawn machines, than the figures are afterwards. */
  isReduced: boolean;
  /** True if no more than the size of an error or of a bound changes: the chain stays. */
  keepsChain: boolean;
  poses: number;
  samples: number;
}

export const FULL: Effort = { draft: false, isReduced: false, keepsChain: false, poses: 2000, samples: 1000 };

/** Of errors that are measured; what bounds lead to takes every drawn machine at every pose. */
const DRAFT = { poses: 2000, samples: 100 };
const BOUNDED_DRAFT = { ...DRAFT, poses: 300 };

/** Each error alone rests this many times as long as it took before the next: the map comes first. */
const BREAK = 3;

/** Largest number of poses of `sources`. */
const MOST_SOURCE_POSES = 10_000;

/** The state that the page shows. */
export interface State {
  effort: Effort;
  diagnostics: Diagnostic[];
  /** Of the last text that was accepted. */
  now: Findings | null;
  /** Of the text that was kept last, computed with the same effort. */
  kept: Findings | null;
  /** True if the present text is refused, so that `now` is of an earlier one. */
  stale: boolean;
}

interface Answered {
  diagnostics: Diagnostic[];
  findings: Findings | null;
}

/** Keeps asking for the newest text: while an answer is awaited, only the last of the wishes is remembered. */
export class Session {
  /** The part that figures are over; null for the volume. */
  over: () => Scope | null = () => null;
  /** Options of the figures. */
  settings: Settings = DEFAULTS;
  machine = "";
  kept = "";
  private text = "";
  private tool = "";
  /** By effort. */
  private readonly keptFindings = new Map<string, Findings | null>();
  private now: Findings | null = null;
  private wish: Effort | null = null;
  private busy = false;
  /** What was shown last. */
  private state: State | null = null;
  /** Ends what was asked while a slider was held, and what was asked at rest. */
  private drag = new AbortController();
  private still = new AbortController();
  private isHeld = false;
  /** Who waits for the figures to stand. */
  private readonly waiting: (() => void)[] = [];
  private readonly following: Newest;

  constructor(
    private readonly evaluator: Evaluator,
    private readonly show: (state: State) => void,
    private readonly failed: (message: string) => void,
    /** Hears when work begins, and when all that was wished for is shown. */
    private readonly working: (busy: boolean) => void,
  ) {
    this.following = new Newest((failure) => this.fail(failure));
  }

  /** Begins with a file as it is kept. */
  open(machine: string, text: string): void {
    this.machine = machine;
    this.now = null;
    this.keep(text);
    this.change(text, false);
  }

  /** The text is kept: differences are to this one from now on. */
  keep(text: string): void {
    this.kept = text;
    this.keptFindings.clear();
  }

  /** A file that the machine file names is another one. */
  refresh(): void {
    this.keptFindings.clear();
    this.change(this.text, false);
  }

  /** Takes another tool of the file; the first for an empty name. */
  take(tool: string): void {
    this.tool = tool;
    this.keptFindings.clear();
  }

  /** The text is another one; `draft` while a slider is held, which may keep the chain. */
  change(text: string, draft: boolean, keepsChain = false): void {
    this.text = text;
    this.isHeld = draft;
    this.still.abort();
    this.still = new AbortController();
    if (!draft) {
      this.drag.abort();
      this.drag = new AbortController();
    }
    this.wish = this.effort(draft, keepsChain);
    void this.work();
  }

  /** Asks about the text as it is now, or about another one; `more` are further files by name. */
  async ask(
    questions: Question[],
    more: Record<string, string> = {},
    text = this.text,
    signal?: AbortSignal,
  ): Promise<unknown[]> {
    const request = this.request(text, questions);
    return (await this.evaluator.ask({ ...request, texts: { ...more, ...request.texts } }, signal)).answers;
  }

  /** Asks what takes long, of the text at rest: a change of it ends the question as `Abandoned`. */
  async askAtRest(questions: Question[], more: Record<string, string> = {}): Promise<unknown[]> {
    const { signal } = this.still;
    // Another text is on its way.
    if (this.wish) throw new Abandoned(this.rest());
    return this.ask(questions, more, this.text, signal).catch((failure: unknown) => {
      throw signal.aborted ? new Abandoned(this.rest()) : failure;
    });
  }

  /** Asks about another machine file, as `askAtRest` does; of another than the open one its first tool counts. */
  async askAbout(
    machine: string,
    text: string,
    questions: Question[],
    more: Record<string, string>,
  ): Promise<unknown[]> {
    const { signal } = this.still;
    if (this.wish) throw new Abandoned(this.rest());
    const { over, texts, tool } = this.request(this.text, []);
    const all = { ...more, ...texts, [machine]: text };
    const own = machine === this.machine && tool ? { tool } : {};
    const request = { machine, texts: all, questions, ...own, ...(over ? { over } : {}) };
    return this.evaluator.ask(request, signal).then(
      ({ answers }) => answers,
      (failure: unknown) => {
        throw signal.aborted ? new Abandoned(this.rest()) : failure;
      },
    );
  }

  /** The questions of the headline and of what makes it, with all effort; `found` reads their answers. */
  questions(): Question[] {
    return this.figureQuestions(this.effort(false), true);
  }

  private rest(): Promise<void> {
    return new Promise((done) => {
      if (this.busy || this.isHeld) this.waiting.push(done);
      else setTimeout(done);
    });
  }

  /** The questions that answers lead to, whatever the text is. */
  async dialogue(dialogue: Answers): Promise<MachineDialogue> {
    const request = { machine: this.machine, texts: {}, dialogue, questions: [] };
    return (await this.evaluator.ask(request)).answers[0] as MachineDialogue;
  }

  /** Why no machine can be read from a text; empty for one from which it can, or where nobody answers. */
  async fault(text: string): Promise<string> {
    const { diagnostics } = await this.evaluator.ask(this.request(text, ["check"])).catch(() => ({ diagnostics: [] }));
    return diagnostics.find(({ severity }) => severity === "refusal")?.message ?? "";
  }

  /** The errors of the machine that was accepted last, in words by name. */
  get words(): Record<string, string> {
    return this.now?.words ?? {};
  }

  /** Name of a file in the folder of the machine. */
  beside(name: string): string {
    return this.machine.replace(/[^/\\]*$/, "") + name;
  }

  private effort(draft: boolean, keepsChain = false): Effort {
    const { poses, samples } = this.settings;
    if (!draft) return { ...FULL, poses, samples };
    const bounded = this.now?.map?.from === "bounds";
    const most = bounded ? BOUNDED_DRAFT : DRAFT;
    // The poses of a job are all taken.
    const isJob = this.now?.map?.over?.kind === "job";
    const few = { poses: isJob ? poses : Math.min(most.poses, poses), samples: Math.min(most.samples, samples) };
    return { draft, isReduced: few.poses < poses || (bounded && few.samples < samples), keepsChain, ...few };
  }

  private request(text: string, questions: Question[]): Request {
    const tool = this.tool ? { tool: this.tool } : {};
    const over = this.over();
    const texts = { ...over?.more, [this.machine]: text };
    return { machine: this.machine, texts, questions, ...tool, ...(over ? { over: over.asked } : {}) };
  }

  private async work(): Promise<void> {
    if (this.busy) return;
    this.busy = true;
    this.working(true);
    // After a failure the newest wish is still open.
    while (this.wish) await this.turn(this.wish).catch((failure: unknown) => this.fail(failure));
    this.busy = false;
    this.working(false);
    if (!this.isHeld) this.waiting.splice(0).forEach((done) => done());
  }

  private fail(failure: unknown): void {
    this.failed(failure instanceof Error ? failure.message : String(failure));
  }

  /** A turn at rest ends with a change of the text; one of a draft is shown however late it is. */
  private async turn(effort: Effort): Promise<void> {
    const signal = effort.draft ? undefined : this.still.signal;
    await this.figures(effort, signal).catch((failure: unknown) => {
      if (!signal?.aborted) throw failure;
    });
  }

  private async figures(effort: Effort, signal?: AbortSignal): Promise<void> {
    const text = this.text;
    this.wish = null;
    const held = effort.draft && this.now && isMeasured(this.now) ? this.now : null;
    const { diagnostics, findings } = await (held
      ? this.held(text, effort, held)
      : this.findings(text, effort, signal));
    if (findings) this.now = { ...findings, sources: held ? (this.now?.sources ?? null) : findings.sources };
    if (findings && !effort.draft && text === this.kept) this.keptFindings.set(JSON.stringify(effort), findings);
    const kept = await this.ofKept(effort, signal);
    this.state = { effort, diagnostics, now: this.now, kept, stale: !findings };
    this.show(this.state);
  }

  private async ofKept(effort: Effort, signal?: AbortSignal): Promise<Findings | null> {
    // The figures of a draft that is not reduced are those of full effort.
    const of = effort.isReduced ? { ...effort, keepsChain: false } : this.effort(false);
    const key = JSON.stringify(of);
    const known = this.keptFindings.get(key);
    if (known !== undefined) return known;
    const { findings } = await this.findings(this.kept, of, signal);
    this.keptFindings.set(key, findings);
    return findings;
  }

  /** Measured errors while a slider is held: the map at once; each error alone takes longer, and follows by itself. */
  private async held(text: string, effort: Effort, before: Findings): Promise<Answered> {
    const { signal } = this.drag;
    void this.following.do(() => this.follow(text, effort, signal));
    const questions = [this.map(effort), ...(effort.keepsChain ? [] : (["show"] as const))];
    const { diagnostics, answers } = await this.evaluator.ask(this.request(text, questions));
    const map = accepted<VolumeMap>(answers[0]);
    const chain = effort.keepsChain ? before.chain : accepted<Chain>(answers[1]);
    return { diagnostics, findings: map && chain && { ...before, map, chain, refused: [] } };
  }

  private async follow(text: string, effort: Effort, signal: AbortSignal): Promise<void> {
    // Let go before its turn: the figures of the whole are on their way.
    if (signal.aborted) return;
    const start = performance.now();
    const [answer] = await this.ask([this.sources(effort)], {}, text, signal).catch((failure: unknown) => {
      if (signal.aborted) return [];
      throw failure;
    });
    const took = performance.now() - start;
    const sources = accepted<Sources>(answer);
    if (sources && !signal.aborted) this.learn(sources);
    await new Promise((resolve) => setTimeout(resolve, took * BREAK));
  }

  private learn(sources: Sources): void {
    if (!this.now) return;
    this.now = { ...this.now, sources };
    if (this.busy || !this.state) return;
    this.state = { ...this.state, now: this.now };
    this.show(this.state);
  }

  private map({ poses, samples }: Effort): Question {
    return { map: { ...this.settings.map, poses: { random: poses }, worst: 5, samples } };
  }

  private sources({ poses }: Effort): Question {
    return { sources: { ...this.settings.sources, poses: Math.min(poses, MOST_SOURCE_POSES) } };
  }

  private async findings(text: string, effort: Effort, signal?: AbortSignal): Promise<Answered> {
    // A slider changes no name.
    const names = effort.draft ? this.now : null;
    const questions = this.figureQuestions(effort, !names);
    const { diagnostics, answers } = await this.evaluator.ask(this.request(text, questions), signal);
    const findings = findingsOf(answers);
    return { diagnostics, findings: names && findings ? { ...findings, ...named(names) } : findings };
  }

  private figureQuestions(effort: Effort, withNames: boolean): Question[] {
    return [
      "show",
      this.map(effort),
      { budget: { ...this.settings.budget, samples: effort.samples } },
      this.sources(effort),
      ...(withNames ? (["words", "numbers"] as const) : []),
    ];
  }
}

const named = ({ words, numbers }: Findings) => ({ words, numbers });

/** What the answers to the questions of the figures say; null where the machine is refused. */
export function findingsOf(answers: unknown[]): Findings | null {
  const chain = accepted<Chain>(answers[0]);
  if (!chain) return null;
  return {
    chain,
    map: accepted<VolumeMap>(answers[1]),
    refused: refusals(answers[1]),
    budget: accepted<Budget>(answers[2]),
    sources: accepted<Sources>(answers[3]),
    words: accepted<Record<string, string>>(answers[4]) ?? {},
    numbers: accepted<Record<string, ErrorNumber>>(answers[5]) ?? {},
  };
}
