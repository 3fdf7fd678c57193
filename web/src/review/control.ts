/** What a control can repair: the machine with the files that `compile` would write for it, and without. */

import { Newest } from "../evaluator/newest";
import { accepted, type Over, type Refusal, type Summary, type Target, refusals } from "../evaluator/types";
import { FULL, isSettled, type Session, type State } from "../session";
import type { Answer, Tell } from "./answers";
import { move, place } from "../ui/address";
import { make } from "../ui/dom";
import { row, table, tableFiles } from "../ui/table";
import { figure } from "./number";
import { scopeOf } from "./verdict";

interface Compensated {
  over: Over;
  position_um: Summary;
  rotation_urad: Summary;
  uncompensated: { position_um: Summary; rotation_urad: Summary };
}

export class Control {
  private readonly select = make("select", { id: "target" }, make("option", { value: "" }, "choose one"));
  private readonly body = make("div", { "aria-live": "polite" });
  private readonly asking: Newest;
  private targets: Target[] = [];
  private isBounded = false;

  constructor(
    parent: HTMLElement,
    private readonly session: Session,
    /** Hears that another control is chosen. */
    private readonly chosen: () => void,
    private readonly tell: Tell,
    failed: (failure: unknown) => void,
  ) {
    this.asking = new Newest(failed, this.body);
    this.select.addEventListener("change", () => {
      move({ target: this.select.value });
      this.chosen();
      this.update();
    });
    parent.append(make("p", {}, make("label", { for: "target" }, "Control "), this.select), this.body);
  }

  show(state: State): void {
    this.body.classList.toggle("stale", !isSettled(state));
    if (!isSettled(state)) return;
    this.isBounded = state.now.map?.from === "bounds" || !state.now.sources?.errors.length;
    this.update();
  }

  private update(): void {
    void this.asking.do(async () => {
      await this.list();
      const name = this.select.value;
      const target = this.targets.find((of) => of.target === name);
      if (!target) return this.nothing();
      if (this.isBounded) return this.inKind(target);
      const question = { map: { poses: { random: FULL.poses }, target: name } };
      const [answer] = await this.session.ask([question]);
      if (answer === undefined) return;
      const found = accepted<Compensated>(answer);
      this.body.replaceChildren(...(found ? shown(found, target) : refused(answer as Refusal)));
      const reasons = refusals(answer);
      this.tell("repair", found ? repaired(found, target) : { words: "Refused", mark: "open", why: reasons });
    });
  }

  /** Nothing is measured: a control corrects errors of its kind once they are. */
  private inKind(target: Target): void {
    const words =
      "Nothing of this machine is measured: what it corrects are values of these kinds, once they are known.";
    this.body.replaceChildren(make("p", { class: "words" }, words), ...limits(target));
    this.tell("repair", {
      words: "Once measured",
      mark: "open",
      why: [`${target.title} corrects ${target.expresses}.`],
    });
  }

  private nothing(): void {
    this.body.replaceChildren();
    this.tell("repair");
  }

  private async list(): Promise<void> {
    if (this.targets.length) return;
    const [answer] = await this.session.ask(["targets"]);
    this.targets = accepted<Target[]>(answer) ?? [];
    this.select.append(...this.targets.map(({ target, title }) => make("option", { value: target }, title)));
    this.select.value = place().target;
  }
}

/** By the figure of the headline. */
function repaired({ over, position_um, uncompensated }: Compensated, target: Target): Answer {
  const by = over.kind === "job" ? "max" : "p95";
  const [before, after] = [uncompensated.position_um[by], position_um[by]];
  const both = [figure("answer-before", before, "µm"), " → ", figure("answer-after", after, "µm")];
  const share = before > 0 ? `${Math.max(0, Math.round(100 * (1 - after / before)))} %` : "Nothing";
  return { words: `${share}:`, mark: after < before ? "yes" : "no", figure: both, why: [`With ${target.title}.`] };
}

function shown({ over, position_um, rotation_urad, uncompensated }: Compensated, target: Target): HTMLElement[] {
  const both = (words: string, at: string, unit: string, before: number, after: number) =>
    row(words, figure(`without-${at}`, before, unit), figure(`with-${at}`, after, unit));
  const rows = [
    both("95 % of the poses", "p95", "µm", uncompensated.position_um.p95, position_um.p95),
    both("Largest deviation", "max", "µm", uncompensated.position_um.max, position_um.max),
    both(
      "Rotation of the tool, 95 % of the poses",
      "rotation-left",
      "µrad",
      uncompensated.rotation_urad.p95,
      rotation_urad.p95,
    ),
  ];
  const list = table(["Figure", "as it is", "corrected"], rows);
  list.prepend(make("caption", { class: "words" }, `Deviation ${scopeOf(over)}`));
  return [
    list,
    make("p", { class: "files" }, ...tableFiles(`control-${target.target}`, target.title, list)),
    ...limits(target),
  ];
}

/** What a control corrects, and what not. */
function limits(target: Target): HTMLElement[] {
  const cannot = make("ul", { class: "words" }, ...target.cannot.map((line) => make("li", {}, line)));
  return [make("p", { class: "words" }, `Corrects ${target.expresses}. It cannot correct:`), cannot];
}

function refused(answer: Refusal): HTMLElement[] {
  return answer.diagnostics.map(({ message }) => make("p", { class: "refused" }, message));
}
