/** Variants side by side: the text that was kept as A beside the present one, on the same tool poses. */

import type { Editor } from "../editor/editor";
import { Newest } from "../evaluator/newest";
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
    this.asking = new Newest(failed);
    const keep = button("Keep as variant A", () => this.keep(), { class: "primary", id: "keep-a" });
    this.back.disabled = true;
    const words =
      "Keep the machine as variant A, go on editing, and compare on the same tool poses: " +
      "those of the part, else 1000 of the volume.";
    parent.append(make("p", { class: "words" }, words), make("p", {}, keep, " ", this.back), this.body);
  }

  show(state: State): void {
    this.body.classList.toggle("stale", state.stale);
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

/** What drawn machines say, where the errors of a machine are only bounded. */
function drawnOf({ machines, budgets }: Comparison) {
  if (!machines.some(({ from }) => from === "bounds")) return undefined;
  return budgets?.versus_first_p95_um.find(({ verdict }) => verdict !== "first");
}

/** The three answers of a comparison: which is better, by how much, and whether that is more than what is known of it. */
export interface Judgement {
  which: string;
  by: (Node | string)[];
  sure: string;
}

export function verdictOf(of: Comparison): Judgement {
  const drawn = drawnOf(of);
  if (drawn) {
    const { value, low, high } = drawn.minus_first;
    const band = low === null || high === null ? "" : ` (${rounded(low)} to ${rounded(high)})`;
    const by = [figure("answer-by", value, "µm"), `${band} in the 95 % value of drawn machines`];
    if (drawn.verdict === "equal") return { which: "Equal", by: ["Nothing"], sure: "Equal in every drawn machine." };
    if (drawn.verdict === "not_told_apart")
      return { which: "Not told apart", by, sure: "No: they are not told apart." };
    if (drawn.withheld) return { which: "No verdict", by, sure: `No: ${drawn.withheld.reason}.` };
    const which = drawn.verdict === "better" ? "The present state" : "Variant A";
    return { which, by, sure: "Yes: more than the drawn machines differ." };
  }
  const [, b] = of.machines;
  const by = b?.minus_first?.position_um.p95;
  if (by === undefined) return { which: "Not comparable", by: ["Of only one nothing is measured"], sure: "–" };
  if (by === 0) return { which: "Equal", by: ["Nothing"], sure: "Equal." };
  const words = [figure("answer-by", by, "µm"), " in the 95 % value, now − A"];
  const which = by < 0 ? "The present state" : "Variant A";
  if (!b?.uncertainty) return { which, by: words, sure: "Not known: the files state no uncertainty." };
  const [low, high] = b.uncertainty.minus_first.position_um.p95;
  const band = `${rounded(low)} to ${rounded(high)} µm`;
  return { which, by: words, sure: b.uncertainty.told_apart ? `Yes: ${band}.` : `No: ${band}.` };
}

/** Which is better, and whether that is more than what is known of the two. */
export function judgement(of: Comparison): string {
  const [, b] = of.machines;
  const drawn = drawnOf(of);
  if (drawn) {
    const { value, low, high } = drawn.minus_first;
    const band = low === null || high === null ? "" : ` (${rounded(low)} to ${rounded(high)})`;
    const by = `${rounded(value)} µm${band} in the 95 % value of drawn machines`;
    if (drawn.verdict === "equal") return "Equal in every drawn machine.";
    if (drawn.verdict === "not_told_apart") return `Not told apart: ${by}.`;
    if (drawn.withheld) return `No verdict: ${drawn.withheld.reason}; as bounded ${by}.`;
    return `${drawn.verdict === "better" ? "Better" : "Worse"} than A, more than the drawn machines differ: ${by}.`;
  }
  const by = b?.minus_first?.position_um.p95;
  if (by === undefined) return "Of only one of the two nothing is measured: they cannot be compared.";
  if (by === 0) return "Equal.";
  const which = `${by < 0 ? "Better" : "Worse"} than A by ${rounded(Math.abs(by))} µm in the 95 % value`;
  if (!b?.uncertainty)
    return `${which}; the files state no uncertainty, so it is not known whether that is more than it.`;
  const [low, high] = b.uncertainty.minus_first.position_um.p95;
  const band = `${rounded(low)} to ${rounded(high)} µm`;
  return b.uncertainty.told_apart
    ? `${which}, more than the uncertainty (${band}).`
    : `${which}, within the uncertainty (${band}).`;
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
