/** Figures as they are shown: rounded on the page, whole in the element, with the difference to the kept state. */

import { make } from "../ui/dom";
import { inReaders, named, quantity, rounded } from "../units";

/** A figure now and in the state that was kept last. */
export interface Figure {
  now: number;
  kept: number | null;
}

export function pair(now: number, kept: number | null | undefined): Figure {
  return { now, kept: kept ?? null };
}

/** A count with its thousands apart. */
export const counted = (count: number) => String(count).replace(/\B(?=(\d{3})+$)/g, "\u202f");

/** A figure with its unit, of the program in the element and of the reader in the words; `at` names it for tests and
 * for whoever looks at the source. */
export function figure(at: string, value: number, unit: string): HTMLElement {
  const shown = inReaders(value, unit);
  return make(
    "span",
    {
      class: "number",
      "data-at": at,
      "data-value": String(value),
      "data-shown": String(shown),
      title: `${shown} ${named(unit)}`,
    },
    `${shown !== 0 && Math.abs(shown) < 5e-4 ? "< 0.001" : rounded(shown)} ${named(unit)}`,
  );
}

/** The difference to the kept state; nothing where there is none, or none that the figure shows. */
export function difference(of: Figure, unit: string): HTMLElement | string {
  if (of.kept === null) return "";
  const by = of.now - of.kept;
  if (Math.abs(by) < 5e-4 * Math.max(Math.abs(of.kept), 1e-3)) return "";
  const sign = by > 0 ? "+" : "";
  return make(
    "span",
    {
      class: `difference ${by > 0 ? "worse" : "better"}`,
      title: `${inReaders(of.kept, unit)} ${named(unit)} in the state saved last`,
    },
    `${by > 0 ? "▲" : "▼"} ${sign}${quantity(by, unit)}`,
  );
}
