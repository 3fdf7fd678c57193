/** The part: tool poses of a file on the machine, coloured by deviation; those out of reach by the axis that stops. */

import { Newest } from "../evaluator/newest";
import {
  accepted,
  refusals,
  type PlacedPart,
  type Part as AskedPart,
  type Pose,
  type Question,
  type Refusal,
  type StatedPart,
  type Work,
  type WorkRow,
} from "../evaluator/types";
import type { WorkPoint } from "../machine/marks";
import type { Stage } from "../machine/stage";
import { isSettled, type Session, type State } from "../session";
import type { Answer, Tell } from "./answers";
import { move, place } from "../ui/address";
import { button, make } from "../ui/dom";
import { download } from "../ui/download";
import { fileButtons } from "../ui/files";
import { barChart } from "./chart";
import { figure } from "./number";
import { Player } from "./player";
import { bare, named, quantity, rounded, said } from "../units";

/** Colours of what stops a pose, told apart without red and green, and from the scale of deviations. */
const STOPPED = ["#0077bb", "#33bbee", "#009988", "#666666", "#7755cc", "#aa7700"];

/** References of the part, in words. */
const REFERENCES = {
  "": "As the job states, else zero",
  machine: "Machine coordinates",
  zero: "Zero at the part's origin",
  "best-fit": "Best fit",
  "best-fit:minimum-zone": "Best fit, minimum zone",
};

/** Whether the tool poses are solved one by one or as a whole, in words. */
const PATHS = { "": "As the file has them (APT: one path)", yes: "One continuous path", no: "Single poses" };

/** A part as it is asked for: its file with what is stated of it, or the job of the machine file. */
export interface NamedPart {
  asked: AskedPart | StatedPart;
  /** Texts of files that are not on the disk. */
  more: Record<string, string>;
  /** True for the job of the machine file. */
  isOwn: boolean;
  /** Its name. */
  name: string;
}

type Path = NonNullable<Work["map"]["path"]>;

type Feature = NonNullable<Work["map"]["features"]>[number];

/** Code of a file that cannot be read. */
const NO_FILE = "E0101";

/** Rows that are listed. */
const FEW = 6;

export class Part {
  private readonly input = make("input", { type: "text", id: "work", placeholder: "work.csv", spellcheck: "false" });
  private readonly reference = make(
    "select",
    { id: "reference", "aria-label": "Reference: what the set-up of the part takes out of the deviations" },
    ...Object.entries(REFERENCES).map(([value, words]) => make("option", { value }, words)),
  );
  private readonly path = make(
    "select",
    { id: "path", "aria-label": "Tool poses: one continuous path, or single ones" },
    ...Object.entries(PATHS).map(([value, words]) => make("option", { value }, words)),
  );
  private readonly ranges = make("input", {
    type: "text",
    id: "places",
    value: "X=-100..100:5,Y=-100..100:5",
    spellcheck: "false",
    "aria-label": "Places of the part: ranges of X, Y, Z in mm and of A, B, C in degrees, with the number of values",
  });
  private readonly places = make("div", { "aria-live": "polite" });
  private readonly body = make("div", { "aria-live": "polite" });
  private readonly asking: Newest;
  private readonly player: Player;
  /** What a report states of the part besides its file. */
  stated: StatedPart = {};
  /** True if the part that is shown is the job of the machine file. */
  private isOwn = false;
  /** Names that are those of files beside the machine file. */
  private readonly besides = new Set<string>();
  /** A file that was dropped, or chosen: its name and text. */
  private given: { name: string; text: string } | null = null;

  constructor(
    parent: HTMLElement,
    private readonly session: Session,
    private readonly stage: Stage | null,
    private readonly go: (pose: Pose) => void,
    /** Stands at a pose at once. */
    stand: (pose: Pose, rests: boolean) => void,
    /** Hears that there is a part, or none. */
    private readonly heard: () => void,
    /** Hears that the part is another one. */
    private readonly changed: () => void,
    private readonly tell: Tell,
    failed: (failure: unknown) => void,
  ) {
    this.asking = new Newest(failed, this.body);
    this.player = new Player(stand);
    this.input.value = place().work;
    this.input.addEventListener("change", () => this.name());
    for (const choice of [this.reference, this.path]) choice.addEventListener("change", this.changed);
    const file = make("input", { type: "file", "aria-label": "File of tool poses", id: "work-file", hidden: "" });
    file.addEventListener("change", () => void this.take(file.files));
    const choose = button("Choose a file", () => file.click());
    const words =
      "Tool poses in the workpiece frame: CSV with X, Y, Z and I, J, K or rotary axes, APT, or a job file. " +
      "Drop a file here, choose it, or name it:";
    const chooser = make("p", { class: "chooser" }, this.input, choose, file);
    const setUp = make("p", {}, make("label", { for: "reference" }, "Reference "), this.reference);
    const solved = make("p", {}, make("label", { for: "path" }, "Tool poses "), this.path);
    const trying = make("p", {}, make("label", { for: "places" }, "Other places "), this.ranges);
    trying.append(button("Try", () => this.tryPlaces(), { id: "try-places" }));
    parent.append(
      make("p", { class: "words" }, words),
      chooser,
      setUp,
      solved,
      this.body,
      this.player.body,
      trying,
      this.places,
    );
    this.input.setAttribute("aria-label", "Path of a file of tool poses");
    parent.addEventListener("dragover", (event) => event.preventDefault());
    parent.addEventListener("drop", (event) => {
      event.preventDefault();
      void this.take(event.dataTransfer?.files ?? null);
    });
  }

  show(state: State): void {
    this.body.classList.toggle("stale", !isSettled(state));
    if (isSettled(state)) this.update();
  }

  private name(): void {
    this.given = null;
    move({ work: this.input.value.trim() });
    this.changed();
  }

  private async take(files: FileList | null): Promise<void> {
    const file = files?.[0];
    if (!file) return;
    this.given = { name: this.session.beside(file.name), text: await file.text() };
    this.input.value = "";
    move({ work: "" });
    this.changed();
  }

  /** Begins with a part that the command line names; the page's address has a newer one. */
  begin(work: string | undefined, stated: StatedPart | undefined): void {
    this.stated = stated ?? {};
    if (!work || place().work) return;
    move({ work });
    this.input.value = work;
  }

  /** The part that is shown: the one that is named, or else the job of the machine file if there is one. */
  get work(): NamedPart | null {
    const named = this.named();
    return named.isOwn && !this.isOwn ? null : named;
  }

  /** A file that is not where it was looked for is looked for beside the machine file; false if that is the same. */
  private lookBeside(): boolean {
    const path = place().work;
    const beside = this.session.beside(path);
    if (!path || path.startsWith("/") || path === beside || this.besides.has(path)) return false;
    this.besides.add(path);
    return true;
  }

  /** The part that is asked for: of the machine file where none is named. */
  named(): NamedPart {
    const along = this.path.value ? { path: this.path.value === "yes" } : {};
    const stated = { ...this.stated, ...along, ...(this.reference.value ? { reference: this.reference.value } : {}) };
    const named = place().work;
    const path = this.given?.name ?? (this.besides.has(named) ? this.session.beside(named) : named);
    const more = this.given ? { [this.given.name]: this.given.text } : {};
    if (!path) return { asked: stated, more, isOwn: true, name: "the job of the machine file" };
    const of = /\.ya?ml$/i.test(path) ? { job: path } : { tool_poses: path };
    return { asked: { ...of, ...stated }, more, isOwn: false, name: path.replace(/^.*[/\\]/, "") };
  }

  /** The question about the part, with the texts that it needs. */
  question(): { question: Question; more: Record<string, string> } {
    const { asked, more } = this.named();
    const { samples, map } = this.session.settings;
    return { question: { work: { ...asked, samples, map } }, more };
  }

  private update(): void {
    const { isOwn, name } = this.named();
    this.places.replaceChildren();
    void this.asking.do(async () => {
      const { question, more } = this.question();
      const [answer] = await this.session.askAtRest([question], more);
      if (answer === undefined) return;
      const work = accepted<Work>(answer);
      const isMissing = !work && (answer as Refusal | null)?.diagnostics?.[0]?.code === NO_FILE;
      if (isMissing && !isOwn && this.lookBeside()) return this.changed();
      this.isOwn = isOwn && answer !== null;
      this.heard();
      if (work) this.shown(work, name);
      else this.nothing(refusals(answer), isMissing);
    });
  }

  /** Tries the part at other places of the table. */
  private tryPlaces(): void {
    const { work } = this;
    if (!work) return;
    void this.asking.do(async () => {
      const question = { place: { ...work.asked, ranges: this.ranges.value, figure: true } };
      const [answer] = await this.session.askAtRest([question], work.more);
      const tried = accepted<PlacedPart>(answer);
      const refused = answer === undefined ? [] : (answer as Refusal).diagnostics;
      const say = ({ message }: { message: string }) => make("p", { class: "refused" }, message);
      this.places.replaceChildren(...(tried ? placed(tried) : refused.map(say)));
    });
  }

  private nothing(reasons: string[], isMissing: boolean): void {
    this.stage?.path([], 1);
    this.player.clear();
    const words = isMissing ? "File missing" : "Not readable";
    this.tell("fits", reasons.length ? { words, mark: "open", why: [`${reasons.join(" ")}.`] } : undefined);
    this.body.replaceChildren(...reasons.map((reason) => make("p", { class: "refused" }, reason)));
  }

  private shown(work: Work, name: string): void {
    const rows = work.rows.poses;
    const reached = rows.filter((row) => row.axes).sort((a, b) => deviation(b) - deviation(a));
    const stops = [...new Set(rows.filter((row) => !row.axes).map(stop))];
    const colours = new Map(stops.map((of, i) => [of, STOPPED[i % STOPPED.length] ?? "#666666"]));
    const most = reached[0] ? deviation(reached[0]) : 0;
    this.stage?.path(points(work, colours, this.go), most, !!work.map.path);
    this.tell("fits", fits(rows));
    this.player.show(work);
    const csv = () => download.csv("part", [["line", "feature", "um", "stopped_by"], ...rows.map(line)]);
    this.body.replaceChildren(
      make(
        "p",
        {},
        make("strong", {}, `${reached.length} of ${rows.length}`),
        ` tool poses of ${name} are reached`,
        ...this.largest(reached),
      ),
      make("p", { class: "words", id: "part-over" }, said(`${work.over}.`)),
      ...(work.limit ? [make("p", { class: "words", id: "part-limit" }, said(`Job: ${work.limit}.`))] : []),
      this.legend(colours, rows),
      ...(work.map.path ? [events(work.map.path)] : []),
      ...this.features(work),
      make("ol", { class: "rows" }, ...reached.slice(0, FEW).map((row) => this.row(row))),
      make("p", {}, button("CSV", csv)),
    );
  }

  private largest(reached: WorkRow[]): (Node | string)[] {
    const [worst] = reached;
    if (!worst?.axes) return ["."];
    const { axes } = worst;
    const see = button("Go to the worst", () => this.go(axes), { id: "worst-of-part", class: "primary" });
    return ["; at most ", figure("part-max", deviation(worst), "µm"), ". ", see];
  }

  private legend(colours: Map<string, string>, rows: WorkRow[]): HTMLElement {
    const entry = ([of, colour]: [string, string]) => {
      const mark = make("span", { class: "stop" });
      mark.style.background = colour;
      const count = rows.filter((row) => !row.axes && stop(row) === of).length;
      return make("li", { "data-stop": of }, mark, ` ${count} ${words(of)}`);
    };
    const most = Math.max(0, ...rows.filter((row) => row.axes).map(deviation));
    const scale = make("span", { class: "scale" });
    scale.style.background = `linear-gradient(to right, ${this.stage?.marks.colours.join(", ")})`;
    const colouring = make("li", {}, "0 ", scale, ` ${quantity(most)}`);
    return make("ul", { class: "inline" }, colouring, ...[...colours].map(entry));
  }

  /** Per feature the largest deviation with the errors that make it; a bar leads there. */
  private features(work: Work): HTMLElement[] {
    const list = [...(work.map.features ?? [])].sort((a, b) => (b.max_um ?? -1) - (a.max_um ?? -1));
    if (!list.length) return [];
    const most = Math.max(...list.map((of) => of.max_um ?? 0), 1e-9);
    const bars = list.map((of) => this.feature(of, most));
    const title = "Largest deviation of each feature";
    return [make("h2", {}, title), make("ol", { class: "bars features" }, ...bars), chartFiles(title, list)];
  }

  private feature(of: Feature, most: number): HTMLElement {
    const name = of.feature || "no feature";
    const fill = make("span", { class: "fill" });
    fill.style.width = `${(100 * (of.max_um ?? 0)) / most}%`;
    const causes = of.errors
      .slice(0, 3)
      .flatMap(({ error, um }) => [
        make("span", { "data-error": error, tabindex: "0" }, error),
        `\u00a0${bare(um)}\u00a0${named("um")}, `,
      ]);
    if (of.unreached) causes.push(`${of.unreached} of ${of.poses + of.unreached} poses out of reach, `);
    const last = causes.pop();
    if (last !== undefined) causes.push(String(last).replace(/, $/, ""));
    const value = of.max_um === null ? "not reached" : figure(`feature-${of.feature}`, of.max_um, "µm");
    const track = make("span", { class: "track" }, fill);
    const words = make("span", { class: "what" }, ...causes);
    const axes = of.axes;
    const head = axes ? button(name, () => this.go(axes), { class: "link" }) : name;
    const line = make(
      "li",
      { "data-feature": of.feature },
      head,
      words,
      make("span", { class: "value" }, value),
      track,
    );
    if (axes) track.addEventListener("click", () => this.go(axes));
    return line;
  }

  private row(row: WorkRow): HTMLElement {
    const label = `Line ${row.line}${row.feature ? `, ${row.feature}` : ""}`;
    const see = button(label, () => row.axes && this.go(row.axes), { class: "link" });
    return make("li", {}, see, " ", figure(`line-${row.line}`, deviation(row), "µm"));
  }
}

/** Events of a path: rewinds, pole crossings, reversals, by the lines of the file. */
function events(path: Path): HTMLElement {
  const turns = (of: Record<string, number>) => Object.entries(of).map(([axis, deg]) => `${axis} ${rounded(deg)}°`);
  const rewinds = path.rewinds.map(
    ({ lines: [from, to], turns_deg }) => `Rewind between lines ${from} and ${to}: ${turns(turns_deg).join(", ")}`,
  );
  const poles = path.pole_crossings.map(({ axis, nearest_line, nearest_deg, deg_per_mm }) => {
    const rate = deg_per_mm === null ? "it turns while the tip stands" : `up to ${rounded(deg_per_mm)}°/mm`;
    return `Pole of ${axis} at line ${nearest_line}, ${rounded(nearest_deg)}° away: ${rate}`;
  });
  const reversals = path.axes
    .filter(({ reversals }) => reversals.length)
    .map(({ axis, reversals }) => `${axis} ${reversals.length}`);
  const all = [
    ...few(rewinds, "rewinds"),
    ...few(poles, "pole crossings"),
    reversals.length ? `Reversals: ${reversals.join(", ")}` : "No axis reverses",
  ];
  if (!rewinds.length) all.unshift("No rewinds");
  return make("ul", { id: "part-path", "data-rewinds": `${rewinds.length}` }, ...all.map((of) => make("li", {}, of)));
}

/** The first of a list, and how many more there are. */
function few(list: string[], of: string): string[] {
  return list.length > FEW ? [...list.slice(0, FEW), `... and ${list.length - FEW} more ${of}`] : list;
}

/** The best of the places that were tried, and the picture of all. */
function placed({ placement, svg, over }: PlacedPart): HTMLElement[] {
  const { best, own, places, reach_all } = placement;
  const head = make("p", { class: "words", id: "places-over" }, `${over}.`);
  const tried = `${places} places were tried, ${reach_all} reach all tool poses. `;
  const rows = [placeRow("Best", best), placeRow("Own", own)].filter((row) => row !== null);
  const columns = ["", "X, Y, Z mm", "A, B, C deg", "reached", "rewinds", `95 % ${named("um")}`, `max ${named("um")}`];
  const header = make("tr", {}, ...columns.map((of) => make("th", {}, of)));
  const table = make("table", { id: "places-table" }, make("thead", {}, header), make("tbody", {}, ...rows));
  const picture = make("img", { alt: "The places, coloured; best and own are marked", class: "picture" });
  picture.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
  const save = button("SVG", () => download.svg("places", svg));
  return [head, make("p", {}, best ? tried : `${tried}None reaches a tool pose.`), table, picture, make("p", {}, save)];
}

function placeRow(name: string, of: PlacedPart["placement"]["own"] | null | undefined): HTMLElement | null {
  if (!of) return null;
  const um = (value: number | null | undefined) => (value == null ? "–" : bare(value));
  const { origin, rotation } = of.place;
  const numbers = [origin.map(rounded).join(", "), rotation.map(rounded).join(", "), `${of.reached}`];
  const cells = [name, ...numbers, `${of.rewinds ?? "–"}`, um(of.p95_um), um(of.max_um)];
  const values = { "data-p95": `${of.p95_um ?? ""}`, "data-reached": `${of.reached}` };
  return make("tr", values, ...cells.map((cell) => make("td", {}, cell)));
}

/** Whether a part fits, by its rows. */
export function fits(rows: WorkRow[]): Answer {
  const stops = [...new Set(rows.filter((row) => !row.axes).map(stop))];
  const missed = rows.filter((row) => !row.axes).length;
  const figure = [`${rows.length - missed} of ${rows.length} poses are reached`];
  if (missed) return { words: "No, travel:", mark: "no", figure, why: [`The rest is ${stops.map(words).join(", ")}.`] };
  return { words: "Yes, by travel:", mark: "yes", figure, why: ["Collisions are not tested."] };
}

/** The bars of the features as files. */
function chartFiles(title: string, list: Feature[]): HTMLElement {
  const causes = (of: Feature) => of.errors.map(({ error, um }) => `${error} ${quantity(um)}`).join(", ");
  const chart = () =>
    barChart(
      title,
      "with the errors that make it, first order",
      list.map((of) => ({ name: of.feature, words: causes(of), um: of.max_um ?? 0 })),
    );
  const rows = list.map((of) => [of.feature, of.poses, of.unreached, of.max_um, of.line, causes(of)]);
  const head = ["feature", "reached", "unreached", "max_um", "line", "errors"];
  return make("p", { class: "files" }, ...fileButtons("features", () => [head, ...rows], chart));
}

/** Length of the deviation, um; of a machine that is only bounded its 95 % value. */
function deviation(row: WorkRow): number {
  return row.position_um?.p95 ?? Math.hypot(...(row.deviation_um ?? [0, 0, 0]));
}

/** What stops a row: the axis that is farthest beyond its travel, else the reason. */
function stop(row: WorkRow): string {
  const [first] = [...(row.beyond ?? [])].sort((a, b) => Math.abs(b.by) - Math.abs(a.by));
  return first?.axis ?? row.why ?? "";
}

function words(stop: string): string {
  if (stop === "direction") return "in a direction that the rotary axes cannot point";
  if (stop === "place") return "at a place that the axes do not span";
  return `stopped by ${stop}`;
}

function points(work: Work, colours: Map<string, string>, go: (pose: Pose) => void): WorkPoint[] {
  const rows = new Map(work.rows.poses.map((row) => [row.line, row]));
  return work.tips.map(({ line, tip_mm: tip }) => {
    const row = rows.get(line);
    const axes = row?.axes;
    if (row && axes) {
      const words = `line ${line}: ${quantity(deviation(row))}`;
      return { tip, um: deviation(row), stopped: "", words, click: () => go(axes) };
    }
    const of = row ? stop(row) : "";
    return { tip, um: null, stopped: colours.get(of) ?? "#666666", words: `line ${line}: ${words(of)}` };
  });
}

function line(row: WorkRow): (string | number | null)[] {
  return [row.line, row.feature ?? "", row.axes ? deviation(row) : null, row.axes ? "" : stop(row)];
}
