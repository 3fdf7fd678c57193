/** What a control can repair: the machine with the files that `compile` would write for it, and without. */

import { Newest } from "../evaluator/newest";
import { accepted, type Refusal, type Summary, type Target } from "../evaluator/types";
import { FULL, isSettled, type Session, type State } from "../session";
import type { Tell } from "./answers";
import { move, place } from "../ui/address";
import { make } from "../ui/dom";
import { row, table, tableFiles } from "../ui/table";
import { figure } from "./number";

interface Compensated {
  position_um: Summary;
  rotation_urad: Summary;
  uncompensated: { position_um: Summary; rotation_urad: Summary };
}

export class Control {
  private readonly select = make("select", { id: "target" }, make("option", { value: "" }, "choose one"));
  private readonly body = make("div", { "aria-live": "polite" });
  private readonly asking: Newest;
  private targets: Target[] = [];

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
    if (state.now.map?.from === "bounds" || !state.now.sources?.errors.length) {
      this.select.disabled = true;
      this.tell("repair", "Nothing of this machine is measured.");
      this.body.replaceChildren(
        make("p", { class: "words" }, "Nothing of this machine is measured: there is nothing to correct yet."),
      );
      return;
    }
    this.select.disabled = false;
    this.update();
  }

  private update(): void {
    void this.asking.do(async () => {
      await this.list();
      const name = this.select.value;
      const target = this.targets.find((of) => of.target === name);
      if (!target) return this.nothing();
      const question = { map: { poses: { random: FULL.poses }, target: name } };
      const [answer] = await this.session.ask([question]);
      if (answer === undefined) return;
      const found = accepted<Compensated>(answer);
      this.body.replaceChildren(...(found ? shown(found, target) : refused(answer as Refusal)));
      this.tell("repair", ...(found ? repaired(found, target) : refused(answer as Refusal)));
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

function repaired({ position_um, uncompensated }: Compensated, target: Target): (Node | string)[] {
  const [before, after] = [uncompensated.position_um.p95, position_um.p95];
  return [figure("answer-before", before, "µm"), " → ", figure("answer-after", after, "µm"), ` with ${target.title}`];
}

function shown({ position_um, rotation_urad, uncompensated }: Compensated, target: Target): HTMLElement[] {
  const both = (words: string, at: string, unit: string, before: number, after: number) =>
    row(words, figure(`without-${at}`, before, unit), figure(`with-${at}`, after, unit));
  const rows = [
    both("95 % of the poses", "p95", "µm", uncompensated.position_um.p95, position_um.p95),
    both("Largest deviation", "max", "µm", uncompensated.position_um.max, position_um.max),
    both("Rotation of the tool, 95 %", "rotation-left", "µrad", uncompensated.rotation_urad.p95, rotation_urad.p95),
  ];
  const list = table(["Figure", "as it is", "corrected"], rows);
  const cannot = make("ul", { class: "words" }, ...target.cannot.map((line) => make("li", {}, line)));
  const corrects = make("p", { class: "words" }, `Corrects ${target.expresses}. It cannot correct:`);
  return [
    list,
    make("p", { class: "files" }, ...tableFiles(`control-${target.target}`, target.title, list)),
    corrects,
    cannot,
  ];
}

function refused(answer: Refusal): HTMLElement[] {
  return answer.diagnostics.map(({ message }) => make("p", { class: "refused" }, message));
}
