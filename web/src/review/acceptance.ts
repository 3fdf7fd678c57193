/** What an acceptance test will read: ball bar, R-test and laser diagonals on this machine. */

import { Newest } from "../evaluator/newest";
import { accepted, type BallBar, type Diagonals, type Refusal, type RTest, type Vec3 } from "../evaluator/types";
import { isSettled, type Session, type State } from "../session";
import type { Answer, Tell } from "./answers";
import { make } from "../ui/dom";
import { folding, row, table, tableFiles } from "../ui/table";
import { figure } from "./number";

export class Acceptance {
  private readonly body = make("div", { "aria-live": "polite" });
  private readonly asking: Newest;

  constructor(
    parent: HTMLElement,
    private readonly session: Session,
    private readonly tell: Tell,
    failed: (failure: unknown) => void,
  ) {
    this.asking = new Newest(failed, this.body);
    parent.append(this.body);
  }

  show(state: State): void {
    this.body.classList.toggle("stale", !isSettled(state));
    if (!isSettled(state)) return;
    if (state.now.map?.from === "bounds" || !state.now.sources?.errors.length) {
      const words = "Nothing of this machine is measured: what a test reads depends on the errors that it will have.";
      this.tell("test", {
        words: "Once measured",
        mark: "open",
        why: ["Readings depend on the errors that it will have."],
      });
      return this.body.replaceChildren(make("p", { class: "words" }, words));
    }
    const { machine } = state.now.chain;
    void this.asking.do(async () => {
      const tests = (["ball_bar", "r_test", "diagonals"] as const).map((instrument) => ({
        instrument: { instrument },
      }));
      const [bar, turn, lines] = await this.session.askAtRest(tests);
      if (bar === undefined) return;
      this.tell("test", readings(accepted<BallBar>(bar), accepted<Diagonals>(lines)));
      const sections = [
        section("Ball bar, ISO 230-4", "bidirectional circular deviation", bar, circles),
        section("R-test", "range of the ball's reading along X, Y, Z", turn, turns),
        section("Laser along body diagonals, ISO 230-6", "systematic deviation and reversal", lines, diagonals),
      ];
      const tables = sections.flatMap((of) => [...of.querySelectorAll("table")]);
      const over = "Readings of the machine by itself: circles, balls and diagonals in its volume, whatever the job.";
      this.body.replaceChildren(
        make("p", { class: "words" }, over),
        ...sections,
        make("p", { class: "files" }, ...tableFiles("acceptance", `${machine}: acceptance test`, ...tables)),
      );
    });
  }
}

/** The largest readings: one line. */
function readings(bar: BallBar | null, lines: Diagonals | null): Answer {
  const planes = [...(bar?.planes ?? [])].sort((a, b) => b.bidirectional_um - a.bidirectional_um);
  const diagonals = [...(lines?.diagonals ?? [])].sort((a, b) => b.e_d_um - a.e_d_um);
  const words: (Node | string)[] = [];
  if (planes[0]) words.push(`Ball bar ${planes[0].plane} `, figure("answer-bar", planes[0].bidirectional_um, "µm"));
  if (diagonals[0]) {
    words.push(words.length ? ", diagonal " : "Diagonal ", signs(diagonals[0].name), " ");
    words.push(figure("answer-diagonal", diagonals[0].e_d_um, "µm"));
  }
  if (!words.length) return { words: "No test", mark: "open", why: ["None of these tests fits this machine."] };
  return { words: "At most", figure: words, why: ["Of the machine by itself, in its volume."] };
}

const signs = (name: string) => name.replaceAll("p", "+").replaceAll("n", "−");

type Row = [string, Node[]];

/** A test with its readings, or with the reason why this machine has none. */
function section<T>(title: string, words: string, answer: unknown, rows: (of: T) => Row[]): HTMLElement {
  const found = accepted<T>(answer);
  if (!found) {
    const reasons = ((answer as Refusal | undefined)?.diagnostics ?? []).map(({ message }) => message);
    return folding(title, make("p", { class: "words" }, reasons.join(" ")));
  }
  const list = rows(found).map(([name, cells]) => row(name, ...cells));
  const columns = Math.max(0, ...list.map((of) => of.cells.length - 1));
  const heads = ["", ...Array.from({ length: columns }, (_, i) => (columns === 3 ? ("XYZ"[i] ?? "") : ""))];
  const made = columns === 3 ? table(heads, list) : make("table", { class: "list" }, make("tbody", {}, ...list));
  made.prepend(make("caption", { class: "words" }, words));
  return folding(title, made);
}

function circles({ planes, radius_mm }: BallBar): Row[] {
  return planes.map((of) => [
    `${of.plane}, ${radius_mm} mm`,
    [
      figure(`ball-bar-${of.plane}`, of.bidirectional_um, "µm"),
      make("span", {}, "squareness ", figure(`square-${of.plane}`, of.squareness_urad, "µrad")),
    ],
  ]);
}

function turns({ axes }: RTest): Row[] {
  const cells = (axis: string, range: Vec3) => range.map((um, i) => figure(`r-test-${axis}-${"XYZ"[i]}`, um, "µm"));
  return axes.map(({ axis, range_um }) => [axis, cells(axis, range_um)]);
}

function diagonals({ diagonals: list }: Diagonals): Row[] {
  return list.map(({ name, e_d_um, b_d_um }) => [
    signs(name),
    [figure(`e-d-${name}`, e_d_um, "µm"), make("span", {}, "reversal ", figure(`b-d-${name}`, b_d_um, "µm"))],
  ]);
}
