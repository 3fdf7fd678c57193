/** Buttons that download a chart or a table: its figures as CSV, and its picture as SVG and PNG. */

import { button } from "./dom";
import { type Cell, download } from "./download";

/** A picture with its size. */
export interface Picture {
  svg: string;
  width: number;
  height: number;
}

/** `name` is that of the files, without ending. */
export function fileButtons(name: string, rows: () => Cell[][], picture: () => Picture): HTMLElement[] {
  const png = () => {
    const { svg, width, height } = picture();
    void download.png(name, svg, width, height);
  };
  const files: [string, () => void][] = [
    ["CSV", () => download.csv(name, rows())],
    ["SVG", () => download.svg(name, picture().svg)],
    ["PNG", png],
  ];
  return files.map(([label, save]) => button(label, save, { title: `Download as ${name}.${label.toLowerCase()}` }));
}
