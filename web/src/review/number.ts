/** Figures as they are shown: rounded on the page, whole in the element, with the difference to the kept state. */

import { make } from "../ui/dom";

/** A figure now and in the state that was kept last. */
export interface Figure {
  now: number;
  kept: number | null;
}

export function pair(now: number, kept: number | null | undefined): Figure {
  return { now, kept: kept ?? null };
}

/** Rounds to what a drawing would show: three to four digits, a real minus. */
export function rounded(value: number): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  const digits = size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3;
  return value.toFixed(digits).replace("-", "−");
}

/** A count with its thousands apart. */
export const counted = (count: number) => String(count).replace(/\B(?=(\d{3})+$)/g, "\u202f");

/** A figure with its unit; `at` names it for tests and for whoever looks at the source. */
export function figure(at: string, value: number, unit: string): HTMLElement {
  return make(
    "span",
    { class: "number", "data-at": at, "data-value": String(value), title: `${value} ${unit}` },
    `${value !== 0 && Math.abs(value) < 5e-4 ? "< 0.001" : rounded(value)} ${unit}`,
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
    { class: `difference ${by > 0 ? "worse" : "better"}`, title: `${of.kept} ${unit} in the state saved last` },
    `${by > 0 ? "▲" : "▼"} ${sign}${rounded(by)} ${unit}`,
  );
}
