/** What an acceptance test will read: ball bar, R-test and laser diagonals on this machine. */

import { Newest } from "../evaluator/newest";
import type { InstrumentResult } from "../evaluator/results";
import { accepted, type BallBar, type Diagonals, type Refusal, type RTest, type Vec3 } from "../evaluator/types";
import { type Findings, isSettled, type Session, type State } from "../session";
import type { Answer, Tell } from "./answers";
import { make } from "../ui/dom";
import { folding, row, table, tableFiles } from "../ui/table";
import { counted, figure } from "./number";
import { between } from "../units";

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
    const { machine } = state.now.chain;
    void this.asking.do(async () => {
      const [bar, turn, lines] = await this.session.askAtRest(INSTRUMENTS);
      if (bar === undefined) return;
      const answers = [bar, turn, lines];
      const bounds = answers.map((of) => accepted<Bounded>(of)?.bounds);
      if (bounds.some((of) => of)) {
        this.tell("test", ofBounds(bounds[0], bounds[2]));
        return this.bounded(machine, answers);
      }
      if (isUnknown(state.now)) return this.nothing();
      this.tell("test", readings(accepted<BallBar>(bar), accepted<Diagonals>(lines)));
      const sections = [
        section(...TESTS[0], bar, circles),
        section(...TESTS[1], turn, turns),
        section(TESTS[2][0], `${TESTS[2][1]} and reversal`, lines, diagonals),
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

  /** No error has a value or a bound. */
  private nothing(): void {
    const words = "No error has a value or a bound: what a test reads depends on the errors.";
    this.tell("test", { words: "Not known", mark: "open", why: [words] });
    this.body.replaceChildren(make("p", { class: "words" }, words));
  }

  /** The readings of machines drawn between bounds. */
  private bounded(machine: string, answers: unknown[]): void {
    const sections = TESTS.map(([title, words], i) => {
      const found = accepted<Bounded>(answers[i])?.bounds;
      const rows = (found?.readings ?? []).map(({ name, rss_um, p95_um: { value, low, high } }) =>
        row(
          signs(name),
          figure(`rss-${i}-${name}`, rss_um, "µm"),
          figure(`p95-${i}-${name}`, value, "µm"),
          typeof low === "number" && typeof high === "number" ? between([low, high]) : "",
        ),
      );
      if (!rows.length) return section<Bounded>(title, words, answers[i], () => []);
      const list = table(["", "RSS", "95 % of machines", "interval"], rows);
      list.prepend(make("caption", { class: "words" }, words));
      return folding(title, list);
    });
    const drawn = answers.map((of) => accepted<Bounded>(of)?.bounds).find((of) => of);
    const words =
      `Nothing is measured: readings of ${counted(drawn?.samples ?? 0)} machines drawn between the bounds, without ` +
      "reversal, in the volume, whatever the job. RSS: root of the sum of squares of the 95 % reading with one bound alone.";
    const tables = sections.flatMap((of) => [...of.querySelectorAll("table")]);
    this.body.replaceChildren(
      make("p", { class: "words" }, words),
      ...sections,
      make("p", { class: "files" }, ...tableFiles("acceptance", `${machine}: acceptance test`, ...tables)),
    );
  }
}

type Bounded = InstrumentResult;

/** The questions of the tests. */
export const INSTRUMENTS = (["ball_bar", "r_test", "diagonals"] as const).map((instrument) => ({
  instrument: { instrument },
}));

/** What the tests read of a machine, by their answers; none where nothing is known of it. */
export function tested([bar, , lines]: unknown[], of: Findings): Answer | undefined {
  const bounds = [bar, lines].map((answer) => accepted<Bounded>(answer)?.bounds);
  if (bounds.some((found) => found)) return ofBounds(bounds[0], bounds[1]);
  if (isUnknown(of)) return undefined;
  return readings(accepted<BallBar>(bar), accepted<Diagonals>(lines));
}

const TESTS = [
  ["Ball bar, ISO 230-4", "bidirectional circular deviation"],
  ["R-test", "range of the ball's reading along X, Y, Z"],
  ["Laser along body diagonals, ISO 230-6", "systematic deviation"],
] as const;

const isUnknown = ({ map, sources }: Findings): boolean => map?.from === "bounds" || !sources?.errors.length;

type Readings = InstrumentResult["bounds"];

/** The largest readings of 95 % of drawn machines, with their intervals. */
function ofBounds(bar: Readings, lines: Readings): Answer {
  const words = [
    ...largest("Ball bar", "answer-bar", bar),
    ...(bar && lines ? ["; "] : []),
    ...largest(bar ? "diagonal" : "Diagonal", "answer-diagonal", lines),
  ];
  if (!words.length) return { words: "No test", mark: "open", why: ["None of these tests fits this machine."] };
  const why = [`95 of 100 machines built to the bounds, in the volume.`];
  return { words: "At most", figure: words, why };
}

function largest(test: string, at: string, of: Readings): (Node | string)[] {
  const [first] = [...(of?.readings ?? [])].sort((a, b) => b.p95_um.value - a.p95_um.value);
  if (!first) return [];
  const { value, low, high } = first.p95_um;
  const interval = typeof low === "number" && typeof high === "number" ? ` (${between([low, high])})` : "";
  return [`${test} ${signs(first.name)} `, figure(at, value, "µm"), interval];
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

/** A diagonal by the signs of its directions, which no line breaks. */
const signs = (name: string) =>
  /^[pn]+$/.test(name) ? [...name].map((of) => (of === "p" ? "+" : "−")).join("\u2060") : name;

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
