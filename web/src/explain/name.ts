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

/** What an error does to its axis, as a designer says it: "C's bearing tilts about X". */
export function plainly(name: string, chain: Chain): string {
  const of = parsed(name);
  if (!of) return name;
  const axis = axisOf(chain, of);
  const { axis: a, isRotation, isLocation } = of;
  const letter = "XYZ"[of.along];
  const isOwn = axis !== null && Math.abs(axis.direction[of.along] ?? 0) > 1 - 1e-9;
  if (!axis) return isRotation ? `the spindle leans about ${letter}` : `the spindle lies off in ${letter}`;
  const linear = {
    location: isRotation ? `${a} is out of square about ${letter}` : `the zero of ${a} lies off in ${letter}`,
    rotation: isOwn ? `${a} rolls` : `${a} tilts about ${letter}`,
    shift: isOwn ? `the scale of ${a} is off` : `${a} runs crooked in ${letter}`,
  };
  const leans = isOwn ? `the zero of ${a} is turned` : `the axis of ${a} leans about ${letter}`;
  const rotary = {
    location: isRotation ? leans : `the axis of ${a} lies off in ${letter}`,
    rotation: isOwn ? `${a} turns to wrong angles` : `the bearing of ${a} tilts about ${letter}`,
    shift: isOwn ? `the bearing of ${a} moves along its axis` : `the bearing of ${a} runs out in ${letter}`,
  };
  const words = axis.kind === "linear" ? linear : rotary;
  return isLocation ? words.location : isRotation ? words.rotation : words.shift;
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
