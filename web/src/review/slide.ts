/** The first screen as a picture for a slide: machine, verdict, and the eight answers, as the page shows them. */

import type { Picture } from "../ui/files";
import { escaped, text } from "./lines";

const [WIDTH, LEFT, PICTURE, LINE] = [1280, 620, 580, 19];

const INK = "#1f2933";

/** Letters to a line of an answer. */
const LETTERS = 46;

interface Written {
  words: string;
  style?: string;
}

/** Reads what the page says; `machine` is the picture of the machine, in PNG, and its size. */
export function slide(machine: { url: string; width: number; height: number } | null): Picture {
  const said = (selector: string) => document.querySelector(selector)?.textContent?.trim() ?? "";
  const rows = [...document.querySelectorAll<HTMLTableRowElement>(".answers tr")];
  let y = 40;
  const lines: string[] = [];
  const write = (x: number, { words, style = "" }: Written, letters: number) => {
    for (const line of wrapped(words, letters)) {
      lines.push(`<g ${style}>${text(x, y, line, INK, "start")}</g>`);
      y += LINE;
    }
  };
  write(30, { words: said("#name"), style: 'font-size="24" font-weight="bold"' }, 90);
  y += 8;
  write(30, { words: [said("#scope"), said(".headline")].filter(Boolean).join(": "), style: 'font-size="18"' }, 60);
  write(30, { words: said(".limit strong"), style: 'font-size="18" font-weight="bold"' }, 60);
  write(30, { words: said(".band"), style: 'font-size="13"' }, 80);
  const top = y;
  y = 110;
  for (const row of rows) {
    const [head, cell] = row.cells;
    const why = cell?.querySelector(".why")?.textContent ?? "";
    const answer = [...(cell?.childNodes ?? [])].filter((of) => !(of as Element).matches?.(".why"));
    write(LEFT + 30, { words: head?.textContent ?? "", style: 'font-size="13"' }, 70);
    const words = answer.map((of) => of.textContent).join("");
    write(LEFT + 30, { words, style: 'font-size="15" font-weight="bold"' }, LETTERS + 18);
    write(LEFT + 30, { words: why, style: 'font-size="12"' }, LETTERS + 34);
    y += 8;
  }
  const height = Math.max(y + 20, 720);
  const image = machine && { ...machine, x: 30, y: top + 10, width: PICTURE, height: height - top - 40 };
  const drawn = image
    ? `<image href="${image.url}" x="${image.x}" y="${image.y}" width="${image.width}" height="${image.height}"/>`
    : "";
  const ground = `<rect width="${WIDTH}" height="${height}" fill="#ffffff"/>`;
  const font = 'font-family="DejaVu Sans, Helvetica, Arial, sans-serif"';
  const size = `width="${WIDTH}" height="${height}" viewBox="0 0 ${WIDTH} ${height}"`;
  const title = `<title>${escaped(said("#name"))}</title>`;
  const svg = `<svg xmlns="http://www.w3.org/2000/svg" ${size} ${font}>${title}${ground}${drawn}${lines.join("")}</svg>`;
  return { svg, width: WIDTH, height };
}

/** Words in lines of at most so many letters. */
function wrapped(words: string, letters: number): string[] {
  const lines: string[] = [];
  for (const word of words.split(/\s+/).filter(Boolean)) {
    const last = lines.at(-1);
    if (last !== undefined && last.length + word.length < letters) lines[lines.length - 1] = `${last} ${word}`;
    else lines.push(word);
  }
  return lines;
}
