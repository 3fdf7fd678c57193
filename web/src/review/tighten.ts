/** The inverse budget: the cheapest tolerances for a goal, and their way into the file. */

import type { Editor } from "../editor/editor";
import { toleranceEdits } from "../editor/tolerances";
import { Newest } from "../evaluator/newest";
import { accepted, type Refusal, type ToleranceGoal } from "../evaluator/types";
import { isSettled, type Session, type State } from "../session";
import type { Tell } from "./answers";
import { move, place } from "../ui/address";
import { button, make } from "../ui/dom";
import { download } from "../ui/download";
import { row, table } from "../ui/table";
import { figure, rounded } from "./number";

export class Tighten {
  private readonly input = make("input", { type: "number", min: "0", step: "any", id: "goal", value: place().goal });
  private readonly find = button("Find tolerances", () => this.ask(), { class: "primary", id: "find-tolerances" });
  private readonly answer = make("div", { "aria-live": "polite" });
  private readonly problem = make("p", { class: "words" });
  private readonly asking: Newest;
  private bounded = false;
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
      move({ goal: this.input.value });
      this.offer();
    });
    this.input.addEventListener("keydown", ({ key }) => key === "Enter" && this.ask());
    const label = make("label", { for: "goal" }, "Goal of the 95 % value over the volume ");
    const row = make("p", {}, label, this.input, " µm ", this.find);
    const words = "The cheapest tolerances for a goal: halving one costs 1, and none becomes coarser (budget --goal).";
    parent.append(make("p", { class: "words" }, words), row, this.problem, this.answer);
  }

  /** The bounds are others: an answer of those before would mislead. */
  show(state: State): void {
    this.bounded = state.now?.budget !== null && state.now !== null;
    const { bounded } = this;
    this.find.disabled = !bounded;
    this.problem.textContent = bounded
      ? ""
      : "No error of this machine is bounded. Write bounds under tolerances, or take a class, as class: production.";
    if (!isSettled(state)) return;
    const budget = JSON.stringify(state.now.budget);
    if (budget === this.last) return;
    this.last = budget;
    this.answer.replaceChildren();
    this.offer();
  }

  /** In the review: the search takes seconds, and waits for a hand. */
  private offer(): void {
    const goal = Number(this.input.value);
    if (!this.bounded) this.tell("tighten", "No error of this machine is bounded.");
    else if (!(goal > 0)) this.tell("tighten");
    else
      this.tell(
        "tighten",
        button(`Find tolerances for ${rounded(goal)} µm`, () => this.ask(), { class: "link" }),
      );
  }

  private ask(): void {
    if (this.bounded && Number(this.input.value) > 0) void this.asking.do(() => this.found());
  }

  private async found(): Promise<void> {
    const goal_mm = Number(this.input.value) * 1e-3;
    this.find.disabled = true;
    this.answer.textContent = "Machines are drawn …";
    const [answer] = await this.session.ask([{ budget: { goal_mm } }]).catch(() => [null]);
    this.find.disabled = !this.bounded;
    const goal = accepted<{ goal: ToleranceGoal }>(answer)?.goal;
    this.answer.replaceChildren(...(goal ? this.shown(goal) : refusal(answer as Refusal | null)));
    this.tell("tighten", ...(goal ? tightened(goal) : ["The goal is not reached: see Tighten."]));
  }

  private shown(goal: ToleranceGoal): HTMLElement[] {
    const { cost, proof_um: proof, tolerances } = goal;
    const { low, high } = proof;
    const interval = low === null || high === null ? "" : ` (${rounded(low)} to ${rounded(high)})`;
    const price = cost.per_um === null ? "" : ` (${rounded(cost.per_um)} for a further µm)`;
    const facts = make(
      "p",
      {},
      figure("goal-proof", proof.value, "µm"),
      `${interval} by ${goal.proof_samples} other machines, `,
      `before ${rounded(goal.before_um.value)} µm; `,
      `cost ${priceOf(goal)}${price}.`,
    );
    const changed = tolerances.filter(changes);
    const rows = changed.map((of) => {
      const unit = of.unit.replace("u", "µ");
      return row(
        make("th", { scope: "row", "data-error": of.error, tabindex: "0" }, of.error),
        `${Number(of.old.toPrecision(4))} ${unit}`,
        figure(`goal-${of.error}`, of.new, unit),
        `${rounded(of.um_of_p95)} µm`,
      );
    });
    const list = table(["Error", "is", "new", "in the 95 %"], rows);
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

/** The errors whose bounds become finer, those that change most first, and the cost. */
function tightened(goal: ToleranceGoal): (Node | string)[] {
  const finer = goal.tolerances.filter((of) => of.new < of.old).sort((a, b) => a.new / a.old - b.new / b.old);
  const names = finer.slice(0, 3).map((of) => `${of.error} to ${rounded(of.new)} ${of.unit.replace("u", "µ")}`);
  const more = finer.length > 3 ? ` and ${finer.length - 3} more` : "";
  const cost = `cost ${priceOf(goal)}`;
  return finer.length ? [`${names.join(", ")}${more}; ${cost}.`] : [`Nothing: the goal is met; ${cost}.`];
}

const changes = (of: ToleranceGoal["tolerances"][number]) => of.new !== of.old;

const priceOf = ({ cost }: ToleranceGoal) => `${rounded(cost.after - cost.before)} ${cost.unit}`;

const listed = (goal: ToleranceGoal) => goal.tolerances.map((of) => [of.error, of.unit, of.old, of.new, of.um_of_p95]);

function refusal(answer: Refusal | null): HTMLElement[] {
  const list = answer?.diagnostics ?? [];
  const words = list.flatMap(({ message, help }) => [message, ...(help ? [help] : [])]);
  return (words.length ? words : ["The program did not answer."]).map((text) => make("p", { class: "refused" }, text));
}
