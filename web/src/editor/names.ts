import type { FileNumber } from "./numbers";

/** `errors › EC0Y`: the keys that lead to a number. */
export function nameOf(number: FileNumber): string {
  return number.path.join(" › ");
}
