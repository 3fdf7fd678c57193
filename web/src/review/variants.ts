/** Variants side by side: the text that was kept as A beside the present one, on the same tool poses. */

import type { Editor } from "../editor/editor";
import { Newest } from "../evaluator/newest";
import type { JudgedDifference } from "../evaluator/results";
import { accepted, type Comparison, type Refusal } from "../evaluator/types";
import { isSettled, type Session, type State } from "../session";
import type { Tell } from "./answers";
import { button, make } from "../ui/dom";
import { download } from "../ui/download";
import { row, table } from "../ui/table";
import { figure } from "./number";
import { scopeOf } from "./verdict";
import { between, quantity } from "../units";

/** Names of the texts of variants, in the folder of the machine so that what they name is found. */
const file = (letter: string) => `variant-${letter}.abbe.yaml`;

const LETTERS = [..."ABCDEF"];

const ROWS = [
  ["p95", "95 % of the poses"],
  ["max", "Largest deviation"],
  ["rms", "Root mean square"],
] as const;

/** A variant beside the present state. */
interface Variant {
  /** Its name in tables. */
  name: string;
  text: string;
  /** Its file, where it has one. */
  file?: string;
}

export class Variants {
  private readonly list: Variant[] = [];
  private readonly body = make("div", { "aria-live": "polite" });
  private readonly back = button("Back to A", () => this.restore(), { id: "back-to-a" });
  private readonly asking: Newest;

  constructor(
    parent: HTMLElement,
    private readonly session: Session,
    private readonly editor: Editor,
    /** Hears of the text of A. */
    private readonly kept: (first: string) => void,
    private readonly tell: Tell,
    failed: (failure: unknown) => void,
  ) {
    this.asking = new Newest(failed, this.body);
    const keep = button("Keep this state", () => this.add("", this.editor.text), { class: "primary", id: "keep-a" });
    const chosen = make("input", {
      type: "file",
      "aria-label": "Machine file to compare",
      id: "other-file",
      hidden: "",
    });
    chosen.addEventListener("change", () => void this.open(chosen));
    const open = button("Open another machine", () => chosen.click(), { id: "open-other" });
    this.back.disabled = true;
    const words =
      "Keep the machine as a variant and go on editing, or open the file of another one, whose tables lie beside this " +
      "machine. All are compared on the same tool poses: those of the job, or 1000 of the volume.";
    parent.append(
      make("p", { class: "words" }, words),
      make("p", {}, keep, " ", open, chosen, " ", this.back),
      this.body,
    );
  }

  show(state: State): void {
    this.body.classList.toggle("stale", !isSettled(state));
    if (this.list.length && isSettled(state)) this.compare();
  }

  private async open(chosen: HTMLInputElement): Promise<void> {
    const other = chosen.files?.[0];
    if (other) this.add(other.name, await other.text());
    chosen.value = "";
  }

  /** A state that is kept has a letter; beyond the last one it takes the place of the last. */
  private add(name: string, text: string): void {
    if (this.list.length === LETTERS.length) this.list.pop();
    const letter = LETTERS[this.list.length] ?? "";
    this.list.push({ name: name ? `${letter}: ${name}` : letter, text });
    this.changed();
    this.compare();
  }

  private changed(): void {
    this.kept(this.list[0]?.text ?? "");
    this.back.disabled = this.list.length === 0;
  }

  /** Begins with machines that have files. */
  begin(others: { machine: string; text: string }[]): void {
    const named = (of: string, i: number) => `${LETTERS[i]}: ${of.replace(/^.*[/\\]/, "")}`;
    const few = others.slice(0, LETTERS.length);
    this.list.splice(
      0,
      this.list.length,
      ...few.map((of, i) => ({ name: named(of.machine, i), text: of.text, file: of.machine })),
    );
    this.changed();
  }

  private restore(): void {
    const [first] = this.list;
    if (first) this.editor.change({ from: 0, to: this.editor.view.state.doc.length, insert: first.text });
  }

  private answer(of: Comparison): void {
    const best = bestOf(of);
    const { which, by, sure } = verdictOf(of, best);
    const names = [...this.list.map(({ name }) => name), "The present state"];
    const told = which === "better" ? (names[best] ?? "") : which === "first" ? names[0] : "";
    const words = told || { none: "No verdict", equal: "Equal", open: "Not told apart" }[which as "none"];
    this.tell("better", { words, mark: told ? "yes" : "open", why: [`${capital(scopeOf(of.over))}.`] });
    this.tell("by", { words: "", figure: by });
    const isSure = sure.startsWith("Yes");
    const mark = isSure ? "yes" : sure.startsWith("No:") ? "no" : "open";
    const [short, ...rest] = sure.split(/(?<=^\w+): /);
    this.tell("sure", { words: short ?? "", mark, why: rest });
  }

  private compare(): void {
    void this.asking.do(async () => {
      const files = this.list.map((of, i) => of.file ?? this.session.beside(file(LETTERS[i] ?? "")));
      const [first = "", ...more] = files;
      const texts = Object.fromEntries(this.list.map(({ text }, i) => [files[i] ?? "", text]));
      const options = this.session.settings.compare;
      const [answer] = await this.session.askAtRest([{ compare: { first, more, options } }], texts);
      const found = accepted<Comparison>(answer);
      if (answer === undefined) return;
      const names = [...this.list.map(({ name }) => name), "now"];
      this.body.replaceChildren(...(found ? shown(found, names) : refused(answer as Refusal)));
      if (found) this.answer(found);
      else for (const of of ["better", "by", "sure"] as const) this.tell(of);
    });
  }
}

const capital = (words: string) => words.charAt(0).toUpperCase() + words.slice(1);

/** Index of the machine that the program finds most better than the first; the present one where it finds none. */
function bestOf(of: Comparison): number {
  const better = of.verdicts.flatMap(({ verdict, by }, i) =>
    verdict === "better" && by ? [{ i: i + 1, um: by.um }] : [],
  );
  return better.sort((a, b) => a.um - b.um)[0]?.i ?? of.verdicts.length;
}

function refused(answer: Refusal): HTMLElement[] {
  return answer.diagnostics.map(({ message }) => make("p", { class: "refused" }, message));
}

function shown(of: Comparison, names: string[]): HTMLElement[] {
  const { machines } = of;
  const rows = ROWS.map(([at, words]) => {
    const own = machines.map((machine, i) =>
      figure(`${sideOf(i, machines.length)}-${at}`, machine.position_um[at], "µm"),
    );
    const by = machines
      .slice(1)
      .map((machine, i) =>
        figure(`${sideOf(i + 1, machines.length)}-a-${at}`, machine.minus_first?.position_um[at] ?? 0, "µm"),
      );
    return row(words, ...own, ...by);
  });
  const list = table(["Figure", ...names, ...names.slice(1).map((name) => `${name} − A`)], rows);
  const cells = ROWS.map(([at, words]) => [words, ...machines.map(({ position_um }) => position_um[at])]);
  const csv = () => download.csv("variants", [["figure", ...names.map((name) => `${name}_um`)], ...cells]);
  const poses = `${of.poses} of ${of.asked} tool poses, which all reach, ${scopeOf(of.over)}.`;
  const verdicts = names.slice(1).map((name, i) => {
    const words = judgement(of, i + 1);
    return make(
      "li",
      i === names.length - 2 ? { id: "told-apart" } : {},
      make("strong", {}, names.length > 2 ? `${name}: ${words}` : words),
    );
  });
  return [
    make("ul", { class: "plain" }, ...verdicts),
    make("div", { class: "scroll", tabindex: "0" }, list),
    ...because(of),
    make("p", { class: "words" }, poses, " ", button("CSV", csv)),
  ];
}

/** Name of the column of a machine for tests: letters from `a`, the present one is the last. */
const sideOf = (i: number, count: number) => (count === 2 && i === 1 ? "b" : i === count - 1 ? "now" : "abcdef"[i]);

/** The three answers of a comparison: which is better, by how much, and whether that is more than what is known of it. */
export interface Judgement {
  which: "better" | "first" | "equal" | "open" | "none";
  by: (Node | string)[];
  sure: string;
}

/** The interval of a difference, if one is known: of drawn machines, or else of values with a stated uncertainty. */
function interval(of: Comparison, by: JudgedDifference, machine: number): [number, number] | null {
  if (typeof by.low === "number" && typeof by.high === "number") return [by.low, by.high];
  return by.drawn ? null : (of.machines[machine]?.uncertainty?.minus_first.position_um.p95 ?? null);
}

/** What is judged, in words. */
const figureOf = ({ drawn, statistic }: JudgedDifference): string =>
  `in the ${statistic === "max" ? "largest deviation" : "deviation that 95 % of poses keep"}${drawn ? " of 95 % of drawn machines" : ""}`;

/** The verdict on a machine of a comparison against the first. */
export function verdictOf(of: Comparison, machine: number): Judgement {
  const judged = of.verdicts[machine - 1];
  const { verdict, by } = judged ?? {};
  if (!verdict || !by) return { which: "none", by: ["Not judged"], sure: `No: ${judged?.reason ?? "not known"}.` };
  if (verdict === "equal")
    return { which: "equal", by: ["Nothing"], sure: by.drawn ? "Equal: in every drawn machine." : "Equal" };
  const ends = interval(of, by, machine);
  const band = ends && between(ends);
  const words = [figure("answer-by", by.um, "µm"), by.drawn ? " for 95 % of machines" : ` ${figureOf(by)}`];
  if (verdict === "not_told_apart")
    return { which: "open", by: words, sure: `No: ${band ?? "they are not told apart"}.` };
  const which = verdict === "better" ? "better" : "first";
  if (band) return { which, by: words, sure: `Yes: ${band}.` };
  return { which, by: words, sure: by.drawn ? "Yes" : "Unknown: the files state no uncertainty." };
}

/** Which is better, and whether that is more than what is known of the two. */
export function judgement(of: Comparison, machine = 1): string {
  const judged = of.verdicts[machine - 1];
  const { verdict, by } = judged ?? {};
  if (!verdict || !by) return `No verdict: ${judged?.reason ?? "not known"}.`;
  if (verdict === "equal") return by.drawn ? "Equal in every drawn machine." : "Equal.";
  const ends = interval(of, by, machine);
  const band = ends ? ` (${between(ends)})` : "";
  const size = `${quantity(by.um)}${band} ${figureOf(by)}`;
  if (verdict === "not_told_apart") return `Not told apart: ${size}.`;
  const which = verdict === "better" ? "Better" : "Worse";
  if (band || by.drawn)
    return `${which} than A, more than ${by.drawn ? "the drawn machines differ" : "the uncertainty"}: ${size}.`;
  return `${which} than A: ${size}; the files state no uncertainty, so it is not known whether that is more than it.`;
}

/** The errors whose part changed most. */
function because(of: Comparison): HTMLElement[] {
  const changed = of.contributions
    .map(({ error, minus_first }) => ({ error, by: minus_first.at(-1) ?? 0 }))
    .filter(({ by }) => Math.abs(by) > 5e-3)
    .sort((x, y) => Math.abs(y.by) - Math.abs(x.by))
    .slice(0, 4);
  if (!changed.length) return [];
  const list = changed.map(({ error, by }) =>
    make(
      "li",
      {},
      make("span", { "data-error": error, tabindex: "0", class: "error-name" }, error),
      ` ${by > 0 ? "+" : ""}${quantity(by)}`,
    ),
  );
  return [
    make("p", { class: "words" }, "Each error alone, where it changed most:"),
    make("ul", { class: "inline" }, ...list),
  ];
}
