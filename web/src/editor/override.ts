/** Errors that another file gives, as a base or a class: an entry of the open file takes their place. */

import type { EditorState } from "@codemirror/state";
import type { ErrorNumber } from "../evaluator/types";
import { type Change, valueOf } from "./chain";
import { entries } from "./entries";
import { numbers } from "./numbers";

export interface Inherited {
  error: string;
  section: "errors" | "tolerances";
  /** Its value with the unit, as it is written. */
  text: string;
}

/** Returns the errors of the machine that do not stand in the open file: in one that extends another, and the bounds of
 * a class. */
export function inherited(state: EditorState, known: Record<string, ErrorNumber>): Inherited[] {
  if (!valueOf(state, "extends") && !valueOf(state, "class")) return [];
  const own = new Set(numbers(state).flatMap(({ path }) => path));
  return Object.entries(known)
    .filter(([error]) => !own.has(error))
    .map(([error, { value, unit, bound }]) => ({
      error,
      section: bound ? "tolerances" : "errors",
      text: `${Number(value.toPrecision(12))} ${unit}`,
    }));
}

/** Returns the edits that write the entry. */
export function override(state: EditorState, { error, section, text }: Inherited): Change[] {
  return entries(state, section, [`${error}: ${text}`]);
}
