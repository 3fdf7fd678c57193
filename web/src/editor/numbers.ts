/** Numbers in the text of a machine file: where their digits stand, and how a new value is written in their place. */

import { ensureSyntaxTree, syntaxTree } from "@codemirror/language";
import type { EditorState } from "@codemirror/state";
import type { SyntaxNode, Tree } from "@lezer/common";

/** A number of the file. */
export interface FileNumber {
  /** Keys that lead to it, such as `errors`, `EC0Y`. */
  path: string[];
  /** Range of its digits, without the unit. */
  from: number;
  to: number;
  value: number;
  /** Unit behind it; may be empty. */
  unit: string;
  /** Digits after the point. */
  decimals: number;
}

const QUANTITY = /^([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([a-zA-Zµ°"'%]*(?:\/[a-zA-Z]+)?)$/;

const SCALARS = new Set(["Literal", "QuotedLiteral"]);

/** Time for the syntax of a file, ms: it takes a few, but on a busy computer the clock runs on without the page. */
const PARSING = 5000;

/** Returns the syntax of the whole file, not only of the part that is in sight. */
export function tree(state: EditorState): Tree {
  return ensureSyntaxTree(state, state.doc.length, PARSING) ?? syntaxTree(state);
}

/** Returns the numbers of a file that are values, in their order. */
export function numbers(state: EditorState): FileNumber[] {
  const found: FileNumber[] = [];
  tree(state).iterate({
    enter: (at) => {
      const number = SCALARS.has(at.name) && at.node.parent?.name !== "Key" ? quantity(state, at.node) : null;
      if (number) found.push(number);
    },
  });
  return found;
}

/** Returns the number whose value the position touches. */
export function numberAt(state: EditorState, position: number): FileNumber | null {
  const line = state.doc.lineAt(position).to;
  const behind = (number: FileNumber) => Math.min(line, number.to + number.unit.length + 1);
  return numbers(state).find((number) => number.from <= position && position <= behind(number)) ?? null;
}

function quantity(state: EditorState, node: SyntaxNode): FileNumber | null {
  const quote = node.name === "QuotedLiteral" ? 1 : 0;
  const text = state.sliceDoc(node.from + quote, node.to - quote);
  const match = QUANTITY.exec(text);
  const digits = match?.[1];
  if (!match || digits === undefined) return null;
  const from = node.from + quote;
  const decimals = /e/i.test(digits) ? 9 : (digits.split(".")[1] ?? "").length;
  return {
    path: path(state, node),
    from,
    to: from + digits.length,
    value: Number(digits),
    unit: match[2] ?? "",
    decimals,
  };
}

/** Keys from the outermost to the one of a node; entries of lists count from 1. */
export function path(state: EditorState, node: SyntaxNode): string[] {
  const keys: string[] = [];
  for (let at: SyntaxNode | null = node; at; at = at.parent) {
    if (at.name === "Pair") keys.unshift(key(state, at));
    if (at.parent?.name === "FlowSequence" && at.parent !== node) keys.unshift(String(index(at)));
  }
  return keys.filter((name) => name !== "");
}

function key(state: EditorState, pair: SyntaxNode): string {
  const name = pair.getChild("Key");
  return name ? state.sliceDoc(name.from, name.to).replace(/^["']|["']$/g, "") : "";
}

function index(of: SyntaxNode): number {
  let count = 1;
  for (let at = of.prevSibling; at; at = at.prevSibling) if (at.name === of.name || at.name === "Item") count += 1;
  return count;
}

/** Returns a value with that many digits after the point. */
export function written(value: number, decimals: number): string {
  const text = value.toFixed(Math.min(decimals, 9));
  return /^-0(\.0*)?$/.test(text) ? text.slice(1) : text;
}

/** Ends and step of a slider for a number: twice its size to either side, for lengths and the like from zero. */
export function range(number: FileNumber): { min: number; max: number; step: number; decimals: number } {
  const size = Math.max(Math.abs(number.value), 10 ** -number.decimals);
  const step = 10 ** Math.floor(Math.log10(size / 20));
  const decimals = Math.max(number.decimals, Math.round(-Math.log10(step)));
  const end = Math.ceil((2 * size) / step) * step;
  const signed = number.path[0] === "errors" && !number.path.includes("tolerance");
  return { min: signed ? -end : 0, max: end, step: Math.min(step, 10 ** -number.decimals), decimals };
}
