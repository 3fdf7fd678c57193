/** Tables: heads that stay in sight and sort the rows, and the table as CSV with the whole figures. */

import { button, make } from "./dom";
import type { Cell } from "./download";
import { fileButtons } from "./files";
import { type PictureTable, tablePicture } from "../review/chart";

/** A row: its head and its cells. */
export function row(head: Node | string, ...cells: (Node | string | (Node | string)[])[]): HTMLTableRowElement {
  const first = head instanceof HTMLTableCellElement ? head : make("th", { scope: "row" }, head);
  return make("tr", {}, first, ...cells.map((cell) => make("td", {}, ...(Array.isArray(cell) ? cell : [cell]))));
}

/** A table under these heads; it is sorted by a click on one of them, back by a third. */
export function table(heads: string[], rows: HTMLTableRowElement[]): HTMLTableElement {
  const body = make("tbody", {}, ...rows);
  const cells = heads.map((head) => make("th", { scope: "col" }, head));
  if (rows.length > 2) cells.forEach((cell, i) => sorting(cell, i, cells, body, rows));
  return make("table", { class: "list" }, make("thead", {}, make("tr", {}, ...cells)), body);
}

function sorting(
  cell: HTMLTableCellElement,
  column: number,
  all: HTMLTableCellElement[],
  body: HTMLElement,
  rows: HTMLTableRowElement[],
): void {
  const sort = () => {
    const was = cell.getAttribute("aria-sort");
    const now = was === null ? "descending" : was === "descending" ? "ascending" : null;
    all.forEach((other) => other.removeAttribute("aria-sort"));
    if (now) cell.setAttribute("aria-sort", now);
    body.replaceChildren(...(now ? sorted(rows, column, now === "descending" ? -1 : 1) : rows));
  };
  cell.replaceChildren(button(cell.textContent ?? "", sort, { title: "Sort by this column" }));
}

function sorted(rows: HTMLTableRowElement[], column: number, way: 1 | -1): HTMLTableRowElement[] {
  const key = (row: HTMLTableRowElement) => value(row.cells[column]);
  return [...rows].sort((a, b) => way * compared(key(a), key(b)));
}

/** Words count as less than any number. */
export function compared(a: Cell, b: Cell): number {
  if (typeof a === "number" && typeof b === "number") return a - b;
  if (typeof a === "number") return 1;
  if (typeof b === "number") return -1;
  return String(a ?? "").localeCompare(String(b ?? ""), "en", { numeric: true });
}

/** The whole figure of a cell, else its number, else its words. */
function value(cell: HTMLTableCellElement | undefined): Cell {
  const whole = cell?.querySelector<HTMLElement>("[data-value]")?.dataset["value"];
  const text = cell?.textContent?.trim() ?? "";
  return whole === undefined ? quantity(text) : Number(whole);
}

/** A number with or without a unit; other texts stay. */
export function quantity(text: string): Cell {
  const match = /^([-−+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?)(?:\s*[µa-zA-Z%/°]*)?$/.exec(text);
  return match?.[1] === undefined ? text : Number(match[1].replace("−", "-"));
}

/** A section that folds, under a head. */
export function folding(title: string, ...content: (Node | string)[]): HTMLDetailsElement {
  return make("details", { open: "", class: "fold" }, make("summary", {}, title), ...content);
}

/** Buttons that download tables: a line for every figure, with its row, its column and its unit; and a picture. */
export function tableFiles(name: string, title: string, ...of: HTMLTableElement[]): HTMLElement[] {
  const lines = () => of.flatMap((table) => [...(table.tBodies[0]?.rows ?? [])].flatMap((row) => figures(table, row)));
  return fileButtons(
    name,
    () => [["row", "column", "value", "unit"], ...lines()],
    () => tablePicture(title, of.map(words)),
  );
}

/** What a table says, under the title of its section. */
function words(of: HTMLTableElement): PictureTable {
  const rows = [...of.rows].map((row) => [...row.cells].map(text));
  const titles = [of.closest("details")?.querySelector("summary"), of.caption];
  const caption = titles.flatMap((title) => (title ? [text(title)] : [])).join(": ");
  return { caption, heads: of.tHead?.rows.length ?? 0, rows };
}

function figures(table: HTMLTableElement, row: HTMLTableRowElement): Cell[][] {
  const heads = [...(table.tHead?.rows[0]?.cells ?? [])].map(text);
  const [first, ...cells] = [...row.cells];
  const name = first ? text(first) : "";
  return cells.flatMap((cell, i) => {
    const whole = [...cell.querySelectorAll<HTMLElement>("[data-value]")];
    const column = heads[i + 1] ?? "";
    if (!whole.length) return [[name, column, text(cell), ""]];
    return whole.map((of) => [
      name,
      column || text(of.parentElement ?? of),
      Number(of.dataset["shown"] ?? of.dataset["value"]),
      unit(of),
    ]);
  });
}

function text(of: HTMLElement): string {
  return of.textContent?.trim() ?? "";
}

function unit(of: HTMLElement): string {
  return text(of).split(" ").pop() ?? "";
}
