/** Machines side by side: the headline and the eight answers of each as a column. */

import { Newest } from "../evaluator/newest";
import { accepted, type Question, refusals, type Target, type Work } from "../evaluator/types";
import { type Findings, findingsOf, type Session } from "../session";
import { place } from "../ui/address";
import { make } from "../ui/dom";
import { INSTRUMENTS, tested } from "./acceptance";
import { type Answer, ASKED, type Asked, said } from "./answers";
import { corrected, leaves, takenOff, takesOff } from "./control";
import { figure } from "./number";
import { dominates } from "./pareto";
import { fits } from "./part";
import { toTighten } from "./tighten";
import { deciding, scopeOf, verdict } from "./verdict";
import { between } from "../units";

/** A machine with its file as it is to be read. */
export interface Column {
  name: string;
  machine: string;
  text: string;
}

export type Eight = { [of in Asked]?: Answer | undefined };

/** The question about the part, with the texts that it needs. */
export type AskedPart = () => { question: Question; more: Record<string, string> };

export class Columns {
  private readonly asking: Newest;
  private wanted: [Column[], Eight[]] | null = null;

  constructor(
    private readonly parent: HTMLElement,
    private readonly session: Session,
    private readonly part: AskedPart,
    failed: (failure: unknown) => void,
  ) {
    this.asking = new Newest(failed, parent);
  }

  /** Shows machines, with what a comparison says of each; `isOpen` if anybody looks. */
  show(columns: Column[], compared: Eight[], isOpen: boolean): void {
    this.wanted = [columns, compared];
    this.parent.replaceChildren();
    if (isOpen) this.opened();
  }

  /** What takes seconds is asked when somebody looks. */
  opened(): void {
    const { wanted } = this;
    if (!wanted) return;
    this.wanted = null;
    const [columns, compared] = wanted;
    void this.asking.do(async () => {
      const found: Found[] = [];
      for (const of of columns) found.push(await this.ask(of));
      this.parent.replaceChildren(drawn(columns, found, compared));
    });
  }

  private async ask({ machine, text }: Column): Promise<Found> {
    const { question, more } = this.part();
    const control = place().target;
    const own = this.session.questions();
    const questions: Question[] = [...own, question, ...INSTRUMENTS, "targets"];
    const answers = await this.session.askAbout(machine, text, questions, more);
    const now = findingsOf(answers);
    if (!now) return { refused: refusals(answers[0]), eight: {} };
    const [work, bar, turn, lines, targets] = answers.slice(own.length);
    const title = accepted<Target[]>(targets)?.find((of) => of.target === control)?.title ?? "";
    const isBounded = now.map?.from === "bounds" || !now.sources?.errors.length;
    const left =
      title && (await this.repaired(machine, text, isBounded ? takenOff(control) : corrected(control), more));
    const rows = accepted<Work>(work)?.rows.poses;
    const unread = refusals(work);
    const eight: Eight = {
      dominates: dominates(now),
      fits: rows ? fits(rows) : unread.length ? { words: "Not readable", mark: "open", why: unread } : undefined,
      tighten: toTighten(now),
      repair: title ? (isBounded ? takesOff(left, title) : leaves(left, title)) : undefined,
      test: tested([bar, turn, lines], now),
    };
    return { now, refused: [], eight };
  }

  private async repaired(machine: string, text: string, question: Question, more: Record<string, string>) {
    const [answer] = await this.session.askAbout(machine, text, [question], more);
    return answer;
  }
}

/** What is known of a machine. */
interface Found {
  now?: Findings;
  /** Why it is refused. */
  refused: string[];
  eight: Eight;
}

/** What stands for an answer that nothing was asked for. */
const NONE: { [of in Asked]?: string } = { fits: "No part", repair: "No control is chosen", dominates: "None" };

function drawn(columns: Column[], found: Found[], compared: Eight[]): HTMLElement {
  const cell = (content: (Node | string)[], i: number) => {
    const made = make("td", {}, ...content);
    // The same figures stand in the review: each has its own name.
    for (const of of made.querySelectorAll<HTMLElement>("[data-at]"))
      of.dataset["at"] = `column-${i}-${of.dataset["at"] ?? ""}`;
    return made;
  };
  const line = (words: string, of: (i: number) => (Node | string)[]) =>
    make("tr", {}, make("th", { scope: "row" }, words), ...columns.map((_, i) => cell(of(i), i)));
  const answer = (of: Asked, i: number) => compared[i]?.[of] ?? found[i]?.eight[of];
  const rows = [
    line("How large is the error?", (i) => said(headline(found[i]))),
    ...ASKED.map(({ of, words }) => line(words, (i) => said(answer(of, i) ?? { words: NONE[of] ?? "–" }))),
  ];
  const head = columns.map(({ name }) => make("th", { scope: "col" }, name));
  const table = make("table", { class: "answers columns", id: "columns" });
  table.append(make("thead", {}, make("tr", {}, make("td"), ...head)), make("tbody", {}, ...rows));
  return make("div", { class: "scroll", tabindex: "0" }, table);
}

/** The figure that decides, with its interval, its scope and the verdict on the limit. */
function headline(of: Found | undefined): Answer {
  const found = of?.now && deciding(of.now);
  if (!of?.now || !found) return { words: "Not known", mark: "open", why: of?.refused.map((why) => `${why}.`) ?? [] };
  const judged = verdict(found, place().limit);
  const mark = judged.startsWith("Passes") ? "yes" : judged.startsWith("Fails") ? "no" : "open";
  const scope = scopeOf(of.now.map?.over);
  const band = found.band ? `${between(found.band)}. ` : "";
  return {
    words: judged.split(/[ :,]/)[0] ?? "",
    ...(judged ? { mark } : {}),
    figure: [figure("decides", found.value, "µm")],
    why: [`${band}${found.words} ${scope.charAt(0).toUpperCase()}${scope.slice(1)}.`],
  };
}
