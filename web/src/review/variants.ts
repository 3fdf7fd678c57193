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
import { figure, rounded } from "./number";
import type { NamedPart } from "./part";

/** Name of the text of A, in the folder of the machine so that what it names is found. */
const NAME = "variant-A.abbe.yaml";

const ROWS = [
  ["p95", "95 % of the poses"],
  ["max", "Largest deviation"],
  ["rms", "Root mean square"],
] as const;

export class Variants {
  private first: string | null = null;
  private readonly body = make("div", { "aria-live": "polite" });
  private readonly back = button("Back to A", () => this.restore(), { id: "back-to-a" });
  private readonly asking: Newest;

  constructor(
    parent: HTMLElement,
    private readonly session: Session,
    private readonly editor: Editor,
    /** The tool poses of the part, if one is named. */
    private readonly work: () => NamedPart | null,
    /** Hears of the text of A. */
    private readonly kept: (first: string) => void,
    private readonly tell: Tell,
    failed: (failure: unknown) => void,
  ) {
    this.asking = new Newest(failed, this.body);
    const keep = button("Keep as variant A", () => this.keep(), { class: "primary", id: "keep-a" });
    this.back.disabled = true;
    const words =
      "Keep the machine as variant A, go on editing, and compare on the same tool poses: " +
      "those of the part, else 1000 of the volume.";
    parent.append(make("p", { class: "words" }, words), make("p", {}, keep, " ", this.back), this.body);
  }

  show(state: State): void {
    this.body.classList.toggle("stale", !isSettled(state));
    if (this.first !== null && isSettled(state)) this.compare();
  }

  private keep(): void {
    this.first = this.editor.text;
    this.kept(this.first);
    this.back.disabled = false;
    this.compare();
  }

  private restore(): void {
    if (this.first === null) return;
    this.editor.change({ from: 0, to: this.editor.view.state.doc.length, insert: this.first });
  }

  private answer(of: Comparison, onPart: boolean): void {
    const { which, by, sure } = verdictOf(of);
    this.tell("better", make("strong", {}, which), onPart ? "" : " (on the volume: no part is named)");
    this.tell("by", ...by);
    this.tell("sure", sure);
  }

  private compare(): void {
    void this.asking.do(async () => {
      const name = this.session.beside(NAME);
      const work = this.work();
      const options = work?.asked ?? { poses: 1000 };
      const own = work?.isOwn ? { own_job: true } : {};
      const texts = { ...work?.more, [name]: this.first ?? "" };
      const [answer] = await this.session.ask([{ compare: { first: name, ...own, options } }], texts);
      const found = accepted<Comparison>(answer);
      if (answer === undefined) return;
      this.body.replaceChildren(...(found ? shown(found) : refused(answer as Refusal)));
      if (found) this.answer(found, work !== null);
      else for (const of of ["better", "by", "sure"] as const) this.tell(of);
    });
  }
}

function refused(answer: Refusal): HTMLElement[] {
  return answer.diagnostics.map(({ message }) => make("p", { class: "refused" }, message));
}

function shown(of: Comparison): HTMLElement[] {
  const [a, b] = of.machines;
  if (!a || !b) return [];
  const cells = ROWS.map(([at, words]) => [words, at, a.position_um[at], b.position_um[at]] as const);
  const rows = cells.map(([words, at, before, now]) =>
    row(
      words,
      figure(`a-${at}`, before, "µm"),
      figure(`b-${at}`, now, "µm"),
      figure(`b-a-${at}`, b.minus_first?.position_um[at] ?? now - before, "µm"),
    ),
  );
  const list = table(["Figure", "A", "now", "now − A"], rows);
  const csv = () =>
    download.csv("variants", [["figure", "A_um", "now_um"], ...cells.map(([words, , x, y]) => [words, x, y])]);
  const poses = `${of.poses} of ${of.asked} tool poses, which both reach.`;
  return [
    make("p", { id: "told-apart" }, make("strong", {}, judgement(of))),
    list,
    ...because(of),
    make("p", { class: "words" }, poses, " ", button("CSV", csv)),
  ];
}

/** The three answers of a comparison: which is better, by how much, and whether that is more than what is known of it. */
export interface Judgement {
  which: string;
  by: (Node | string)[];
  sure: string;
}

/** The interval of a difference, if one is known: of drawn machines, or else of values with a stated uncertainty. */
function interval(of: Comparison, by: JudgedDifference): [number, number] | null {
  if (typeof by.low === "number" && typeof by.high === "number") return [by.low, by.high];
  return by.drawn ? null : (of.machines[1]?.uncertainty?.minus_first.position_um.p95 ?? null);
}

/** What is judged, in words. */
const figureOf = ({ drawn, statistic }: JudgedDifference): string =>
  `in the ${statistic === "max" ? "largest deviation" : "95 % value"}${drawn ? " of 95 % of drawn machines" : ""}`;

export function verdictOf(of: Comparison): Judgement {
  const judged = of.verdicts[0];
  const { verdict, by } = judged ?? {};
  if (!verdict || !by)
    return { which: "No verdict", by: ["Not judged"], sure: `No: ${judged?.reason ?? "not known"}.` };
  if (verdict === "equal")
    return { which: "Equal", by: ["Nothing"], sure: by.drawn ? "Equal in every drawn machine." : "Equal." };
  const ends = interval(of, by);
  const band = ends && `${rounded(ends[0])} to ${rounded(ends[1])} µm`;
  const words = [figure("answer-by", by.um, "µm"), by.drawn ? " for 95 % of machines" : ` ${figureOf(by)}, now − A`];
  if (verdict === "not_told_apart")
    return { which: "Not told apart", by: words, sure: `No: ${band ?? "they are not told apart"}.` };
  const which = verdict === "better" ? "The present state" : "Variant A";
  if (band) return { which, by: words, sure: `Yes: ${band}.` };
  return { which, by: words, sure: by.drawn ? "Yes." : "Not known: the files state no uncertainty." };
}

/** Which is better, and whether that is more than what is known of the two. */
export function judgement(of: Comparison): string {
  const judged = of.verdicts[0];
  const { verdict, by } = judged ?? {};
  if (!verdict || !by) return `No verdict: ${judged?.reason ?? "not known"}.`;
  if (verdict === "equal") return by.drawn ? "Equal in every drawn machine." : "Equal.";
  const ends = interval(of, by);
  const band = ends ? ` (${rounded(ends[0])} to ${rounded(ends[1])} µm)` : "";
  const size = `${rounded(by.um)} µm${band} ${figureOf(by)}`;
  if (verdict === "not_told_apart") return `Not told apart: ${size}.`;
  const which = verdict === "better" ? "Better" : "Worse";
  if (band || by.drawn)
    return `${which} than A, more than ${by.drawn ? "the drawn machines differ" : "the uncertainty"}: ${size}.`;
  return `${which} than A: ${size}; the files state no uncertainty, so it is not known whether that is more than it.`;
}

/** The errors whose part changed most. */
function because(of: Comparison): HTMLElement[] {
  const changed = of.contributions
    .map(({ error, minus_first }) => ({ error, by: minus_first[1] ?? 0 }))
    .filter(({ by }) => Math.abs(by) > 5e-3)
    .sort((x, y) => Math.abs(y.by) - Math.abs(x.by))
    .slice(0, 4);
  if (!changed.length) return [];
  const list = changed.map(({ error, by }) =>
    make(
      "li",
      {},
      make("span", { "data-error": error, tabindex: "0", class: "error-name" }, error),
      ` ${by > 0 ? "+" : ""}${rounded(by)} µm`,
    ),
  );
  return [
    make("p", { class: "words" }, "Each error alone, where it changed most:"),
    make("ul", { class: "inline" }, ...list),
  ];
}
