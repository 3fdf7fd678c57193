/** Bars and tables as pictures of their own, for documents: nothing from the page's style. */

import type { Picture } from "../ui/files";
import { quantity } from "../units";

export interface ChartBar {
  name: string;
  words: string;
  um: number;
}

const [WIDTH, ROW, HEAD, LEFT, RIGHT] = [760, 26, 46, 330, 80];

const INK = "#1f2933";

/** Bars under each other. */
export function barChart(title: string, note: string, bars: ChartBar[]): Picture {
  const most = Math.max(...bars.map((bar) => bar.um), 1e-9);
  const lines = bars.flatMap((bar, i) => {
    const y = HEAD + ROW * i;
    const length = ((WIDTH - LEFT - RIGHT) * bar.um) / most;
    return [
      text(12, y + 16, bar.name, 'font-weight="bold"'),
      text(78, y + 16, cut(bar.words), 'font-size="11"'),
      `<rect x="${LEFT}" y="${y + 5}" width="${length.toFixed(2)}" height="15" fill="#1d5fa8"/>`,
      text(LEFT + length + 6, y + 17, quantity(bar.um), ""),
    ];
  });
  return picture(title, note, HEAD + ROW * bars.length + 12, lines);
}

/** A table by its texts; the first rows are heads. */
export interface PictureTable {
  caption: string;
  heads: number;
  rows: string[][];
}

/** Tables under each other. */
export function tablePicture(title: string, tables: PictureTable[]): Picture {
  let y = HEAD + 8;
  const lines = tables.flatMap(({ caption, heads, rows }) => {
    const columns = Math.max(...rows.map((row) => row.length), 2);
    const right = (k: number) => WIDTH - RIGHT - ((columns - 1 - k) * (WIDTH - LEFT - RIGHT)) / (columns - 1);
    const cell = (content: string, k: number, style: string) =>
      k === 0 ? text(12, y, content, style) : text(right(k), y, content, `${style} text-anchor="end"`);
    const head = caption ? [text(12, y, caption, 'font-size="11" font-style="italic"')] : [];
    y += caption ? ROW : 0;
    const cells = rows.flatMap((row, i) => {
      const drawn = row.map((content, k) => cell(content, k, i < heads ? 'font-weight="bold"' : ""));
      y += ROW;
      return drawn;
    });
    y += ROW / 2;
    return [...head, ...cells];
  });
  return picture(title, "", y, lines);
}

function picture(title: string, note: string, height: number, lines: string[]): Picture {
  const head = [text(12, 20, title, 'font-size="16" font-weight="bold"'), text(12, 37, note, 'font-size="11"')];
  const size = `width="${WIDTH}" height="${height}"`;
  const frame = `xmlns="http://www.w3.org/2000/svg" ${size} viewBox="0 0 ${WIDTH} ${height}"`;
  const font = 'font-family="DejaVu Sans, Helvetica, Arial, sans-serif" font-size="13"';
  const content = [`<rect ${size} fill="#ffffff"/>`, ...head, ...lines].join("");
  return { svg: `<svg ${frame} ${font}>${content}</svg>`, width: WIDTH, height };
}

const cut = (words: string) => (words.length > 44 ? `${words.slice(0, 43).trimEnd()}…` : words);

function text(x: number, y: number, content: string, style: string): string {
  const escaped = content.replace(/[&<>]/g, (sign) => `&#${sign.charCodeAt(0)};`);
  return `<text x="${x.toFixed(1)}" y="${y}" fill="${INK}" ${style}>${escaped}</text>`;
}
