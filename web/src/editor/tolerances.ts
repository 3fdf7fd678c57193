/** Tolerances written into the text: in place of those that stand there, else as an entry of their own. */

import type { EditorState } from "@codemirror/state";
import type { Change } from "./chain";
import { entries } from "./entries";
import { type FileNumber, numbers } from "./numbers";

/** A tolerance that is wished for, in `um` or `urad`. */
export interface Wish {
  error: string;
  new: number;
  unit: string;
}

/** Squareness by the pair of axes, as tolerances may name it. */
const PAIRS: Record<string, string> = { EC0Y: "X-Y", EB0Z: "X-Z", EA0Z: "Y-Z" };

/** Returns the edits that write the tolerances; of one that a class or another file gives, an entry of this file. */
export function toleranceEdits(state: EditorState, wishes: Wish[]): Change[] {
  const known = numbers(state);
  const missing: string[] = [];
  const edits: Change[] = [];
  for (const wish of wishes) {
    const text = `${finer(wish.new)} ${wish.unit}`;
    const number = known.find((number) => isTolerance(number, wish.error));
    if (number) edits.push({ from: number.from, to: end(state, number), insert: text });
    else missing.push(`${wish.error}: ${text}`);
  }
  return [...edits, ...entries(state, "tolerances", missing)].sort((a, b) => a.from - b.from);
}

function isTolerance({ path }: FileNumber, error: string): boolean {
  const [section, name, key, ...more] = path;
  if (section === "tolerances") return (name === error || name === PAIRS[error]) && key === undefined;
  return section === "errors" && name === error && key === "tolerance" && more.length === 0;
}

/** Behind the unit of a number. */
function end(state: EditorState, number: FileNumber): number {
  const rest = state.sliceDoc(number.to, state.doc.lineAt(number.to).to);
  const spaces = /^\s*/.exec(rest)?.[0].length ?? 0;
  return number.unit ? number.to + spaces + number.unit.length : number.to;
}

/** Three digits, never coarser than the goal needs. */
function finer(value: number): string {
  const power = 10 ** (2 - Math.floor(Math.log10(value)));
  return String(Number((Math.floor(value * power * (1 + 1e-12)) / power).toPrecision(3)));
}
