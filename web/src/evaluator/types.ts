/** The interface between the page and the library: questions in, the JSON documents of `abbe ... --format json` out. */

export type Vec3 = [number, number, number];

/** A question about the machine: a verb of the program with its options, as `abbe::options::Question` has them. */
export type Question =
  | "check"
  | "show"
  | { map: { poses: { random: number }; worst?: number; samples?: number } }
  | { sources: { poses: number } }
  | { budget: { poses?: number; samples?: number } }
  | { eval: { poses: number[][] } };

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

/** Keeps the file that is open. */
export interface Store {
  /** Name of the button that keeps the text. */
  readonly verb: string;
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
  at_worst_um: number;
}

export interface Sources {
  worst: Pose;
  errors: Source[];
}

export interface Evaluated {
  poses: { axes: Pose; nominal: Vec3; deviation: Vec3; rotation: Vec3 }[];
}

/** Narrows an answer: `null` where the question was refused. */
export function accepted<T>(answer: unknown): T | null {
  if (answer === undefined || answer === null) return null;
  return (answer as Partial<Refusal>).refused ? null : (answer as T);
}
