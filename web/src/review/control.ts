/** What a control can repair: the machine with the files that `compile` would write for it, and without. */

import { Abandoned, Newest } from "../evaluator/newest";
import {
  accepted,
  type Over,
  type Question,
  type Refusal,
  type Repair,
  type Summary,
  type Target,
  refusals,
} from "../evaluator/types";
import { FULL, isSettled, type Session, type State } from "../session";
import type { Answer, Tell } from "./answers";
import { move, place } from "../ui/address";
import { make } from "../ui/dom";
import { row, table, tableFiles } from "../ui/table";
import { figure } from "./number";
import { scopeOf } from "./verdict";
import { said } from "../units";

interface Compensated {
  over: Over;
  position_um: Summary;
  rotation_urad: Summary;
  uncompensated: { position_um: Summary; rotation_urad: Summary };
}

/** Rest before all controls are asked, one after the other, ms: an edit or a choice comes first. */
const REST = 4000;

/** Number of machines drawn between bounds that a control corrects: files are made for each. */
const MACHINES = 11;

const percent = (share: number) => `${Math.round(100 * share)} %`;

/** What a control leaves. */
interface Left {
  target: Target;
  found: Compensated;
}

export class Control {
  private readonly select = make("select", { id: "target" }, make("option", { value: "" }, "choose one"));
  private readonly body = make("div", { "aria-live": "polite" });
  private readonly asking: Newest;
  private targets: Target[] = [];
  private isBounded = false;
  /** Number of the last update: what is asked for an earlier one stops. */
  private turn = 0;

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
    this.turn += 1;
    if (!isSettled(state)) return;
    this.isBounded = state.now.map?.from === "bounds" || !state.now.sources?.errors.length;
    this.update();
  }

  private update(): void {
    const turn = (this.turn += 1);
    void this.asking.do(async () => {
      await this.list();
      const name = this.select.value;
      const target = this.targets.find((of) => of.target === name);
      if (!target) return this.nothing(turn);
      if (this.isBounded) return await this.inKind(target);
      const [answer] = await this.session.askAtRest([corrected(name)]);
      if (answer === undefined) return;
      const found = accepted<Compensated>(answer);
      this.body.replaceChildren(...(found ? shown(found, target) : refused(answer as Refusal)));
      this.tell("repair", leaves(answer, target.title));
    });
  }

  /** Nothing is measured: machines are drawn between the bounds, and the control corrects each. */
  private async inKind(target: Target): Promise<void> {
    const [answer] = await this.session.askAtRest([takenOff(target.target)]);
    if (answer === undefined) return;
    const found = accepted<Repair>(answer);
    const of = found?.targets[0];
    const refusal = found?.refused.map(({ why }) => why) ?? refusals(answer);
    if (!of?.drawn) {
      const why = of ? [`${target.title} corrects ${target.expresses}; no error is bounded.`] : refusal;
      this.body.replaceChildren(...why.map((line) => make("p", { class: "refused" }, line)), ...limits(target));
      return this.tell("repair", { words: of ? "Not known" : "Refused", mark: "open", why });
    }
    const { median } = of.drawn;
    const by = judged(of.over);
    const [before, after] = [of.uncompensated.position_um[by], of.compensated.position_um[by]];
    const spread = spreadOf(of.drawn);
    const list = table(
      ["Figure", "as it is", "corrected"],
      [
        row(
          by === "max" ? "Largest deviation" : "95 % of the poses",
          figure("without", before, "µm"),
          figure("with", after, "µm"),
        ),
      ],
    );
    list.prepend(make("caption", { class: "words" }, `Deviation ${scopeOf(of.over)}, of the machine with the median`));
    const words = `The files of this control take off ${percent(median)}; ${spread}. Measured, it would be known.`;
    this.body.replaceChildren(make("p", { class: "words" }, words), list, ...limits(target));
    this.tell("repair", takesOff(answer, target.title));
  }

  /** No control is chosen: all are tried, or of a machine of which nothing is measured named with what they correct. */
  private nothing(turn: number): void {
    this.body.replaceChildren();
    this.tell("repair");
    if (!this.targets.length) return;
    if (!this.isBounded) return void this.all(turn);
    const rows = this.targets.map((of) => row(of.title, of.expresses));
    this.body.replaceChildren(scrolling(table(["Control", "corrects, once measured"], rows)));
    const why = [`Each of ${rows.length} controls corrects its kinds of errors: see Control.`];
    this.tell("repair", { words: "Once measured", mark: "open", why });
  }

  /** Asks what each control leaves, one after the other: that takes seconds. */
  private async all(turn: number): Promise<void> {
    await new Promise((resolve) => setTimeout(resolve, REST));
    const left: Left[] = [];
    // Lattices for other programs are no control.
    const controls = this.targets.filter((of) => !of.target.startsWith("grid-"));
    for (const [tried, target] of controls.entries()) {
      if (turn !== this.turn) return;
      const answers = await this.session
        .askAtRest([corrected(target.target)])
        .catch((failure: unknown) => (failure instanceof Abandoned ? null : []));
      // All are tried again at rest.
      if (!answers) return;
      const [answer] = answers;
      const found = accepted<Compensated>(answer);
      if (turn !== this.turn) return;
      if (found) left.push({ target, found });
      left.sort((a, b) => after(a) - after(b));
      this.ranked(left, tried + 1 < controls.length ? `${tried + 1} of ${controls.length} tried` : "");
    }
  }

  /** `tried` is how far the list is; empty at its end. */
  private ranked(left: Left[], tried: string): void {
    const [best] = left;
    if (!best) return;
    const rows = left.map((of) => row(of.target.title, figure(`left-${of.target.target}`, after(of), "µm")));
    const list = table(["Control", `leaves, ${scopeOf(best.found.over)}`], rows);
    this.body.replaceChildren(scrolling(list));
    const answer = repaired(best.found, best.target.title);
    const of = tried ? `With the best so far, ${tried}` : "With the best";
    this.tell("repair", { ...answer, ...(tried ? { mark: "open" } : {}), why: [`${of}: ${best.target.title}.`] });
  }

  private async list(): Promise<void> {
    if (this.targets.length) return;
    const [answer] = await this.session.ask(["targets"]);
    this.targets = accepted<Target[]>(answer) ?? [];
    this.select.append(...this.targets.map(({ target, title }) => make("option", { value: target }, title)));
    this.select.value = place().target;
  }
}

/** What a control leaves of a machine, by its answer. */
export function leaves(answer: unknown, target: string): Answer {
  const found = accepted<Compensated>(answer);
  if (!found) return { words: "Refused", mark: "open", why: refusals(answer) };
  return repaired(found, target);
}

export const corrected = (target: string): Question => ({ map: { poses: { random: FULL.poses }, target } });

const scrolling = (of: HTMLElement) => make("div", { class: "scroll", tabindex: "0" }, of);

/** The figure of the headline. */
const judged = (over: Over) => (over.kind === "job" ? "max" : "p95");

const after = ({ found: { over, position_um } }: Left): number => position_um[judged(over)];

type Drawn = NonNullable<Repair["targets"][number]["drawn"]>;

const spreadOf = ({ least, most, machines }: Drawn) =>
  `${percent(least)} to ${percent(most)} of ${machines} machines drawn between the bounds`;

export const takenOff = (target: string): Question => ({ repair: { target, machines: MACHINES } });

/** What a control takes off machines drawn between bounds, by its answer. */
export function takesOff(answer: unknown, target: string): Answer {
  const [of] = accepted<Repair>(answer)?.targets ?? [];
  if (!of?.drawn) return { words: "Not known", mark: "open", why: refusals(answer) };
  const by = judged(of.over);
  const [before, after] = [of.uncompensated.position_um[by], of.compensated.position_um[by]];
  const both = [figure("answer-before", before, "µm"), " → ", figure("answer-after", after, "µm")];
  const why = [`With ${target}, once measured; ${spreadOf(of.drawn)}.`];
  return { words: `${percent(of.drawn.median)}:`, mark: after < before ? "yes" : "no", figure: both, why };
}

/** By the figure of the headline. */
function repaired({ over, position_um, uncompensated }: Compensated, target: string): Answer {
  const by = judged(over);
  const [before, after] = [uncompensated.position_um[by], position_um[by]];
  const both = [figure("answer-before", before, "µm"), " → ", figure("answer-after", after, "µm")];
  const share = before > 0 ? `${Math.max(0, Math.round(100 * (1 - after / before)))} %` : "Nothing";
  return { words: `${share}:`, mark: after < before ? "yes" : "no", figure: both, why: [`With ${target}.`] };
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
  const cannot = make("ul", { class: "words" }, ...target.cannot.map((line) => make("li", {}, said(line))));
  return [make("p", { class: "words" }, `Corrects ${target.expresses}. It cannot correct:`), cannot];
}

function refused(answer: Refusal): HTMLElement[] {
  return answer.diagnostics.map(({ message }) => make("p", { class: "refused" }, message));
}
