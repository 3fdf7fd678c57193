/** Bars as a picture of their own, for documents: the whole numbers beside them, nothing from the page's style. */

import { rounded } from "./number";

export interface ChartBar {
  name: string;
  words: string;
  um: number;
}

const [WIDTH, ROW, HEAD, LEFT, RIGHT] = [760, 26, 46, 330, 80];

const INK = "#1f2933";

/** Returns the SVG and its size. */
export function barChart(
  title: string,
  note: string,
  bars: ChartBar[],
): { svg: string; width: number; height: number } {
  const most = Math.max(...bars.map((bar) => bar.um), 1e-9);
  const height = HEAD + ROW * bars.length + 12;
  const lines = bars.flatMap((bar, i) => {
    const y = HEAD + ROW * i;
    const length = ((WIDTH - LEFT - RIGHT) * bar.um) / most;
    return [
      text(12, y + 16, bar.name, 'font-weight="bold"'),
      text(78, y + 16, cut(bar.words), 'font-size="11"'),
      `<rect x="${LEFT}" y="${y + 5}" width="${length.toFixed(2)}" height="15" fill="#1d5fa8"/>`,
      text(LEFT + length + 6, y + 17, `${rounded(bar.um)} µm`, ""),
    ];
  });
  const head = [text(12, 20, title, 'font-size="16" font-weight="bold"'), text(12, 37, note, 'font-size="11"')];
  const size = `width="${WIDTH}" height="${height}"`;
  const frame = `xmlns="http://www.w3.org/2000/svg" ${size} viewBox="0 0 ${WIDTH} ${height}"`;
  const font = 'font-family="DejaVu Sans, Helvetica, Arial, sans-serif" font-size="13"';
  const content = [`<rect ${size} fill="#ffffff"/>`, ...head, ...lines].join("");
  const svg = `<svg ${frame} ${font}>${content}</svg>`;
  return { svg, width: WIDTH, height };
}

const cut = (words: string) => (words.length > 44 ? `${words.slice(0, 43).trimEnd()}…` : words);

function text(x: number, y: number, content: string, style: string): string {
  const escaped = content.replace(/[&<>]/g, (sign) => `&#${sign.charCodeAt(0)};`);
  return `<text x="${x.toFixed(1)}" y="${y}" fill="${INK}" ${style}>${escaped}</text>`;
}
