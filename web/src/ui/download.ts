/** Tables and charts as files: CSV, SVG, PNG. */

import { make } from "./dom";

export type Cell = string | number | null;

export const download = {
  csv: (name: string, rows: Cell[][]) => save(`${name}.csv`, new Blob([csv(rows)], { type: "text/csv" })),
  svg: (name: string, svg: string) => save(`${name}.svg`, new Blob([svg], { type: "image/svg+xml" })),
  /** A picture of this size, from its SVG. */
  png: async (name: string, svg: string, width: number, height: number) => {
    const image = new Image();
    image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
    await image.decode();
    const canvas = make("canvas", { width: String(2 * width), height: String(2 * height) });
    canvas.getContext("2d")?.drawImage(image, 0, 0, 2 * width, 2 * height);
    canvas.toBlob((blob) => blob && save(`${name}.png`, blob));
  },
  canvas: (name: string, canvas: HTMLCanvasElement) => canvas.toBlob((blob) => blob && save(`${name}.png`, blob)),
};

/** A text that begins like a formula stays a text in a spreadsheet. */
export function csv(rows: Cell[][]): string {
  const cell = (value: Cell) => {
    const text = value === null ? "" : String(value);
    const safe = typeof value === "string" && /^[=+\-@\t\r]/.test(text) ? `'${text}` : text;
    return /[",\r\n]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
  };
  return rows.map((row) => `${row.map(cell).join(",")}\n`).join("");
}

export function save(name: string, blob: Blob): void {
  const link = make("a", { download: name });
  link.href = URL.createObjectURL(blob);
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
