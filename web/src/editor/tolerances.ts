/** Tolerances written into the text: in place of those that stand there, else as an entry of their own. */

import type { EditorState } from "@codemirror/state";
import { type Change, valueOf } from "./chain";
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
    else missing.push(`  ${wish.error}: ${text}`);
  }
  return [...edits, ...entries(state, missing)].sort((a, b) => a.from - b.from);
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

/** Lines below `tolerances:`, or that section at the end of the file. */
function entries(state: EditorState, lines: string[]): Change[] {
  if (!lines.length) return [];
  const section = valueOf(state, "tolerances");
  const text = state.doc.toString();
  if (!section) {
    const at = state.doc.length;
    return [
      { from: at, to: at, insert: `${text.endsWith("\n") || !text ? "" : "\n"}tolerances:\n${lines.join("\n")}\n` },
    ];
  }
  if (state.sliceDoc(section.from, section.from + 1) === "{") {
    const list = lines.map((line) => `${line.trim()}, `).join("");
    return [{ from: section.from + 1, to: section.from + 1, insert: ` ${list.trimEnd()}` }];
  }
  // The first entry, behind line ends and comments.
  const first = section.from + (/^(?:\s*(?:#[^\n]*)?\n)*\s*/.exec(text.slice(section.from))?.[0].length ?? 0);
  const indent = " ".repeat(first - state.doc.lineAt(first).from);
  const insert = lines.map((line) => `${line.trim()}\n${indent}`).join("");
  return [{ from: first, to: first, insert }];
}
