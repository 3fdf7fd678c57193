/** Values of a machine file by their keys: read as they stand, and written so that no other line changes. */

import type { EditorState } from "@codemirror/state";
import type { SyntaxNode } from "@lezer/common";
import type { Change } from "./chain";
import { path, tree } from "./numbers";

/** A value of the file. */
export interface Written {
  from: number;
  to: number;
  text: string;
  /** True if it is a mapping of its own, or goes over lines: no field holds it. */
  isLong: boolean;
}

/** The pair of these keys, if the file itself has it. */
function pairOf(state: EditorState, keys: string[]): SyntaxNode | null {
  let found: SyntaxNode | null = null;
  tree(state).iterate({
    enter: (at) => {
      if (found || at.name !== "Pair") return !found;
      const own = path(state, at.node);
      const isAbove = own.every((key, i) => key === keys[i]);
      if (isAbove && own.length === keys.length) found = at.node;
      return isAbove;
    },
  });
  return found;
}

/** The value of a pair; `null` for a key with nothing behind it. */
function valueNode(pair: SyntaxNode): SyntaxNode | null {
  const last = pair.lastChild;
  return last && last.name !== "Key" && last.name !== ":" ? last : null;
}

/** Returns the value of these keys as the file itself writes it; `null` where it does not. */
export function read(state: EditorState, keys: string[]): Written | null {
  const pair = pairOf(state, keys);
  const value = pair && valueNode(pair);
  if (!value) return null;
  const text = state.sliceDoc(value.from, value.to);
  return { from: value.from, to: value.to, text, isLong: /Mapping$/.test(value.name) || text.includes("\n") };
}

/** Returns the keys below these in the file itself, in their order. */
export function keysBelow(state: EditorState, keys: string[]): string[] {
  const pair = pairOf(state, keys);
  const pairs = (pair && valueNode(pair)?.getChildren("Pair")) ?? [];
  return pairs.map((of) => path(state, of).at(-1) ?? "");
}

/** Returns the edit that writes a value: in its place, or as the last entry of the innermost mapping that is there. */
export function put(state: EditorState, keys: string[], value: string): Change[] {
  const text = quoted(value);
  // What was not read may have the entry.
  if (tree(state).length < state.doc.length) return [];
  const there = read(state, keys);
  if (there) return there.text === text ? [] : [{ from: there.from, to: there.to, insert: text }];
  for (let depth = keys.length; depth > 0; depth -= 1) {
    const pair = pairOf(state, keys.slice(0, depth));
    if (pair) return inside(state, pair, keys.slice(depth), text);
  }
  const end = state.doc.length;
  const [section = "", ...rest] = keys;
  const body = rest.length ? `${section}:\n  ${nested(rest, text)}` : `${section}: ${text}`;
  const isEnded = !end || state.sliceDoc(end - 1, end) === "\n";
  return [{ from: end, to: end, insert: `${isEnded ? "" : "\n"}${body}\n` }];
}

/** An entry behind the others of a pair; the value itself where no key is left. */
function inside(state: EditorState, pair: SyntaxNode, rest: string[], text: string): Change[] {
  const insertAt = (at: number, insert: string): Change[] => [{ from: at, to: at, insert }];
  if (!rest.length) return insertAt(pair.to, ` ${text}`);
  const entry = nested(rest, text);
  const value = valueNode(pair);
  const last = value?.getChildren("Pair").at(-1);
  if (value?.name === "FlowMapping")
    return last ? insertAt(last.to, `, ${entry}`) : [{ from: value.from, to: value.to, insert: `{ ${entry} }` }];
  const { doc } = state;
  if (value?.name === "BlockMapping" && last) {
    const indent = " ".repeat(last.from - doc.lineAt(last.from).from);
    return insertAt(doc.lineAt(last.to).to, `\n${indent}${entry}`);
  }
  const own = doc.lineAt(pair.from);
  const indent = " ".repeat(pair.from - own.from + 2);
  // A value that has no entries stays: the text is the place to change it.
  return value ? [] : insertAt(own.to, `\n${indent}${entry}`);
}

/** An entry with braces around what is further in. */
function nested([key = "", ...rest]: string[], text: string): string {
  return rest.length ? `${key}: { ${nested(rest, text)} }` : `${key}: ${text}`;
}

/** A text that would be read as more than one value, such as the name of a file with a comma, in quotes. */
function quoted(text: string): string {
  const isWritten = /^(\[.*\]|\{.*\}|"[^"]*"|'[^']*')$/.test(text);
  const isSeveral = /^[-?]\s|^[[\]{}"'&*!|>%@`#]|[,[\]{}]|: |:$| #/.test(text);
  return isSeveral && !isWritten ? JSON.stringify(text) : text;
}

/** Returns the edit that takes an entry away: its lines, or its part of the braces around it. */
export function taken(state: EditorState, keys: string[]): Change[] {
  const pair = pairOf(state, keys);
  if (!pair) return [];
  const pairs = pair.parent?.getChildren("Pair") ?? [];
  // Its parent would be empty.
  if (pairs.length === 1 && keys.length > 1) return taken(state, keys.slice(0, -1));
  if (pair.parent?.name === "FlowMapping") {
    const k = pairs.findIndex((of) => of.from === pair.from);
    const [before, next] = [pairs[k - 1], pairs[k + 1]];
    if (next) return [{ from: pair.from, to: next.from, insert: "" }];
    return before ? [{ from: before.to, to: pair.to, insert: "" }] : [];
  }
  const { doc } = state;
  return [{ from: doc.lineAt(pair.from).from, to: Math.min(doc.lineAt(pair.to).to + 1, doc.length), insert: "" }];
}
