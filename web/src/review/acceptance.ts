/** What an acceptance test will read: ball bar, R-test and laser diagonals on this machine. */

import { Newest } from "../evaluator/newest";
import { accepted, type BallBar, type Diagonals, type Refusal, type RTest, type Vec3 } from "../evaluator/types";
import { isSettled, type Session, type State } from "../session";
import { make } from "../ui/dom";
import { asCsv, row } from "../ui/table";
import { figure } from "./number";

export class Acceptance {
  private readonly body = make("div", { "aria-live": "polite" });
  private readonly asking: Newest;

  constructor(
    parent: HTMLElement,
    private readonly session: Session,
    failed: (failure: unknown) => void,
  ) {
    this.asking = new Newest(failed);
    parent.append(this.body);
  }

  show(state: State): void {
    this.body.classList.toggle("stale", state.stale);
    if (!isSettled(state)) return;
    if (state.now.map?.from === "bounds" || !state.now.sources?.errors.length) {
      const words = "Nothing of this machine is measured: what a test reads depends on the errors that it will have.";
      return this.body.replaceChildren(make("p", { class: "words" }, words));
    }
    void this.asking.do(async () => {
      const tests = (["ball_bar", "r_test", "diagonals"] as const).map((instrument) => ({
        instrument: { instrument },
      }));
      const [bar, turn, lines] = await this.session.ask(tests);
      if (bar === undefined) return;
      const sections = [
        ...section("Ball bar, ISO 230-4", "bidirectional circular deviation", bar, circles),
        ...section("R-test", "range of the ball's reading along X, Y, Z", turn, turns),
        ...section("Laser along body diagonals, ISO 230-6", "systematic deviation and reversal", lines, diagonals),
      ];
      const tables = sections.filter((of) => of instanceof HTMLTableElement);
      this.body.replaceChildren(...sections, make("p", {}, asCsv("acceptance", ...tables)));
    });
  }
}

type Row = [string, Node[]];

/** A test with its readings, or with the reason why this machine has none. */
function section<T>(title: string, words: string, answer: unknown, rows: (of: T) => Row[]): HTMLElement[] {
  const found = accepted<T>(answer);
  const head = make("h2", {}, title);
  if (!found) {
    const reasons = ((answer as Refusal | undefined)?.diagnostics ?? []).map(({ message }) => message);
    return [head, make("p", { class: "words" }, reasons.join(" "))];
  }
  const caption = make("caption", { class: "words" }, words);
  const body = make("tbody", {}, ...rows(found).map(([name, cells]) => row(name, ...cells)));
  return [head, make("table", { class: "list" }, caption, body)];
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
    name.replaceAll("p", "+").replaceAll("n", "−"),
    [figure(`e-d-${name}`, e_d_um, "µm"), make("span", {}, "reversal ", figure(`b-d-${name}`, b_d_um, "µm"))],
  ]);
}
