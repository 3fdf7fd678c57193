/** What the page knows of the machine: answers to its text as it is now and as it was kept last. */

import {
  accepted,
  type Chain,
  type Diagnostic,
  type ErrorNumber,
  type Evaluator,
  type Question,
  DEFAULTS,
  type Request,
  type Settings,
  type Sources,
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
  sources: Sources | null;
  budget: Budget | null;
}

/** True for the findings of the text as it is, with all effort: the time to ask what takes longer. */
export function isSettled(state: State): state is State & { now: Findings } {
  return state.now !== null && !state.stale && !state.effort.draft;
}

/** The parts of a budget that are shown. */
export interface Budget {
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
  poses: number;
  samples: number;
}

export const FULL: Effort = { draft: false, poses: 2000, samples: 1000 };

/** Of errors that are measured; what bounds lead to takes every drawn machine at every pose. */
const DRAFT: Effort = { draft: true, poses: 2000, samples: 100 };
const BOUNDED_DRAFT: Effort = { ...DRAFT, poses: 300 };

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

/** Keeps asking for the newest text: while an answer is awaited, only the last of the wishes is remembered. */
export class Session {
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

  constructor(
    private readonly evaluator: Evaluator,
    private readonly show: (state: State) => void,
    private readonly failed: (message: string) => void,
    /** Hears when work begins, and when all that was wished for is shown. */
    private readonly working: (busy: boolean) => void,
  ) {}

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

  change(text: string, draft: boolean): void {
    this.text = text;
    this.wish = this.effort(draft);
    void this.work();
  }

  /** Asks about the text as it is now, or about another one; `more` are further files by name. */
  async ask(questions: Question[], more: Record<string, string> = {}, text = this.text): Promise<unknown[]> {
    const request = this.request(text, questions);
    return (await this.evaluator.ask({ ...request, texts: { ...more, ...request.texts } })).answers;
  }

  /** The errors of the machine that was accepted last, in words by name. */
  get words(): Record<string, string> {
    return this.now?.words ?? {};
  }

  /** Name of a file in the folder of the machine. */
  beside(name: string): string {
    return this.machine.replace(/[^/\\]*$/, "") + name;
  }

  private effort(draft: boolean): Effort {
    const { poses, samples } = this.settings;
    if (!draft) return { ...FULL, poses, samples };
    const few = this.now?.map?.from === "bounds" ? BOUNDED_DRAFT : DRAFT;
    return { draft, poses: Math.min(few.poses, poses), samples: Math.min(few.samples, samples) };
  }

  private request(text: string, questions: Question[]): Request {
    const tool = this.tool ? { tool: this.tool } : {};
    return { machine: this.machine, texts: { [this.machine]: text }, questions, ...tool };
  }

  private async work(): Promise<void> {
    if (this.busy) return;
    this.busy = true;
    this.working(true);
    try {
      while (this.wish) await this.turn(this.wish);
    } catch (failure) {
      this.failed(failure instanceof Error ? failure.message : String(failure));
    }
    this.busy = false;
    this.working(false);
  }

  private async turn(effort: Effort): Promise<void> {
    const text = this.text;
    this.wish = null;
    const { diagnostics, findings } = await this.findings(text, effort);
    if (findings) this.now = findings;
    const kept = await this.ofKept(effort);
    this.show({ effort, diagnostics, now: this.now, kept, stale: !findings });
  }

  private async ofKept(effort: Effort): Promise<Findings | null> {
    const key = JSON.stringify(effort);
    const known = this.keptFindings.get(key);
    if (known !== undefined) return known;
    const { findings } = await this.findings(this.kept, effort);
    this.keptFindings.set(key, findings);
    return findings;
  }

  private async findings(
    text: string,
    { draft, poses, samples }: Effort,
  ): Promise<{ diagnostics: Diagnostic[]; findings: Findings | null }> {
    const { map, sources, budget } = this.settings;
    // A slider changes no name.
    const names = draft ? this.now : null;
    const questions: Question[] = [
      "show",
      { map: { ...map, poses: { random: poses }, worst: 5, samples } },
      { budget: { ...budget, samples } },
      { sources: { ...sources, poses: Math.min(poses, MOST_SOURCE_POSES) } },
      ...(names ? [] : (["words", "numbers"] as const)),
    ];
    const { diagnostics, answers } = await this.evaluator.ask(this.request(text, questions));
    const chain = accepted<Chain>(answers[0]);
    if (!chain) return { diagnostics, findings: null };
    const findings = {
      chain,
      map: accepted<VolumeMap>(answers[1]),
      budget: accepted<Budget>(answers[2]),
      sources: accepted<Sources>(answers[3]),
      words: names?.words ?? accepted<Record<string, string>>(answers[4]) ?? {},
      numbers: names?.numbers ?? accepted<Record<string, ErrorNumber>>(answers[5]) ?? {},
    };
    return { diagnostics, findings };
  }
}
