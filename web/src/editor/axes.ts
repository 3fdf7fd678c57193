/** Axes that join or leave the machine: the chain, their entries, and what the file says of them. */

import type { EditorState } from "@codemirror/state";
import type { SyntaxNode } from "@lezer/common";
import { type Change, chainEdit, isAxis, lastPlace, valueOf } from "./chain";
import { entries } from "./entries";
import { path, tree } from "./numbers";

/** Axes that a file names without more words, with what they are. */
export const STANDARD: Record<string, string> = {
  X: "linear along X",
  Y: "linear along Y",
  Z: "linear along Z",
  A: "rotary about X",
  B: "rotary about Y",
  C: "rotary about Z",
  U: "linear along X",
  V: "linear along Y",
  W: "linear along Z",
};

/** Name of the axis of a word of the chain. */
export function nameOf(word: string): string {
  return word.replace(/'$/, "");
}

/** Returns the edits that put an axis next to the tool; `null` where the chain is not a text of this file. */
export function axisAdded(state: EditorState, list: string[], name: string): Change[] | null {
  const longer = [...list];
  longer.splice(lastPlace(list) + 1, 0, name);
  const chain = chainEdit(state, longer);
  if (!chain) return null;
  const travel = "ABC".includes(name) ? "[-90 deg, 90 deg]" : "[0 mm, 100 mm]";
  return sorted([chain, ...entries(state, "axes", [`${name}: { travel: ${travel} }`])]);
}

/** Returns the edits that take an axis away, with its entry and its errors; `null` where they are not all in this
 * file. */
export function axisRemoved(state: EditorState, list: string[], name: string): Change[] | null {
  const shorter = list.filter((word) => !isAxis(word) || nameOf(word) !== name);
  const chain = chainEdit(state, shorter);
  if (!chain || valueOf(state, "extends")) return null;
  const own = ([section, key = "", ...more]: string[]) =>
    more.length === 0 && ((isOfAxes(section) && key === name) || (isOfErrors(section) && concerns(key, name)));
  return sorted([chain, ...removed(state, own), ...tables(state, name)]);
}

function isOfAxes(section: string | undefined): boolean {
  return section === "axes" || section === "volume";
}

function isOfErrors(section: string | undefined): boolean {
  return section === "errors" || section === "tolerances";
}

/** True for the errors of an axis, and for a pair of axes with it. */
function concerns(key: string, axis: string): boolean {
  return new RegExp(`^E[XYZABC]0?${axis}$`).test(key) || key.split("-").includes(axis);
}

function sorted(changes: Change[]): Change[] {
  return changes.sort((a, b) => a.from - b.from);
}

/** Takes entries away; a section that would be empty goes as a whole. */
function removed(state: EditorState, own: (path: string[]) => boolean): Change[] {
  const changes: Change[] = [];
  tree(state).iterate({
    enter: (at) => {
      if (at.name !== "Pair") return true;
      const pairs = at.node.lastChild?.getChildren("Pair") ?? [];
      const gone = pairs.filter((pair) => own(path(state, pair)));
      if (gone.length === 0) return path(state, at.node).length < 2;
      const braces = at.node.lastChild?.name === "FlowMapping";
      if (gone.length === pairs.length) changes.push(lines(state, at.node));
      else if (braces) changes.push(...between(pairs, gone));
      else changes.push(...gone.map((pair) => lines(state, pair)));
      return false;
    },
  });
  return changes;
}

/** Takes the tables away that are called like the axis, `errors/a.csv`. */
function tables(state: EditorState, axis: string): Change[] {
  const of = new RegExp(`(^|[/\\\\\\s"'])${axis}\\.csv["']?\\s*$`, "i");
  const changes: Change[] = [];
  tree(state).iterate({
    enter: (at) => {
      if (at.name !== "Item") return;
      const [section, ...more] = path(state, at.node);
      if (section === "measured" && more.length === 0 && of.test(state.sliceDoc(at.from, at.to)))
        changes.push(lines(state, at.node));
    },
  });
  return changes;
}

/** The lines of an entry. */
function lines(state: EditorState, pair: SyntaxNode): Change {
  const { doc } = state;
  return { from: doc.lineAt(pair.from).from, to: Math.min(doc.lineAt(pair.to).to + 1, doc.length), insert: "" };
}

/** Entries in braces up to the next one that stays; behind the last of these all that is left. */
function between(pairs: SyntaxNode[], gone: SyntaxNode[]): Change[] {
  const stays = pairs.filter((pair) => !gone.includes(pair));
  const last = stays.at(-1);
  const changes = gone.flatMap((pair) => {
    const next = pairs[pairs.indexOf(pair) + 1];
    return last && next && pair.from < last.from ? [{ from: pair.from, to: next.from, insert: "" }] : [];
  });
  const end = gone.at(-1);
  return last && end && end.from > last.from ? [...changes, { from: last.to, to: end.to, insert: "" }] : changes;
}
