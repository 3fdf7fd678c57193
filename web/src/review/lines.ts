/** Curves over the travel of an axis as SVG: the length of the deviation and its parts, told apart by dashes too. */

import type { Vec3 } from "../evaluator/types";
import { inReaders, named } from "../units";

export interface Sample {
  /** Position of the axis. */
  at: number;
  um: number;
  parts: Vec3 | null;
}

export const SIZE = { width: 420, height: 230 };
export const MARGIN = { left: 46, right: 24, top: 12, bottom: 34 };

/** Colours that are told apart without red and green, with their dashes. */
const LINES = [
  { name: "X", colour: "#0072b2", dash: "7 3" },
  { name: "Y", colour: "#d55e00", dash: "2 3" },
  { name: "Z", colour: "#8a6d00", dash: "9 3 2 3" },
];

export function lineChart(title: string, xLabel: string, given: Sample[], ink: string): string {
  const read = (um: number) => inReaders(um, "um");
  const samples = given.map(({ at, um, parts }) => ({ at, um: read(um), parts: parts && (parts.map(read) as Vec3) }));
  const { width, height } = SIZE;
  const values = samples.flatMap(({ um, parts }) => [um, ...(parts ?? [])]);
  const [low, high] = [Math.min(0, ...values), Math.max(...values, 1e-9)];
  const ends = [samples[0]?.at ?? 0, samples[samples.length - 1]?.at ?? 1] as const;
  const x = (at: number) =>
    MARGIN.left + ((at - ends[0]) / (ends[1] - ends[0] || 1)) * (width - MARGIN.left - MARGIN.right);
  const y = (um: number) =>
    height - MARGIN.bottom - ((um - low) / (high - low)) * (height - MARGIN.top - MARGIN.bottom);
  const path = (pick: (of: Sample) => number) =>
    samples.map((of, i) => `${i ? "L" : "M"}${x(of.at).toFixed(1)} ${y(pick(of)).toFixed(1)}`).join("");
  const grid = ticks(low, high, 5).map(
    (um) =>
      `<path d="M${MARGIN.left} ${y(um).toFixed(1)}H${width - MARGIN.right}" stroke="${ink}" stroke-opacity="${um === 0 ? 0.6 : 0.15}"/>` +
      text(MARGIN.left - 5, y(um) + 4, tick(um), ink, "end"),
  );
  const below = ticks(ends[0], ends[1], 6).map((at) =>
    text(x(at), height - MARGIN.bottom + 15, tick(at), ink, "middle"),
  );
  const last = samples[samples.length - 1];
  const labels = apart((last?.parts ?? []).map((um) => y(um) + 4));
  const parts = last?.parts
    ? LINES.flatMap(({ name, colour, dash }, k) => [
        `<path d="${path((of) => of.parts?.[k] ?? 0)}" fill="none" stroke="${colour}" stroke-width="1.6" stroke-dasharray="${dash}"/>`,
        text(width - MARGIN.right + 4, labels[k] ?? 0, name, colour, "start"),
      ])
    : [];
  const whole = `<path d="${path(({ um }) => um)}" fill="none" stroke="${ink}" stroke-width="2.2"/>`;
  const axes = [
    text(width - MARGIN.right, height - 4, xLabel, ink, "end"),
    text(
      4,
      height - 4,
      last?.parts ? `${named("um")}; full line: length` : `${named("um")}, 95 % of machines`,
      ink,
      "start",
    ),
  ];
  const font = 'font-family="DejaVu Sans, Helvetica, Arial, sans-serif" font-size="11"';
  const size = `width="${width}" height="${height}" viewBox="0 0 ${width} ${height}"`;
  const ground = ink === "currentColor" ? "" : `<rect width="${width}" height="${height}" fill="#ffffff"/>`;
  const content = [`<title>${escaped(title)}</title>`, ground, ...grid, ...below, ...parts, whole, ...axes].join("");
  return `<svg xmlns="http://www.w3.org/2000/svg" ${size} ${font}>${content}</svg>`;
}

/** Heights of labels that do not lie over each other. */
function apart(heights: number[]): number[] {
  const order = heights.map((_, i) => i).sort((a, b) => (heights[a] ?? 0) - (heights[b] ?? 0));
  const placed = [...heights];
  order.forEach((i, k) => {
    const above = placed[order[k - 1] ?? -1];
    if (above !== undefined) placed[i] = Math.max(placed[i] ?? 0, above + 11);
  });
  return placed;
}

/** Round numbers between two ends. */
export function ticks(low: number, high: number, count: number): number[] {
  const raw = (high - low) / count || 1;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = ([1, 2, 5].find((k) => k * power >= raw) ?? 10) * power;
  const first = Math.ceil(low / step - 1e-9);
  return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, i) => (first + i) * step);
}

const tick = (value: number) => String(Number(value.toPrecision(6))).replace("-", "−");

export const escaped = (words: string) => words.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);

export function text(x: number, y: number, words: string, colour: string, anchor: string): string {
  return `<text x="${x.toFixed(1)}" y="${y.toFixed(1)}" fill="${colour}" text-anchor="${anchor}">${escaped(words)}</text>`;
}
