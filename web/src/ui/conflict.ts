/** Two texts of one file: that of the page, and that which others wrote. */

import { button, make } from "./dom";
import { save } from "./download";

/** A line of a difference: of the page, of the others, or of both. */
export interface DiffLine {
  of: "mine" | "theirs" | "both";
  text: string;
}

/** Lines that are kept in common around a difference. */
const AROUND = 3;

/** Above this many pairs of lines what lies between the common ends is shown as a whole. */
const MOST_PAIRS = 4e6;

/** Returns the lines of both texts in their order, as few as possible of them of one only. */
export function lineDifference(mine: string, theirs: string): DiffLine[] {
  const [a, b] = [mine.split("\n"), theirs.split("\n")];
  let head = 0;
  while (head < Math.min(a.length, b.length) && a[head] === b[head]) head += 1;
  let tail = 0;
  while (tail < Math.min(a.length, b.length) - head && a.at(-1 - tail) === b.at(-1 - tail)) tail += 1;
  const all = (of: DiffLine["of"], list: string[]) => list.map((text): DiffLine => ({ of, text }));
  const [inA, inB] = [a.slice(head, a.length - tail), b.slice(head, b.length - tail)];
  const ends = [all("both", a.slice(0, head)), all("both", a.slice(a.length - tail))] as const;
  if (inA.length * inB.length > MOST_PAIRS) return [...ends[0], ...all("theirs", inB), ...all("mine", inA), ...ends[1]];
  return [...ends[0], ...between(inA, inB), ...ends[1]];
}

/** By the longest common subsequence. */
function between(a: string[], b: string[]): DiffLine[] {
  const width = b.length + 1;
  const common = new Uint32Array((a.length + 1) * width);
  const at = (i: number, k: number) => common[i * width + k] ?? 0;
  for (let i = a.length - 1; i >= 0; i -= 1)
    for (let k = b.length - 1; k >= 0; k -= 1)
      common[i * width + k] = a[i] === b[k] ? at(i + 1, k + 1) + 1 : Math.max(at(i + 1, k), at(i, k + 1));
  const lines: DiffLine[] = [];
  let [i, k] = [0, 0];
  while (i < a.length || k < b.length) {
    const [x, y] = [a[i], b[k]];
    if (x !== undefined && x === y) (lines.push({ of: "both", text: x }), (i += 1), (k += 1));
    else if (y !== undefined && (x === undefined || at(i, k + 1) >= at(i + 1, k)))
      (lines.push({ of: "theirs", text: y }), (k += 1));
    else (lines.push({ of: "mine", text: x ?? "" }), (i += 1));
  }
  return lines;
}

/** What a reader may do about it; `name` is that of the file. */
export function choices(
  name: string,
  mine: () => string,
  theirs: string,
  take: () => void,
  over: () => void,
): HTMLElement[] {
  const stem = (name.split(/[/\\]/).pop() ?? "machine.yaml").replace(/\.ya?ml$/i, "");
  const saveAs = () => save(`${stem}-mine.yaml`, new Blob([mine()], { type: "application/yaml" }));
  return [
    button("Difference", () => showDifference(mine(), theirs), { id: "difference" }),
    button("Take theirs", take, { id: "theirs", title: "Undo brings back what is changed here" }),
    button("Save mine as a file", saveAs, { id: "save-as" }),
    button("Keep mine", over, { id: "mine", title: "The next save writes it over theirs" }),
  ];
}

const MARKS = { mine: "+", theirs: "−", both: " " };

function showDifference(mine: string, theirs: string): void {
  const lines = lineDifference(mine, theirs);
  const isNear = (i: number) => lines.slice(Math.max(0, i - AROUND), i + AROUND + 1).some(({ of }) => of !== "both");
  const shown = lines.flatMap((line, i) => (isNear(i) ? [{ line, i }] : []));
  const rows = shown.flatMap(({ line, i }, k) => {
    const row = make("div", { class: `line ${line.of}` }, `${MARKS[line.of]} ${line.text}`);
    return k > 0 && shown[k - 1]?.i !== i - 1 ? [make("div", { class: "line" }, "…"), row] : [row];
  });
  const close = button("Close", () => dialog.close(), { class: "primary" });
  const words = rows.length ? "− on the disk, + here" : "Both are the same.";
  const dialog = make(
    "dialog",
    { id: "differences", "aria-label": "Difference between the file on the disk and what is changed here" },
    make("p", { class: "words" }, words),
    make("div", { class: "lines", tabindex: "0" }, ...rows),
    close,
  );
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}
