/** The interface between the page and the library: questions in, the JSON documents of `abbe ... --format json` out. */

import type * as results from "./results";

export type Vec3 = [number, number, number];

/** A question about the machine: a verb of the program with its options, as `abbe::options::Question` has them. */
export type Question =
  | "check"
  | "show"
  | { map: { poses: { random: number } | "grid"; worst?: number; samples?: number; target?: string } & Options }
  | { rows: { poses: { listed: number[][] }; samples?: number; target?: string } }
  | { sources: { poses: number; at?: number[] } & Options }
  | { budget: { poses?: number; samples?: number; goal_mm?: number } & Options }
  | { eval: { poses: number[][] } }
  | { reach: { step_mm?: number } }
  | { work: (Part | StatedPart) & { samples?: number; target?: string; map?: Options } }
  | { place: (Part | StatedPart) & { ranges: string; figure: boolean } }
  | { compare: { first: string; more: string[]; options: Options } }
  | { instrument: { instrument: "ball_bar" | "r_test" | "diagonals" } }
  | { look: Options }
  | { repair: { target: string; machines: number } }
  | "targets"
  | "numbers"
  | "words"
  | "schema";

/** A part: a file of tool poses, or a job file. */
export type Part = ({ tool_poses: string } | { job: string }) & StatedPart;

/** What is stated of a part besides its file; by itself the part is the job of the machine file. */
export interface StatedPart {
  reference?: unknown;
  path?: boolean;
}

export interface Place {
  file: string;
  line: number;
  column: number;
  end_line: number;
  end_column: number;
  text: string;
}

export interface Diagnostic {
  code: string;
  severity: "refusal" | "warning";
  message: string;
  help: string | null;
  places: Place[];
}

export interface Refusal {
  refused: true;
  diagnostics: Diagnostic[];
}

export interface Reply {
  diagnostics: Diagnostic[];
  /** In the order of the questions; empty if the machine file is refused. */
  answers: unknown[];
}

export interface Request {
  machine: string;
  texts: Record<string, string>;
  /** Name of the tool; the first of the file where it is left out. */
  tool?: string;
  /** The part that maps, sources, budgets, reach and comparisons are over; the volume without one. */
  over?: Part | StatedPart;
  /** Answers to the questions that make a machine file: the one answer is what they lead to. */
  dialogue?: Record<string, string>;
  questions: Question[];
}

/** Answers questions: by the local program, or by the library in a worker. */
export interface Evaluator {
  /** Rejects once `signal` is aborted; then the question costs nothing any more. */
  ask(request: Request, signal?: AbortSignal): Promise<Reply>;
}

/** Further options of a verb. */
type Options = Record<string, unknown>;

/** Options of the figures that are shown first. */
export interface Settings {
  poses: number;
  samples: number;
  map: Options;
  sources: Options;
  budget: Options;
  compare: Options;
  look: Options;
}

/** The defaults of the verbs. */
export const DEFAULTS: Settings = {
  poses: 2000,
  samples: 1000,
  map: {},
  sources: {},
  budget: {},
  compare: { poses: 1000 },
  look: {},
};

/** Others wrote the file that the page would save; `theirs` is its text now, null where it cannot be read. */
export class Conflict extends Error {
  constructor(
    message: string,
    readonly theirs: string | null,
  ) {
    super(message);
  }
}

/** Keeps the file that is open. */
export interface Store {
  /** Name of the button that keeps the text. */
  readonly verb: string;
  /** True if the text cannot be changed. */
  readonly isReadOnly: boolean;
  /** Names of the machine files that can be opened, where there are several, and the one that is. */
  readonly choices?: string[];
  chosen?: string;
  /** Returns what the file holds now, and a number that is another one after a change of a file that it names. */
  follow?(): Promise<{ text: string | null; changes: number }>;
  open(): Promise<OpenFile>;
  /** Keeps `text`; rejects if the kept text is no longer `before`. */
  save(text: string, before: string): Promise<void>;
}

export interface OpenFile {
  machine: string;
  text: string;
  /** Job file, or file of tool poses, with which the page begins. */
  work?: string;
  /** What is stated of that part beside its file. */
  part?: StatedPart;
}

export type Axis = results.ChainAxis;

export type Tool = results.ChainTool;

export type Chain = results.ChainResult;

/** What pictures and sliders hang on: the same for chains that differ by their errors only. */
export function geometry(of: Chain): string {
  const axis = ({ name, kind, side, sense, direction, origin_mm, travel, continuous }: Axis) => [
    name,
    kind,
    side,
    sense,
    direction,
    origin_mm,
    travel,
    continuous,
  ];
  const work = [of.workpiece_origin_mm, of.workpiece_rotation_deg, of.up];
  return JSON.stringify([of.machine, of.chain, of.axes.map(axis), of.tools, work]);
}

export type Pose = Record<string, number>;

export type Over = results.Over;

export type Summary = results.Summary;

export type VolumeMap = results.MapResult;

export type Source = results.ErrorSource;

export type Sources = results.ErrorSources;

export type Evaluated = results.EvalResult;

export type Reach = results.ReachResult & {
  /** What stops the rest, the most frequent first. */
  reasons: string[];
};

/** A quantile of drawn machines with its interval, um. */
export type Quantile = results.Percentile;

/** A controller: what it corrects and what not, in words. */
export type Target = results.TargetSummary;

export type BallBar = Extract<results.InstrumentResult, { instrument: "ball_bar" }>;

export type RTest = Extract<results.InstrumentResult, { instrument: "r_test" }>;

export type Diagonals = Extract<results.InstrumentResult, { instrument: "diagonals" }>;

/** What targets leave of a machine, or take off machines drawn between its bounds. */
export type Repair = results.TargetComparison;

/** The cheapest tolerances for a goal. */
export type ToleranceGoal = results.ToleranceGoal;

/** A machine beside another on the same tool poses. */
export type Comparison = results.CompareResult;

export type ComparedMachine = results.ComparedMachine;

/** A row of a file of tool poses: reached with its deviation, or not with what it lacks. */
export interface WorkRow {
  line: number;
  feature?: string;
  axes?: Pose;
  deviation_um?: Vec3;
  /** Where nothing is measured. */
  position_um?: { rss: number; p95: number };
  why?: "direction" | "place" | "travel";
  beyond?: { axis: string; by: number; unit: string }[];
}

/** A row with its deviation against the surface, and the axes that make it. */
export interface PlayedRow {
  line: number;
  /** Positive out of the material. */
  across_um: number;
  along_um: number;
  /** False where the direction of the tool stands for the normal of the surface. */
  has_normal: boolean;
  axes: Record<string, number>;
}

export interface Work {
  map: {
    path?: results.PathResult | null;
    position_um: Summary;
    features?: {
      feature: string;
      poses: number;
      unreached: number;
      max_um: number | null;
      line: number | null;
      axes: Pose | null;
      errors: { error: string; um: number }[];
    }[];
  };
  rows: { poses: WorkRow[] };
  tips: { line: number; tip_mm: Vec3 }[];
  /** The reached rows one by one; empty where errors are only bounded. */
  played: PlayedRow[];
  /** Poses and reference of the figures, in words. */
  over: string;
  /** The verdict of the limit of the job, in words. */
  limit: string | null;
}

/** A part at places of the table, with the picture. */
export interface PlacedPart {
  placement: results.PlacementResult;
  svg: string;
  /** Poses and reference of the figures, in words. */
  over: string;
}

/** Meshes that a machine is drawn by. */
export interface Look {
  bodies: { body: string; color: Vec3 | null; positions: string; indices: string }[];
  /** Their size in words. */
  words: string | null;
  warnings?: Diagnostic[];
}

/** An error that is one number, wherever it stands. */
export interface ErrorNumber {
  value: number;
  unit: "um" | "urad";
  bound: boolean;
}

/** Deviations at listed poses; of a machine that is only bounded what its bounds lead to. */
export interface Rows {
  rows: {
    poses: { axes: Pose; deviation_um?: Vec3; rotation_urad?: Vec3; position_um?: { rss: number; p95: number } }[];
  };
}

/** Narrows an answer: `null` where the question was refused. */
export function accepted<T>(answer: unknown): T | null {
  if (answer === undefined || answer === null) return null;
  // A comparison of controls has a list of that name.
  return (answer as Partial<Refusal>).refused === true ? null : (answer as T);
}

/** Why a question was refused; empty for an answer. */
export function refusals(answer: unknown): string[] {
  const { refused, diagnostics = [] } = (answer ?? {}) as Partial<Refusal>;
  return refused === true ? diagnostics.map(({ message }) => message) : [];
}
