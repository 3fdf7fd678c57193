/** The inverse budget: the cheapest tolerances for a goal, and their way into the file. */

import type { Editor } from "../editor/editor";
import { toleranceEdits } from "../editor/tolerances";
import { Newest } from "../evaluator/newest";
import { accepted, type Refusal, type ToleranceGoal } from "../evaluator/types";
import { type Budget, type Findings, isSettled, type Session, type State } from "../session";
import type { Answer, Tell } from "./answers";
import { move, place } from "../ui/address";
import { button, make } from "../ui/dom";
import { download } from "../ui/download";
import { row, table } from "../ui/table";
import { figure } from "./number";
import { deciding, scopeOf, verdict } from "./verdict";
import { bare, both, bound, fromField, inReaders, named, quantity, rounded, toField } from "../units";

export class Tighten {
  private readonly input = make("input", {
    type: "number",
    min: "0",
    step: "any",
    id: "goal",
    value: toField(place().goal),
  });
  private readonly find = button("Find tolerances", () => this.ask(), { class: "primary", id: "find-tolerances" });
  private readonly answer = make("div", { "aria-live": "polite" });
  private readonly problem = make("p", { class: "words" });
  private readonly asking: Newest;
  private readonly scope = make("span", {}, "over the volume");
  private readonly unit = make("span", {});
  private bounded = false;
  /** The limit, um, and whether it is held. */
  private limit = 0;
  private isHeld = false;
  private first: Budget["tighten"][number] | undefined;
  /** The budget of which the answer is. */
  private last = "";

  constructor(
    parent: HTMLElement,
    private readonly session: Session,
    private readonly editor: Editor,
    private readonly tell: Tell,
    failed: (failure: unknown) => void,
  ) {
    this.asking = new Newest(failed);
    this.input.addEventListener("input", () => {
      move({ goal: fromField(this.input.value) });
      this.offer();
    });
    this.input.addEventListener("keydown", ({ key }) => key === "Enter" && this.ask());
    const label = make("label", { for: "goal" }, "Goal for 95 % of machines, ", this.scope, " ");
    const row = make("p", {}, label, this.input, this.unit, this.find);
    const words = "The cheapest tolerances for a goal: halving one costs 1, and none becomes coarser (budget --goal).";
    parent.append(make("p", { class: "words" }, words), row, this.problem, this.answer);
  }

  /** The bounds are others: an answer of those before would mislead. */
  show(state: State): void {
    this.bounded = state.now?.budget !== null && state.now !== null;
    const { bounded } = this;
    if (state.now?.map) this.scope.textContent = scopeOf(state.now.map.over);
    const now = state.now && deciding(state.now);
    this.limit = Number(place().limit) || (now?.limit?.um ?? 0);
    this.isHeld = now !== null && verdict(now, place().limit).startsWith("Passes");
    this.first = state.now?.budget?.tighten[0];
    this.input.placeholder = this.limit ? toField(String(this.limit)) : "";
    this.input.value = document.activeElement === this.input ? this.input.value : toField(place().goal);
    this.unit.textContent = ` ${named("um")} `;
    this.find.disabled = !bounded;
    this.problem.textContent = bounded
      ? ""
      : "No error of this machine is bounded. Write bounds under tolerances, or take a class, as class: production.";
    if (!isSettled(state)) return;
    const budget = JSON.stringify([state.now.budget, this.limit, both()]);
    if (budget === this.last) return;
    this.last = budget;
    this.answer.replaceChildren();
    this.offer();
  }

  /** The goal that is typed, or else the limit, um. */
  private get goal(): number {
    return Number(fromField(this.input.value)) || this.limit;
  }

  /** In the review: the search takes seconds, and waits for a hand. */
  private offer(): void {
    const { goal, first } = this;
    if (!this.bounded) return this.tell("tighten", UNBOUNDED);
    if (this.isHeld && !Number(this.input.value))
      return this.tell("tighten", { words: "Nothing", mark: "yes", why: ["The limit is held."] });
    if (goal > 0)
      return this.tell("tighten", {
        words: button(`Find tolerances for ${quantity(goal)}`, () => this.ask(), { class: "link" }),
      });
    this.tell("tighten", first && { ...firstOf(first), why: ["First; a limit or a goal gives the cost."] });
  }

  private ask(): void {
    if (this.bounded && this.goal > 0) void this.asking.do(() => this.found());
  }

  private async found(): Promise<void> {
    const goal_mm = this.goal * 1e-3;
    this.find.disabled = true;
    this.answer.textContent = "Machines are drawn …";
    const [answer] = await this.session.ask([{ budget: { goal_mm } }]).catch(() => [null]);
    this.find.disabled = !this.bounded;
    const goal = accepted<{ goal: ToleranceGoal }>(answer)?.goal;
    this.answer.replaceChildren(...(goal ? this.shown(goal) : refusal(answer as Refusal | null)));
    this.tell("tighten", goal ? tightened(goal) : { words: "Out of reach", mark: "no", why: ["See Tighten."] });
  }

  private shown(goal: ToleranceGoal): HTMLElement[] {
    const { cost, proof_um: proof, tolerances } = goal;
    const { low, high } = proof;
    const interval = low === null || high === null ? "" : ` (${bare(low)} to ${bare(high)})`;
    const price =
      cost.per_um === null ? "" : ` (${rounded(cost.per_um / inReaders(1, "um"))} for a further ${named("um")})`;
    const facts = make(
      "p",
      {},
      figure("goal-proof", proof.value, "µm"),
      `${interval} by ${goal.proof_samples} other machines, `,
      `before ${quantity(goal.before_um.value)}; `,
      `cost ${priceOf(goal)}${price}.`,
    );
    const changed = tolerances.filter(changes);
    const rows = changed.map((of) => {
      return row(
        make("th", { scope: "row", "data-error": of.error, tabindex: "0" }, of.error),
        bound(of.old, of.unit),
        figure(`goal-${of.error}`, of.new, of.unit),
        quantity(of.um_of_p95),
      );
    });
    const list = table(["Error", "is", "new", "part of the figure"], rows);
    const csv = () => download.csv("tolerances", [["error", "unit", "old", "new", "um_of_p95"], ...listed(goal)]);
    const write = button("Write into the file", () => this.write(goal), { class: "primary", id: "write-tolerances" });
    const kept = make("p", { class: "words" }, `${tolerances.length - changed.length} tolerances stay as they are.`);
    return [
      facts,
      make("div", { class: "scroll", tabindex: "0" }, list),
      kept,
      make("p", {}, write, " ", button("CSV", csv)),
    ];
  }

  private write(goal: ToleranceGoal): void {
    this.editor.change(toleranceEdits(this.editor.view.state, goal.tolerances.filter(changes)));
  }
}

const UNBOUNDED: Answer = {
  words: "No bound",
  mark: "open",
  why: ["No error of this machine is bounded: values are corrected, not tightened."],
};

/** The bound that makes most of the figure. */
function firstOf({ error, um_of_p95 }: Budget["tighten"][number]): Answer {
  const name = make("span", { "data-error": error, tabindex: "0" }, error);
  return { words: name, figure: [figure("answer-tighten-first", um_of_p95, "µm"), " of the figure"] };
}

/** What to tighten first on a machine. */
export function toTighten({ budget }: Findings): Answer {
  const [first] = budget?.tighten ?? [];
  return first ? firstOf(first) : UNBOUNDED;
}

/** The errors whose bounds become finer, those that change most first, and the cost. */
function tightened(goal: ToleranceGoal): Answer {
  const finer = goal.tolerances.filter((of) => of.new < of.old).sort((a, b) => a.new / a.old - b.new / b.old);
  const cost = `cost ${priceOf(goal)}`;
  if (!finer.length) return { words: "Nothing", mark: "yes", why: [`The goal is met; ${cost}.`] };
  const [first, ...others] = finer.map((of) => `${of.error} to ${quantity(of.new, of.unit)}`);
  const more = others.length > 2 ? ` and ${others.length - 2} more` : "";
  const also = others.length ? `Also ${others.slice(0, 2).join(", ")}${more}. ` : "";
  return { words: first ?? "", mark: "no", figure: [cost], why: [`${also}Then ${quantity(goal.proof_um.value)}.`] };
}

const changes = (of: ToleranceGoal["tolerances"][number]) => of.new !== of.old;

const priceOf = ({ cost }: ToleranceGoal) => `${rounded(cost.after - cost.before)} ${cost.unit}`;

const listed = (goal: ToleranceGoal) => goal.tolerances.map((of) => [of.error, of.unit, of.old, of.new, of.um_of_p95]);

function refusal(answer: Refusal | null): HTMLElement[] {
  const list = answer?.diagnostics ?? [];
  const words = list.flatMap(({ message, help }) => [message, ...(help ? [help] : [])]);
  return (words.length ? words : ["The program did not answer."]).map((text) => make("p", { class: "refused" }, text));
}
