/** New entries of a section of the file. */

import type { EditorState } from "@codemirror/state";
import { type Change, valueOf } from "./chain";

/** Lines below a section, or that section at the end of the file. */
export function entries(state: EditorState, name: string, lines: string[]): Change[] {
  if (!lines.length) return [];
  const section = valueOf(state, name);
  const text = state.doc.toString();
  if (!section) {
    const at = state.doc.length;
    const own = lines.map((line) => `  ${line}\n`).join("");
    return [{ from: at, to: at, insert: `${text.endsWith("\n") || !text ? "" : "\n"}${name}:\n${own}` }];
  }
  if (state.sliceDoc(section.from, section.from + 1) === "{") {
    const list = lines.map((line) => `${line}, `).join("");
    return [{ from: section.from + 1, to: section.from + 1, insert: ` ${list.trimEnd()}` }];
  }
  // The first entry, behind line ends and comments.
  const first = section.from + (/^(?:\s*(?:#[^\n]*)?\n)*\s*/.exec(text.slice(section.from))?.[0].length ?? 0);
  const indent = " ".repeat(first - state.doc.lineAt(first).from);
  const insert = lines.map((line) => `${line}\n${indent}`).join("");
  return [{ from: first, to: first, insert }];
}
