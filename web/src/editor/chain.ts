/** The chain of a machine as words, and its text in the file. */

import type { EditorState } from "@codemirror/state";
import { path, tree } from "./numbers";

/** Range of a text and what comes in its place. */
export interface Change {
  from: number;
  to: number;
  insert: string;
}

/** Words of a chain: `w`, axes with a prime on the workpiece's side, `b`, `(S)`, `t`. */
export function words(chain: string): string[] {
  return chain.split(/\s+/).filter((word) => word !== "");
}

/** True for a word that is an axis, and can be moved. */
export function isAxis(word: string): boolean {
  return !["w", "b", "t"].includes(word) && !word.startsWith("(");
}

/** Moves the word at `from` so that it stands at `to`; an axis that crosses the bed gains or loses its prime. */
export function moved(list: string[], from: number, to: number): string[] {
  const word = list[from];
  const target = Math.max(1, Math.min(to, lastPlace(list)));
  if (word === undefined || !isAxis(word) || target === from) return list;
  const rest = list.filter((_, i) => i !== from);
  rest.splice(target, 0, word);
  const bed = rest.indexOf("b");
  return rest.map((name, i) => (isAxis(name) ? name.replace(/'$/, "") + (i < bed ? "'" : "") : name));
}

/** The last place of an axis: before a spindle in parentheses and the tool. */
export function lastPlace(list: string[]): number {
  const end = list.findIndex((word) => word === "t" || word.startsWith("("));
  return (end < 0 ? list.length : end) - 1;
}

/** Returns the edit that writes a chain: in place of the one of the file, or as a line of its own in a file that
 * extends another; `null` if the file writes branches. */
export function chainEdit(state: EditorState, list: string[]): Change | null {
  const text = `"${list.join(" ")}"`;
  const found = valueOf(state, "chain");
  if (found) return { ...found, insert: text };
  if (valueOf(state, "branches")) return null;
  const above = valueOf(state, "extends");
  if (!above) return null;
  const end = state.doc.lineAt(above.to).to;
  return { from: end, to: end, insert: `\nchain: ${text}` };
}

/** Range of the value of a key of the file itself. */
export function valueOf(state: EditorState, name: string): { from: number; to: number } | null {
  let found: { from: number; to: number } | null = null;
  tree(state).iterate({
    enter: (at) => {
      if (found || at.name !== "Pair") return;
      const value = at.node.lastChild;
      const keys = path(state, at.node);
      if (value && keys.length === 1 && keys[0] === name) found = { from: value.from, to: value.to };
    },
  });
  return found;
}
