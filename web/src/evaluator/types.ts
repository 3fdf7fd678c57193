/** The interface between the page and the library: questions in, the JSON documents of `abbe ... --format json` out. */

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
  | { work: { tool_poses: string; samples?: number; target?: string } }
  | { compare: { first: string; options: { poses?: number; tool_poses?: string } } }
  | { instrument: { instrument: "ball_bar" | "r_test" | "diagonals" } }
  | "targets"
  | "numbers"
  | "words"
  | "schema";

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
  questions: Question[];
}

/** Answers questions: by the local program, or by the library in a worker. */
export interface Evaluator {
  ask(request: Request): Promise<Reply>;
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
}

/** The defaults of the verbs. */
export const DEFAULTS: Settings = { poses: 2000, samples: 1000, map: {}, sources: {}, budget: {} };

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
}

export interface Axis {
  name: string;
  kind: "linear" | "rotary";
  side: "workpiece" | "tool";
  sense: "iso841" | "direct";
  direction: Vec3;
  origin_mm: Vec3;
  travel: [number, number];
  continuous: boolean;
  unit: string;
}

export interface Tool {
  name: string;
  gauge_mm: Vec3;
  tip_mm: Vec3;
  direction: Vec3;
}

export interface Chain {
  machine: string;
  chain: string;
  axes: Axis[];
  tools: Tool[];
  workpiece_origin_mm: Vec3;
  workpiece_rotation_deg: Vec3;
}

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
  const work = [of.workpiece_origin_mm, of.workpiece_rotation_deg];
  return JSON.stringify([of.machine, of.chain, of.axes.map(axis), of.tools, work]);
}

export type Pose = Record<string, number>;

export interface Summary {
  max: number;
  mean: number;
  rms: number;
  p95: number;
}

type Interval = [number, number];

export interface VolumeMap {
  poses: number;
  from?: "bounds";
  position_um: Summary;
  rotation_urad: Summary;
  uncertainty?: { position_um: Record<keyof Summary, Interval>; rotation_urad: Record<keyof Summary, Interval> };
  bounds?: { worst: { axes: Pose; rss_um: number; p95_um: number }[] };
  worst: { axes: Pose; deviation_um: Vec3 }[];
}

export interface Source {
  error: string;
  words: string;
  p95_um: number;
  max_um: number;
  p95_urad: number;
  /** Its part along the deviation at `at` of the answer. */
  at_um: number;
}

export interface Sources {
  at: Pose;
  errors: Source[];
}

export interface Evaluated {
  poses: { axes: Pose; nominal: Vec3; deviation: Vec3; rotation: Vec3 }[];
}

export interface Reach {
  tips: number;
  directions: { kind: "one" | "circle" | "hemisphere"; count: number };
  tool_poses: number;
  reached: number;
  share: number;
  tips_in_all_directions: number;
  /** What stops the rest, the most frequent first. */
  reasons: string[];
}

/** A quantile of drawn machines with its interval, um. */
export interface Quantile {
  value: number;
  low: number;
  high: number;
}

/** A controller: what it corrects and what not, in words. */
export interface Target {
  target: string;
  title: string;
  expresses: string;
  cannot: string[];
}

export interface BallBar {
  radius_mm: number;
  planes: { plane: string; bidirectional_um: number; squareness_urad: number }[];
}

export interface RTest {
  axes: { axis: string; range_um: Vec3 }[];
}

export interface Diagonals {
  diagonals: { name: string; e_d_um: number; b_d_um: number }[];
}

/** The cheapest tolerances for a goal. */
export interface ToleranceGoal {
  goal_um: number;
  before_um: Quantile;
  proof_um: Quantile;
  proof_samples: number;
  staying_um: number;
  cost: { before: number; after: number; per_um: number };
  tolerances: { error: string; unit: string; old: number; new: number; um_of_p95: number; binds: string }[];
}

/** A machine beside another on the same tool poses. */
export interface Comparison {
  poses: number;
  asked: number;
  machines: ComparedMachine[];
  budgets?: {
    samples: number;
    machines: { position_um: { monte_carlo: { percentiles: Record<string, { value: number }> } } }[];
    versus_first_p95_um: {
      verdict: "first" | "equal" | "not_told_apart" | "worse" | "better";
      minus_first: { value: number; low: number | null; high: number | null };
    }[];
  };
  contributions: { error: string; um: (number | null)[]; minus_first: number[] }[];
}

export interface ComparedMachine {
  machine: string;
  from?: "bounds";
  position_um: Summary;
  rotation_urad: Summary;
  minus_first: { position_um: Summary; rotation_urad: Summary } | null;
  uncertainty?: { minus_first: { position_um: Record<keyof Summary, Interval> }; told_apart: boolean };
}

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

export interface Work {
  map: {
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
  return (answer as Partial<Refusal>).refused ? null : (answer as T);
}

/** Why a question was refused; empty for an answer. */
export function refusals(answer: unknown): string[] {
  const { refused, diagnostics = [] } = (answer ?? {}) as Partial<Refusal>;
  return refused ? diagnostics.map(({ message }) => message) : [];
}
