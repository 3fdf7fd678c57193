/**
 * A report in one file: its machines with the answers that the program gave when it wrote the page. What is asked
 * beyond these is answered by the engine in the page, if it has one.
 */

import { kindOf } from "./division";
import { Hosted } from "./hosted";
import { unpacked } from "./packed";
import type {
  Evaluated,
  Evaluator,
  OpenFile,
  Question,
  Reply,
  Request,
  Rows,
  Settings,
  StatedPart,
  Store,
} from "./types";
import { type Variant, variants } from "./variants";
import { save as download } from "../ui/download";

/** A machine of the report. */
interface ReportMachine {
  machine: string;
  tool: string | null;
  text: string;
  /** Answers over the part, and where there is one over the volume. */
  known: { question: Question; answer: unknown; over: Request["over"] | null }[];
  /** At poses that the page leads to; `rows` of a machine that is only bounded, with this number of drawn machines. */
  eval: { poses: number[][]; answer: Evaluated | undefined; samples: number; rows: Rows | null };
}

/** What the program put into the page. */
export interface ReportStart {
  abbe: string;
  settings: Settings;
  files: Record<string, string>;
  machines: ReportMachine[];
  place: { work: string | null; target: string | null; asked: StatedPart };
}

/** Why a question has no answer. */
const NONE = "This page holds no answer to that, and no engine to compute it: open the file with `abbe workbench`.";

export class Report implements Evaluator, Store {
  readonly verb = "Download";
  readonly isReadOnly: boolean;
  readonly choices: string[];
  /** Says whether the page answers by itself. */
  note: string;
  private engine: Promise<Hosted | null> | null = null;

  constructor(
    private readonly start: ReportStart,
    public chosen: string,
    private readonly told: (note: string) => void,
  ) {
    this.choices = start.machines.map(({ machine }) => machine);
    if (!this.choices.includes(chosen)) this.chosen = this.choices[0] ?? "";
    this.isReadOnly = !/'wasm-unsafe-eval'/.test(policy());
    this.note = this.isReadOnly
      ? `State as written by abbe ${start.abbe}, read only: no engine in the page`
      : "Answers what-ifs by itself";
  }

  get settings(): Settings {
    return this.start.settings;
  }

  /** What the report states of the part besides its file. */
  get part(): StatedPart {
    return this.start.place.asked;
  }

  /** The machines besides the one that is chosen: those behind it, then those before it. */
  get others(): { machine: string; text: string }[] {
    const { machines } = this.start;
    const at = machines.findIndex(({ machine }) => machine === this.chosen);
    return [...machines.slice(at + 1), ...machines.slice(0, Math.max(at, 0))];
  }

  /** Name of the tool that the report is about; empty for the first. */
  get tool(): string {
    return this.machine?.tool ?? "";
  }

  open(): Promise<OpenFile> {
    return Promise.resolve({ machine: this.chosen, text: this.machine?.text ?? "" });
  }

  save(text: string): Promise<void> {
    download(this.chosen.split(/[/\\]/).pop() ?? "machine.yaml", new Blob([text], { type: "application/yaml" }));
    return Promise.resolve();
  }

  async ask(request: Request, signal?: AbortSignal): Promise<Reply> {
    const known = this.known(request);
    if (known && known.every((answer) => answer !== undefined)) return { diagnostics: [], answers: known };
    this.engine ??= this.load();
    const engine = await this.engine;
    if (engine) return engine.ask(request, signal);
    if (!known) throw new Error(NONE);
    return { diagnostics: [], answers: known.map((answer) => answer ?? refusal()) };
  }

  private get machine(): ReportMachine | undefined {
    return this.start.machines.find(({ machine }) => machine === this.chosen);
  }

  /** Answers that the page holds, `undefined` for others; none at all if the request is about another text. */
  private known(request: Request): unknown[] | null {
    if (request.dialogue) return null;
    const machine = this.start.machines.find((of) => of.machine === request.machine);
    const own = Object.fromEntries(this.start.machines.map((of) => [of.machine, of.text]));
    const isOwn = Object.entries(request.texts).every(([name, text]) => (own[name] ?? this.start.files[name]) === text);
    if (!machine || !isOwn || (request.tool ?? machine.tool) !== machine.tool) return null;
    return request.questions.map((question) => answer(machine, question, request.over));
  }

  /** Unpacks the engine and compares its answers with those of the program. */
  private async load(): Promise<Hosted | null> {
    if (this.isReadOnly) return null;
    for (const variant of variants()) {
      const packed = document.getElementById(`engine-${variant}`)?.textContent;
      const engine = packed ? await this.started(packed).catch(() => null) : null;
      if (engine) return this.tell(variant, engine);
    }
    this.told("The engine in the page does not run here, or answers otherwise than the program");
    return null;
  }

  private tell(variant: Variant, engine: Hosted): Hosted {
    const how = variant === "relaxed" ? "relaxed SIMD" : "plain WebAssembly";
    this.told(`${this.note}: abbe ${this.start.abbe}, ${how}`);
    return engine;
  }

  private async started(packed: string): Promise<Hosted | null> {
    const module = await WebAssembly.compile(await unpacked(packed, "gzip").arrayBuffer());
    const engine = new Hosted(module, this.start.files);
    return (await this.agrees(engine)) ? engine : null;
  }

  /** Compares the deviations at the poses that the program computed, character by character. */
  private async agrees(engine: Hosted): Promise<boolean> {
    const [machine] = this.start.machines;
    if (!machine?.eval.answer) return true;
    const { machine: name, tool, eval: known } = machine;
    const questions: Question[] = [{ eval: { poses: known.poses } }];
    const reply = await engine.ask({ machine: name, texts: {}, questions, ...(tool === null ? {} : { tool }) });
    const poses = (of: unknown) => JSON.stringify((of as Evaluated | undefined)?.poses);
    return poses(reply.answers[0]) === poses(known.answer);
  }
}

/** The content security policy of the page: it says whether there is an engine before the engine is read. */
function policy(): string {
  return document.querySelector("meta[http-equiv='Content-Security-Policy']")?.getAttribute("content") ?? "";
}

/** Questions whose answer depends on the part that they are over. */
const SCOPED = /^(map|sources|budget|reach|compare|repair)$/;

function answer(machine: ReportMachine, question: Question, over: Request["over"]): unknown {
  const { answer: known, rows, samples } = machine.eval;
  if (typeof question === "object" && "eval" in question) {
    const poses = chosen(machine, question.eval.poses, known?.poses);
    return poses && { ...known, poses };
  }
  if (typeof question === "object" && "rows" in question) {
    const { poses: of, target, ...more } = question.rows;
    const poses = more.samples === samples && !target ? chosen(machine, of.listed, rows?.rows.poses) : undefined;
    return poses && { rows: { poses } };
  }
  const key = canonical(question);
  const parts = new Set(machine.known.map((of) => canonical(of.over)));
  // Without a job all is over the volume.
  const isOver = (of: unknown) => (over ? canonical(of) === canonical(over) : of === null || parts.size === 1);
  const isIt = (of: ReportMachine["known"][number]) =>
    canonical(of.question) === key && (!SCOPED.test(kindOf(question)) || isOver(of.over));
  return machine.known.find(isIt)?.answer;
}

/** What is known at the poses that are asked for; `undefined` if any of them is another one. */
function chosen<T>({ eval: { poses } }: ReportMachine, asked: number[][], known: T[] = []): T[] | undefined {
  const keys = poses.map((pose) => JSON.stringify(pose));
  const found = asked.flatMap((pose) => known[keys.indexOf(JSON.stringify(pose))] ?? []);
  return found.length === asked.length ? found : undefined;
}

/** JSON with sorted keys. */
function canonical(value: unknown): string {
  return JSON.stringify(value, (_, of: unknown) =>
    of && typeof of === "object" && !Array.isArray(of)
      ? Object.fromEntries(Object.entries(of).sort(([a], [b]) => (a < b ? -1 : 1)))
      : of,
  );
}

function refusal(): unknown {
  return { refused: true, diagnostics: [{ code: "", severity: "refusal", message: NONE, help: null, places: [] }] };
}
