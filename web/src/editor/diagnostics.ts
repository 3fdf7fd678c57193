/** Diagnostics of the program at their place in the editor. */

import { setDiagnostics, type Diagnostic as Mark } from "@codemirror/lint";
import type { EditorView } from "@codemirror/view";
import type { Text } from "@codemirror/state";
import type { Diagnostic, Place } from "../evaluator/types";

/** Marks what the program found in the open file; of other files the first line bears the mark. */
export function show(view: EditorView, machine: string, list: Diagnostic[]): void {
  const marks = list.map((diagnostic) => mark(view.state.doc, machine, diagnostic));
  view.dispatch(
    setDiagnostics(
      view.state,
      marks.sort((a, b) => a.from - b.from),
    ),
  );
}

function mark(doc: Text, machine: string, diagnostic: Diagnostic): Mark {
  const place = diagnostic.places.find((place) => place.file === machine);
  const [from, to] = place ? range(doc, place) : [0, 0];
  const severity = diagnostic.severity === "refusal" ? "error" : "warning";
  return { from, to: Math.max(to, from), severity, source: diagnostic.code, message: inWords(diagnostic, machine) };
}

/** Message, the places in other files, and the help. */
export function inWords(diagnostic: Diagnostic, machine: string): string {
  const label = diagnostic.places.find((place) => place.file === machine)?.text;
  const others = diagnostic.places.filter((place) => place.file !== machine);
  const lines = [diagnostic.message, ...(label ? [label] : [])];
  for (const place of others) lines.push(`${place.file}, line ${place.line}: ${place.text}`);
  if (diagnostic.help) lines.push(`Help: ${diagnostic.help}`);
  return lines.join("\n");
}

/** Range of a place, in the editor's units. */
export function range(doc: Text, place: Place): [number, number] {
  return [offset(doc, place.line, place.column), offset(doc, place.end_line, place.end_column)];
}

/** The program counts characters from 1, the editor UTF-16 units from 0. */
function offset(doc: Text, line: number, column: number): number {
  if (line > doc.lines) return doc.length;
  const of = doc.line(Math.max(1, line));
  const before = Array.from(of.text)
    .slice(0, column - 1)
    .join("");
  return Math.min(of.from + before.length, of.to);
}
