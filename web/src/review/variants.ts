/** Variants side by side: the text that was kept as A beside the present one, on the same tool poses. */

import type { Editor } from "../editor/editor";
import { Newest } from "../evaluator/newest";
import type { JudgedDifference } from "../evaluator/results";
import { accepted, type Comparison, type Refusal } from "../evaluator/types";
import { isSettled, type Session, type State } from "../session";
import type { Answer, Tell } from "./answers";
import { type AskedPart, type Column, Columns, type Eight } from "./columns";
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
  private readonly beside = make("div", { "aria-live": "polite" });
  private readonly columns: Columns;
  /** Name of the machine that is open, beside others. */
  private own = PRESENT;
  private readonly back = button("Back to A", () => this.restore(), { id: "back-to-a" });
  private readonly asking: Newest;

  constructor(
    private readonly parent: HTMLElement,
    private readonly session: Session,
    private readonly editor: Editor,
    part: AskedPart,
    /** Hears of the text of A. */
    private readonly kept: (first: string) => void,
    private readonly tell: Tell,
    failed: (failure: unknown) => void,
  ) {
    this.asking = new Newest(failed, this.body);
    this.columns = new Columns(this.beside, session, part, failed);
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
      make("p", { class: "words keeping" }, words),
      make("p", { class: "keeping" }, keep, " ", open, chosen, " ", this.back),
      this.beside,
      this.body,
    );
  }

  /** The panel is looked at. */
  opened(): void {
    this.columns.opened();
  }

  show(state: State): void {
    for (const of of [this.body, this.beside]) of.classList.toggle("stale", !isSettled(state));
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

  /** Begins with machines that have files, as the one that is open. */
  begin(others: { machine: string; text: string }[], own: string): void {
    const fileOf = (of: string) => of.replace(/^.*[/\\]/, "");
    const named = (of: string, i: number) => `${LETTERS[i]}: ${fileOf(of)}`;
    this.own = fileOf(own);
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

  /** The first three answers. Of several machines each is compared with the best. */
  private answer(of: Comparison, names: string[], ranked: Comparison | null): void {
    if (ranked) return this.several(ranked, names);
    const best = bestOf(of);
    const { which, by, sure } = verdictOf(of, best);
    const told = which === "better" ? (names[best] ?? "") : which === "first" ? names[0] : "";
    const words = told || { none: "No verdict", equal: "Equal", open: "Not told apart" }[which as "none"];
    this.tell("better", { words, mark: told ? "yes" : "open", why: [`${capital(scopeOf(of.over))}.`] });
    this.tell("by", { words: "", figure: by });
    this.tell("sure", surely(sure));
  }

  /** Three or more machines, the best one first in the comparison and in the names. */
  private several(of: Comparison, names: string[]): void {
    const rest = names.slice(1).map((name, i) => ({ name, ...verdictOf(of, i + 1), at: i + 1 }));
    const isBest = rest.every(({ which }) => which === "first");
    const isOpen = rest.some(({ which }) => which !== "first" && which !== "none");
    const words = isBest ? (names[0] ?? "") : isOpen ? `${names[0]}, or one that is not told apart` : "No verdict";
    const [judged] = of.verdicts.flatMap(({ by }) => (by ? [by] : []));
    const over = `${capital(scopeOf(of.over))}${judged ? `, ${figureOf(judged)}` : ""}.`;
    this.tell("better", { words, mark: isBest ? "yes" : "open", why: [over] });
    const sizes = rest.map(({ name, at }) => [...sizeOf(of, at, rest.length), ` less than ${name}`]);
    this.tell("by", { words: "", figure: sizes.flatMap((size, i) => (i ? ["; ", ...size] : size)) });
    this.tell("sure", together(rest));
  }

  private compare(): void {
    void this.asking.do(async () => {
      const list = this.machines();
      const of = (machines: Machine[]) => this.compared(machines);
      const answer = await of(list);
      const found = accepted<Comparison>(answer);
      if (answer === undefined) return;
      const own = this.own === PRESENT ? "now" : this.own;
      const names = [...this.list.map(({ name }) => name), own];
      this.body.replaceChildren(...(found ? shown(found, names) : refused(answer as Refusal)));
      this.beside.replaceChildren();
      if (!found) return (["better", "by", "sure"] as const).forEach((asked) => this.tell(asked));
      const best = bestAmong(found);
      const turned = [...list.slice(best), ...list.slice(0, best)];
      const isOne = list.length < 3 || best === 0;
      const ranked = list.length < 3 ? null : isOne ? found : accepted<Comparison>(await of(turned));
      const order = ranked ? turned : list;
      const titles = nameless(order, ranked ?? found);
      this.answer(found, titles, ranked);
      const told = order.map((_, i) => against(ranked ?? found, i, titles[0] ?? ""));
      const columns = order.map((of, i) => ({ ...of, name: titles[i] ?? of.name }));
      this.columns.show(columns, told, !this.parent.hidden);
    });
  }

  /** The variants and the present state, as they are to be read. */
  private machines(): Machine[] {
    const variants = this.list.map(({ name, text, file: own }, i) => {
      return { name, text, machine: own ?? this.session.beside(file(LETTERS[i] ?? "")) };
    });
    return [...variants, { name: this.own, text: this.editor.text, machine: this.session.machine }];
  }

  /** Compares machines with the first of them; undefined where the text is refused. */
  private async compared(list: Machine[]): Promise<unknown> {
    const last = list.at(-1);
    const [first = "", ...more] = list.slice(0, -1).map(({ machine }) => machine);
    const texts = Object.fromEntries(list.slice(0, -1).map(({ machine, text }) => [machine, text]));
    const questions = [{ compare: { first, more, options: this.session.settings.compare } }];
    const isOpen = last?.machine === this.session.machine;
    const [answer] = await (isOpen || !last
      ? this.session.askAtRest(questions, texts)
      : this.session.askAbout(last.machine, last.text, questions, texts));
    return answer;
  }
}

type Machine = Column;

/** Name of the state of the text. */
const PRESENT = "The present state";

/** The names of machines: their own where these tell them apart, else those of their files or states. */
function nameless(list: Machine[], { machines }: Comparison): string[] {
  const titles = machines.map(({ machine }) => machine);
  return new Set(titles).size === list.length ? titles : list.map(({ name }) => name);
}

/** Whether a difference is known, as an answer: its words end at the first colon. */
function surely(sure: string): Answer {
  const [short, ...rest] = sure.split(/(?<=^\w+): /);
  const mark = sure.startsWith("Yes") ? "yes" : sure.startsWith("No:") ? "no" : "open";
  return { words: short ?? "", mark, why: rest.map(capital) };
}

/** Whether the differences to several machines are known. */
function together(rest: { name: string; sure: string }[]): Answer {
  const all = rest.map(({ sure }) => surely(sure));
  const [first] = all;
  if (first && new Set(rest.map(({ sure }) => sure)).size === 1) return first;
  const isSure = all.every(({ mark }) => mark === "yes");
  const why = rest.map(
    ({ name, sure }) => `${name}: ${sure.charAt(0).toLowerCase()}${sure.slice(1).replace(":", ",")}`,
  );
  return { words: isSure ? "Yes" : "Not of each", mark: isSure ? "yes" : "open", why: [why.join(" ")] };
}

/** The size of a difference to the first machine. */
function sizeOf({ verdicts }: Comparison, at: number, last: number): (Node | string)[] {
  const by = verdicts[at - 1]?.by;
  return by ? [figure(at === last ? "answer-by" : `answer-by-${at}`, by.um, "µm")] : ["Not judged"];
}

/** What a comparison says of one of its machines against the first, as the first three answers. */
function against(of: Comparison, at: number, first: string): Eight {
  const nothing = { words: "–" };
  if (at === 0) {
    const isBest = of.verdicts.every((_, i) => verdictOf(of, i + 1).which === "first");
    const words = isBest ? "The best of these" : "The others are compared with this one";
    return { better: { words, ...(isBest ? { mark: "yes" } : {}) }, by: nothing, sure: nothing };
  }
  const { which, by, sure } = verdictOf(of, at);
  const words = { better: "Better", first: "Worse", equal: "Equal", open: "Not told apart", none: "No verdict" }[which];
  const mark = which === "better" ? "yes" : which === "first" ? "no" : "open";
  return {
    better: { words, mark, why: [`Against ${first}, ${scopeOf(of.over)}.`] },
    by: { words: "", figure: by },
    sure: surely(sure),
  };
}

const capital = (words: string) => words.charAt(0).toUpperCase() + words.slice(1);

/** Index of the machine that the program finds most better than the first; the first where it finds none. */
function bestAmong(of: Comparison): number {
  const isBetter = of.verdicts.some(({ verdict }) => verdict === "better");
  return isBetter ? bestOf(of) : 0;
}

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
