/** Names of errors as ISO 230-1 builds them: E, the letter of the direction, 0 for a location error, the axis. */

import type { Axis, Chain } from "../evaluator/types";

export interface ErrorName {
  /** Index of the direction: 0 to 2 for X, Y, Z. */
  along: number;
  isRotation: boolean;
  isLocation: boolean;
  axis: string;
}

export function parsed(name: string): ErrorName | null {
  const [, letter, location, axis] = /^E([XYZABC])(0?)([A-Z][A-Z0-9]*)$/i.exec(name) ?? [];
  if (!letter || !axis) return null;
  const at = "XYZABC".indexOf(letter);
  return { along: at % 3, isRotation: at > 2, isLocation: location === "0", axis };
}

/** The axis that a name ends with; a spindle is none of the chain's. */
export function axisOf(chain: Chain, name: ErrorName): Axis | null {
  return chain.axes.find((axis) => axis.name === name.axis) ?? null;
}

/** What the letters of a name stand for. */
export function letters(name: ErrorName): string {
  const letter = "XYZ"[name.along];
  const direction = name.isRotation
    ? `${"ABC"[name.along]}: rotation about ${letter}`
    : `${letter}: shift along ${letter}`;
  const family = name.isLocation
    ? `0${name.axis}: where axis ${name.axis} lies`
    : `${name.axis}: in motion of ${name.axis}`;
  return `${direction} · ${family}`;
}
