/** Units of the reader: those of the file unless the address names others. Figures of the program are in um and urad,
 * and stay so in the page's data; this is where they become what is read. */

import { place } from "./ui/address";

/** A unit: its name, and its size in that of the program. */
interface Unit {
  name: string;
  size: number;
}

const LENGTHS: Record<string, Unit> = { um: { name: "µm", size: 1 }, uin: { name: "µin", size: 0.0254 } };
const ANGLES: Record<string, Unit> = {
  urad: { name: "µrad", size: 1 },
  arcsec: { name: "arcsec", size: Math.PI / 0.648 },
};

/** Values of the address, with their words. */
export const CHOICES: [value: string, words: string][] = Object.entries(LENGTHS).flatMap(([length, { name }]) =>
  Object.entries(ANGLES).map(([angle, of]): [string, string] => [`${length}-${angle}`, `${name}, ${of.name}`]),
);

let [length, angle] = ["um", "urad"];

/** Takes the units of the address, or else those that the text of a machine file has most. */
export function follow(text: string): void {
  const count = (units: string) => text.match(new RegExp(`\\d\\s*(?:${units})(?![\\w/])`, "g"))?.length ?? 0;
  const own = [
    count("in|inch") > count("mm|um|µm") ? "uin" : "um",
    count("arcsec") > count("urad") ? "arcsec" : "urad",
  ];
  const [first = "", second = ""] = place().units.split("-");
  length = first in LENGTHS ? first : (own[0] ?? "um");
  angle = second in ANGLES ? second : (own[1] ?? "urad");
}

/** The unit in which one of the program is read; other units stay. */
function read(unit: string): Unit {
  if (/^[uµ]m$/.test(unit)) return LENGTHS[length] ?? { name: unit, size: 1 };
  if (/^[uµ]rad$/.test(unit)) return ANGLES[angle] ?? { name: unit, size: 1 };
  return { name: unit, size: 1 };
}

/** Both units, for what is written elsewhere. */
export const both = (): Unit[] => [read("um"), read("urad")];

/** Name of the unit in which one of the program is read. */
export const named = (unit: string): string => read(unit).name;

/** A value of the program in the unit of the reader. */
export const inReaders = (value: number, unit: string): number => value / read(unit).size;

/** Rounds to what a drawing would show: three to four digits, a real minus. */
export function rounded(value: number): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  const digits = size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3;
  return value.toFixed(digits).replace("-", "−");
}

/** Positions are in mm; who reads micro-inches reads them in inches. */
const INCH = 25.4;
const isInches = () => length === "uin";

/** A position of an axis as it is read: with one decimal of a millimetre or a degree, and three of an inch. */
export function position(value: number, unit: string, digits = 1): string {
  const inch = unit === "mm" && isInches();
  const shown = inch ? value / INCH : value;
  const name = inch ? "in" : unit === "deg" ? "°" : unit;
  return `${Number(shown.toFixed(inch ? digits + 2 : digits))} ${name}`.replace("-", "−");
}

/** A sentence of the program: its positions in mm as they are read. */
export const positions = (words: string): string =>
  !isInches()
    ? words
    : words.replace(/([−-]?\d+(?:\.\d+)?) mm\b/g, (_, value: string) =>
        position(Number(value.replace("−", "-")), "mm"),
      );

/** A length beside the picture that is not longer than this one, mm, and round as it is read. */
export function roundLength(mm: number): { mm: number; words: string } {
  const size = isInches() ? INCH : 1;
  const most = mm / size;
  const power = 10 ** Math.floor(Math.log10(most));
  const round = (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1) * power;
  return { mm: round * size, words: `${Number(round.toPrecision(1))} ${size === 1 ? "mm" : "in"}` };
}

/** A value of the program as it is read, without its unit. */
export const bare = (value: number, unit = "um"): string => rounded(inReaders(value, unit));

/** A value of the program as it is read. */
export const quantity = (value: number, unit = "um"): string => `${bare(value, unit)} ${named(unit)}`;

/** A bound as it is read: as many digits as somebody wrote. */
export const bound = (value: number, unit: string): string =>
  `${Number(inReaders(value, unit).toPrecision(4))} ${named(unit)}`;

/** An interval of the program. */
export const between = ([low, high]: [number, number]): string => `${bare(low)} to ${quantity(high)}`;

/** A length of the address, um, as it stands in a field; and what is typed there for the address. */
export const toField = (um: string): string => um && digits(inReaders(Number(um), "um"));
export const fromField = (typed: string): string => typed && digits(Number(typed) * read("um").size);

const digits = (value: number) => String(Number(value.toPrecision(12)));

/** A sentence of the program: its numbers in um and urad as they are read. */
export function said(words: string): string {
  const found = /([−-]?\d+(?:\.\d+)?(?:e[-+]?\d+)?)( to (?:[−-]?\d+(?:\.\d+)?))? ?([uµ](?:m|rad))\b(?!\/)/g;
  return words.replace(found, (_, first: string, second: string | undefined, unit: string) => {
    const number = (text: string) => String(Number(inReaders(Number(text.replace("−", "-")), unit).toPrecision(4)));
    const more = second ? ` to ${number(second.slice(4))}` : "";
    return `${number(first)}${more} ${named(unit)}`.replaceAll("-", "−");
  });
}
