/** The workbench: puts the parts together. Every change of the machine is a change of the text in the editor. */

import "./style.css";
import { axisAdded, axisRemoved } from "./editor/axes";
import { type Change, chainEdit } from "./editor/chain";
import type { Schema } from "./editor/complete";
import { inWords, range as placeRange, show as showMarks } from "./editor/diagnostics";
import { Editor } from "./editor/editor";
import { Forms } from "./editor/forms";
import { numbers } from "./editor/numbers";
import { showQuestions } from "./editor/questions";
import { WhatIf } from "./editor/whatif";
import { Playground } from "./evaluator/playground";
import { Program } from "./evaluator/program";
import { unpacked } from "./evaluator/packed";
import { Report, type ReportStart } from "./evaluator/report";
import {
  accepted,
  type Axis,
  type Chain,
  Conflict,
  type Diagnostic,
  type Evaluator,
  type Pose,
  type Store,
} from "./evaluator/types";
import { Cards } from "./explain/card";
import { AxisSliders } from "./machine/axes";
import { Beside } from "./machine/beside";
import { Deviation } from "./machine/deviation";
import { Looks } from "./machine/look";
import { Stage, type View } from "./machine/stage";
import { Acceptance } from "./review/acceptance";
import { Answers } from "./review/answers";
import { Control } from "./review/control";
import { AxisCurve } from "./review/curve";
import { Pareto } from "./review/pareto";
import { Part } from "./review/part";
import { ReachLine } from "./review/reach";
import { slide } from "./review/slide";
import { StatisticsTable } from "./review/statistics";
import { Tighten } from "./review/tighten";
import { Variants } from "./review/variants";
import { Verdict } from "./review/verdict";
import { type Findings, isSettled, Session, type State } from "./session";
import { move, place } from "./ui/address";
import { Chips } from "./ui/chips";
import { choices } from "./ui/conflict";
import { button, byId, make } from "./ui/dom";
import { download, save } from "./ui/download";
import { Tabs } from "./ui/tabs";
import { Pane } from "./ui/pane";
import { Problems } from "./ui/problems";
import { followTheme } from "./ui/theme";
import { ToolChoice } from "./ui/tools";
import { UnitChoice } from "./ui/unit-choice";

/** Time between two looks at the file on the disk, and where the program does not answer, ms. */
const [LOOK, LOOK_LOST] = [400, 2000];

/** Code of a tool that a machine does not have. */
const NO_TOOL = "E0801";

/** The picture of the machine on paper, in pixels. */
const PAPER: [number, number] = [1100, 480];

const PICTURE = { title: "Download the picture as PNG" };

class Workbench {
  private readonly problems = new Problems();
  private readonly nonce = document.querySelector("style")?.nonce ?? "";
  private readonly editor: Editor;
  private readonly whatif: WhatIf;
  private readonly forms: Forms;
  private readonly session: Session;
  private readonly stage = standing((axis, position, rests) => this.sliders.drag(axis, position, rests));
  private readonly deviation: Deviation;
  private readonly sliders = new AxisSliders(
    byId("axes"),
    byId("poses"),
    (pose, rests) => this.moved(pose, rests),
    (axis) => this.stage?.point(axis),
  );
  private readonly chips = new Chips(byId("chain"), {
    move: (list) => this.rebuild(chainEdit(this.editor.view.state, list)),
    add: (list, axis) => this.rebuild(axisAdded(this.editor.view.state, list, axis)),
    remove: (list, axis) => this.rebuild(axisRemoved(this.editor.view.state, list, axis)),
  });
  private readonly units = new UnitChoice(
    () => this.editor.text,
    () => this.reads(),
  );
  private readonly tools = new ToolChoice(byId("poses"), (tool) => this.take(tool));
  private readonly verdict = new Verdict(
    byId("verdict"),
    () => this.part.work !== null,
    () => this.session.refresh(),
  );
  private readonly statistics = new StatisticsTable(byId("statistics"), byId("poses"), (pose) => this.sliders.go(pose));
  private readonly panels = {
    answers: make("div"),
    errors: make("div"),
    curve: make("div"),
    tighten: make("div"),
    variants: make("div"),
    part: make("div"),
    control: make("div"),
    acceptance: make("div"),
  };
  private readonly answers = new Answers(this.panels.answers, (panel) => this.tabs.choose(panel));
  private readonly tabs: Tabs;
  private readonly pareto: Pareto;
  private readonly curve: AxisCurve;
  private readonly beside: Beside;
  private readonly cards = new Cards();
  private readonly looks: Looks;
  private readonly reach: ReachLine;
  private readonly tighten: Tighten;
  private readonly variants: Variants;
  private readonly part: Part;
  private readonly control: Control;
  private readonly acceptance: Acceptance;
  private schema: Schema | null = null;
  /** The chain that the controls show. */
  private shown: Chain | null = null;
  /** The diagnostics that are marked. */
  private marked = "";
  private readonly undo = button("Undo", () => this.editor.undo());
  private readonly redo = button("Redo", () => this.editor.redo());
  private readonly keep: HTMLButtonElement;

  constructor(
    evaluator: Evaluator,
    private readonly store: Store,
  ) {
    this.session = new Session(
      evaluator,
      (state) => this.show(state),
      (message) => this.problems.outdates("figures", message),
      working,
    );
    this.editor = new Editor(byId("editor"), this.nonce, store.isReadOnly, {
      changed: (draft) => this.changed(draft),
      cursor: () => this.whatif?.follow(),
      save: () => void this.save(),
      language: () => this.schema && { schema: this.schema, words: this.session.words },
      explain: (name) => this.cards.of(name),
    });
    new Pane(byId("file"), (does) => this.editor.wrap(does));
    this.whatif = new WhatIf(byId("whatif"), this.editor);
    this.forms = new Forms(byId("fields"), this.editor);
    this.beside = new Beside(byId("poses"), this.stage, this.session, () => this.deviation.update());
    this.looks = new Looks(this.session, this.problems, (surfaces) => {
      this.stage?.dress(surfaces);
      this.beside.dress(surfaces);
    });
    this.deviation = new Deviation(byId("legend"), byId("poses"), this.stage, this.session, () => this.beside.view);
    const failed = (failure: unknown) => this.problems.outdates("figures", said(failure));
    this.reach = new ReachLine(byId("reach"), this.session, failed);
    const { session, panels, editor } = this;
    const { tell } = this.answers;
    const move = (axis: Axis, position: number, rests: boolean) => this.sliders.drag(axis, position, rests);
    this.pareto = new Pareto(panels.errors, (error) => this.find(error), session, tell, failed);
    this.curve = new AxisCurve(panels.curve, session, move, failed);
    this.tighten = new Tighten(panels.tighten, session, editor, tell, failed);
    const kept = (first: string) => this.beside.take(first);
    this.variants = new Variants(panels.variants, session, editor, () => this.part.question(), kept, tell, failed);
    this.part = new Part(
      panels.part,
      session,
      this.stage,
      (pose) => this.sliders.go(pose),
      (pose, rests) => this.sliders.stand(pose, rests),
      () => this.verdict.again(),
      () => session.refresh(),
      tell,
      failed,
    );
    session.over = () => (place().over === "volume" ? null : this.part.named());
    this.control = new Control(panels.control, session, () => this.beside.take(null), tell, failed);
    this.acceptance = new Acceptance(panels.acceptance, session, tell, failed);
    this.tabs = new Tabs(byId("review"), "Review", [
      { name: "answers", label: "Review", panel: panels.answers },
      { name: "errors", label: "Errors", panel: this.panels.errors },
      { name: "curve", label: "Curve", panel: panels.curve, opened: () => this.curve.update(false) },
      { name: "tighten", label: "Tighten", panel: this.panels.tighten },
      { name: "variants", label: "Variants", panel: panels.variants, opened: () => this.variants.opened() },
      { name: "part", label: "Part", panel: this.panels.part },
      { name: "control", label: "Control", panel: this.panels.control },
      { name: "acceptance", label: "Test", panel: this.panels.acceptance },
    ]);
    const { stage } = this;
    if (stage)
      byId("poses").append(
        ...views(stage),
        button("PNG", () => download.canvas("machine", stage.picture), PICTURE),
        button("glTF", () => (stage.gltf ? save("machine.glb", stage.gltf) : undefined), {
          title: "Download the machine as it stands as glTF",
          id: "gltf",
        }),
      );
    panels.answers.append(make("p", { class: "files", id: "slide" }, "This screen: ", ...this.slide()));
    this.keep = button(store.verb, () => void this.save(), { class: "primary", id: "save" });
    byId("actions").append(
      this.units.select,
      ...this.choice(),
      ...(store.isReadOnly ? [] : [this.begin(), this.undo, this.redo, this.keep]),
    );
    if (store.isReadOnly) document.body.dataset["readOnly"] = "yes";
    if (store instanceof Report) this.report(store);
    followTheme(
      (dark) => [this.stage, this.beside].forEach((of) => of?.theme(dark)),
      (does, dark) => this.stage?.print(does ? PAPER : null, dark),
    );
    window.addEventListener("beforeunload", (event) => {
      if (this.isChanged && store.verb === "Save") event.preventDefault();
    });
  }

  async open(): Promise<void> {
    const { machine, text, work, part } = await this.store.open();
    this.part.begin(work, part);
    this.editor.open(text, this.nonce);
    this.units.take();
    this.session.take(this.tools.chosen);
    this.session.open(machine, text);
    this.whatif.follow();
    this.buttons();
  }

  /** A report begins with the options that it was written with. */
  private report(report: Report): void {
    this.session.settings = report.settings;
    this.part.stated = report.part;
    this.variants.begin(report.others, report.chosen);
    document.body.toggleAttribute("data-several", report.others.length > 0);
    if (this.tools.chosen && this.tools.chosen !== report.tool && report.isReadOnly) this.withoutTool(report.tool);
    if (!this.tools.chosen) this.tools.chosen = report.tool;
    byId("note").textContent = report.note;
    const below = button("Report ↓", () => byId("report").scrollIntoView(), {
      title: "Report for print, and appendices",
    });
    byId("actions").append(below);
  }

  /** Takes over what others write into the file while nothing is changed here, and looks again. */
  async follow(): Promise<void> {
    let seen = 0;
    for (;;) {
      await new Promise((resolve) => setTimeout(resolve, this.isLost ? LOOK_LOST : LOOK));
      const before = this.session.kept;
      const found = await this.store.follow?.().catch((failure: unknown) => this.lost(failure));
      if (!found) continue;
      if (this.isLost) this.found();
      // An answer from before the file was saved here says nothing of it.
      const isNews = found.text !== before && this.session.kept === before;
      if (found.text !== null && isNews && found.text !== this.theirs) this.takeOver(found.text);
      if (found.text === before && this.theirs !== null) this.agrees();
      if (found.changes !== seen) this.changes();
      seen = found.changes;
    }
  }

  /** A file that answers were computed from is another one. */
  private changes(): void {
    this.looks.forget();
    this.session.refresh();
  }

  private isLost = false;

  /** The program cannot be asked: nothing that is shown is known to be so still. */
  private lost(failure: unknown): null {
    this.isLost = true;
    this.problems.outdates("program", `${capital(said(failure))}. What is changed here stays, and is not saved.`);
    return null;
  }

  private found(): void {
    this.isLost = false;
    this.problems.clear("program");
    this.session.refresh();
  }

  /** The text of others that was told of last. */
  private theirs: string | null = null;

  /** Others wrote the file, and something is changed here. */
  private differs(words: string, theirs: string): void {
    this.theirs = theirs;
    const mine = () => this.editor.text;
    const take = () => {
      this.session.keep(theirs);
      this.problems.clear("save");
      this.editor.change(difference(mine(), theirs));
      this.buttons();
    };
    const over = () => {
      this.session.keep(theirs);
      this.problems.clear("save");
      this.changed(false);
    };
    this.problems.say("save", words, ...choices(this.session.machine, mine, theirs, take, over));
  }

  /** What others wrote is what the page has, or gone again. */
  private agrees(): void {
    this.theirs = null;
    this.problems.clear("save");
  }

  private takeOver(text: string): void {
    if (this.isChanged && this.editor.text !== text)
      return this.differs(
        "The file on the disk has changed since the page read it; what is changed here is not saved.",
        text,
      );
    this.session.keep(text);
    if (this.editor.text !== text) this.editor.change(difference(this.editor.text, text));
    else this.changed(false);
  }

  private take(tool: string): void {
    this.problems.clear("tool");
    move({ tool });
    this.session.take(tool);
    this.changed(false);
  }

  /** All is read in other units: what stands is said anew, and what panels hold is asked anew. */
  private reads(): void {
    this.deviation.update();
    this.session.refresh();
  }

  private readonly fails = (failure: unknown) => this.problems.outdates("figures", said(failure));

  private get isChanged(): boolean {
    return this.editor.text !== this.session.kept;
  }

  private changed(draft: boolean): void {
    if (!draft) this.units.take();
    this.session.change(this.editor.text, draft, this.whatif?.keepsChain);
    this.buttons();
  }

  private buttons(): void {
    this.undo.disabled = !this.editor.canUndo;
    this.redo.disabled = !this.editor.canRedo;
    this.keep.disabled = this.store.verb === "Save" && !this.isChanged;
    this.keep.textContent = this.store.verb + (this.isChanged ? " •" : "");
  }

  /** Keeps the text; one that no machine can be read from only when asked again. */
  private async save(): Promise<void> {
    const text = this.editor.text;
    const fault = text.trim() ? await this.session.fault(text) : "it is empty";
    if (!fault) return this.write(text);
    const stop = button("Do not save", () => (this.problems.clear("save"), this.editor.view.focus()));
    const go = button("Save it all the same", () => void this.write(text), { id: "save-anyway" });
    this.problems.say("save", `No machine can be read from this text: ${fault}.`, stop, go);
    stop.focus();
  }

  private async write(text: string): Promise<void> {
    try {
      await this.store.save(text, this.session.kept);
      this.session.keep(text);
      this.problems.clear("save");
      this.changed(false);
    } catch (failure) {
      const words = `Not saved: ${said(failure)}.`;
      if (failure instanceof Conflict && failure.theirs !== null) this.differs(words, failure.theirs);
      else this.problems.say("save", words);
    }
  }

  private show(state: State): void {
    if (this.isWithoutTool(state)) {
      this.withoutTool("");
      this.session.take("");
      return this.changed(false);
    }
    this.problems.clear("figures", "chain");
    if (state.stale) this.problems.outdates("file", refused(state, this.session.machine));
    else this.problems.clear("file");
    this.mark(state.diagnostics, state.effort.draft);
    if (state.now) this.picture(state.now, state);
    this.verdict.show(state);
    this.statistics.show(state);
    this.pareto.show(state);
    this.curve.show(state);
    this.reach.show(state, this.tools.chosen);
    this.tighten.show(state);
    this.variants.show(state);
    this.part.show(state);
    this.control.show(state);
    this.acceptance.show(state);
    this.panels.answers.classList.toggle("stale", !isSettled(state));
    if (!state.stale) void this.learn();
    if (isSettled(state)) void this.looks.follow(state.now.chain).catch(this.fails);
    document.body.dataset["state"] = state.effort.draft ? "draft" : "full";
    document.body.toggleAttribute("data-reduced", state.effort.isReduced);
  }

  private picture(now: Findings, { effort, stale }: State): void {
    const { chain } = now;
    if (!effort.draft || chain !== this.shown) this.takeChain(now, stale);
    this.whatif.know(now.numbers);
    if (!effort.draft) this.forms.follow(chain, now.words, now.sources);
    try {
      this.stage?.hold(effort.draft);
      this.stage?.show(chain, this.tools.chosen, this.sliders.pose);
      this.problems.clear("picture");
    } catch (failure) {
      this.problems.outdates("picture", `This machine cannot be drawn: ${said(failure)}.`);
    }
    this.deviation.follow(chain, this.sliders.pose, now.map?.from === "bounds");
    this.beside.follow(chain, this.tools.chosen, effort.draft);
  }

  /** True if the file has no tool of the name in the address. */
  private isWithoutTool({ stale, diagnostics }: State): boolean {
    return stale && this.tools.chosen !== "" && diagnostics.some(({ code }) => code === NO_TOOL);
  }

  /** Takes the first tool, or the one of a report, in place of one that is not there. */
  private withoutTool(instead: string): void {
    const name = this.tools.chosen;
    this.tools.chosen = instead;
    move({ tool: instead });
    this.problems.say(
      "tool",
      `There is no tool \`${name}\` here: ${instead ? `\`${instead}\`` : "the first one"} is taken.`,
    );
  }

  /** What a held slider that changes no chain leaves as it is. */
  private takeChain({ chain, words }: Findings, stale: boolean): void {
    this.shown = chain;
    byId("name").textContent = chain.machine;
    document.title = `${chain.machine} – abbe workbench`;
    if (!stale) this.chips.show(chain.chain);
    this.sliders.show(chain);
    this.tools.show(chain.tools.map((tool) => tool.name));
    this.cards.follow(chain, words);
  }

  /** Asks once what may stand in a machine file. */
  private async learn(): Promise<void> {
    if (this.schema) return;
    const [answer] = await this.session.ask(["schema"]).catch(() => []);
    this.schema = accepted<Schema>(answer);
  }

  private moved(pose: Pose, rests: boolean): void {
    this.stage?.hold(!rests);
    this.stage?.move(pose);
    this.beside.move(pose, rests);
    this.deviation.moved(pose, rests);
    this.curve.moved(pose, rests);
    this.pareto.moved(pose, rests);
  }

  /** Diagnostics in the editor and below it; while a slider is held those that stay move with the text. */
  private mark(found: Diagnostic[], isHeld: boolean): void {
    const known = JSON.stringify(found);
    if (isHeld && known === this.marked) return;
    this.marked = known;
    this.editor.write();
    showMarks(this.editor.view, this.session.machine, found);
    this.list(found);
  }

  /** Diagnostics below the editor; each leads to its place. */
  private list(found: Diagnostic[]): void {
    const entry = (diagnostic: Diagnostic) => {
      const at = diagnostic.places.find((of) => of.file === this.session.machine);
      const go = () => at && this.editor.reveal(placeRange(this.editor.view.state.doc, at)[0]);
      const line = at ? `line ${at.line}: ` : "";
      const [first, ...rest] = inWords(diagnostic, this.session.machine).split("\n");
      return make(
        "li",
        { class: diagnostic.severity },
        button(`${line}${first}`, go, { title: diagnostic.code }),
        ...rest.map((text) => make("p", {}, text)),
      );
    };
    byId("diagnostics").replaceChildren(...(found.length ? [make("ul", {}, ...found.map(entry))] : []));
  }

  private rebuild(edit: Change | Change[] | null): void {
    if (edit) this.editor.change(edit);
    else
      this.problems.say(
        "chain",
        "The file writes its chain as `branches`, or takes it from elsewhere: change it in the text.",
      );
  }

  /** Leads to the number of an error; one that a table gives has none in the file. */
  private find(error: string): void {
    const number = numbers(this.editor.view.state).find((of) => of.path.includes(error));
    if (number) return this.editor.reveal(number.from);
    const section = this.editor.text.search(/^(measured|tolerances|class):/m);
    if (section >= 0) this.editor.reveal(section);
  }

  /** Buttons that download the first screen. */
  private slide(): HTMLElement[] {
    const picture = () => {
      const canvas = this.stage?.picture;
      return slide(canvas ? { url: canvas.toDataURL(), width: canvas.width, height: canvas.height } : null);
    };
    const png = () => {
      const { svg, width, height } = picture();
      void download.png("review", svg, width, height);
    };
    const title = (as: string) => ({ title: `Download machine, verdict and answers as ${as}` });
    return [button("SVG", () => download.svg("review", picture().svg), title("SVG")), button("PNG", png, title("PNG"))];
  }

  /** The button that begins a machine by questions. */
  private begin(): HTMLElement {
    const take = (file: string) => this.editor.change(difference(this.editor.text, file));
    const failed = (failure: unknown) => this.problems.say("questions", `${capital(said(failure))}.`);
    const ask = () => showQuestions((answers) => this.session.dialogue(answers), take, failed);
    return button("New…", ask, { id: "new-machine", title: "A machine file by questions" });
  }

  /** The choice among several machine files. */
  private choice(): HTMLElement[] {
    const { store } = this;
    if (!store.choices || store.choices.length < 2) return [];
    const names = store.choices.map((name) => make("option", {}, name));
    const choice = make("select", { "aria-label": "Machine file", id: "example" }, ...names);
    choice.value = store.chosen ?? "";
    choice.addEventListener("change", () => {
      store.chosen = choice.value;
      move({ example: choice.value, pose: "", tool: "" });
      this.problems.clear("save", "tool");
      this.tools.chosen = store instanceof Report ? store.tool : "";
      if (store instanceof Report) this.variants.begin(store.others, store.chosen);
      void this.open();
    });
    return [choice];
  }
}

const said = (failure: unknown) => (failure instanceof Error ? failure.message : String(failure));

const capital = (words: string) => words.charAt(0).toUpperCase() + words.slice(1);

/** Why a text is refused, and of what the figures are. */
function refused({ diagnostics, now }: State, machine: string): string {
  const first = diagnostics.find(({ severity }) => severity === "refusal");
  const at = first?.places.find(({ file }) => file === machine);
  const why = first ? `${at ? `line ${at.line}: ` : ""}${first.message}` : "see the marks in the editor";
  return `The file is refused, ${why}.${now ? " Picture and figures are of the text before." : ""}`;
}

/** Returns the edit that makes one text another: what is the same at both ends stays. */
function difference(before: string, after: string): Change {
  const most = Math.min(before.length, after.length);
  let from = 0;
  while (from < most && before[from] === after[from]) from += 1;
  let same = 0;
  while (same < most - from && before.at(-1 - same) === after.at(-1 - same)) same += 1;
  return { from, to: before.length - same, insert: after.slice(from, after.length - same) };
}

/** While figures are computed a line below the head is coloured. */
function working(busy: boolean): void {
  if (busy) document.body.dataset["busy"] = "yes";
  else delete document.body.dataset["busy"];
}

/** The stage, or a sentence where the browser cannot draw it. */
function standing(dragged: (axis: Axis, position: number, rests: boolean) => void): Stage | null {
  try {
    return new Stage(byId("stage"), "legend", dragged);
  } catch {
    byId("stage").textContent = "This browser cannot draw in three dimensions (WebGL); everything else works.";
    return null;
  }
}

/** From where the machine is looked at, and the lengths of its arms. */
function views(stage: Stage): HTMLElement[] {
  const all: [View, string][] = [
    ["", "Fit"],
    ["front", "Front"],
    ["right", "Right"],
    ["top", "Top"],
  ];
  const views = all.map(([view, words]) =>
    button(words, () => stage.look(stage.pose, view), { id: `view-${view || "fit"}` }),
  );
  const arms = button("Arms", () => measure(place().arms === ""), { id: "arms", title: "Lengths of lever arms" });
  const measure = (does: boolean) => {
    move({ arms: does ? "yes" : "" });
    arms.setAttribute("aria-pressed", String(does));
    stage.measure(does);
  };
  measure(place().arms !== "");
  return [make("span", { class: "views", role: "group", "aria-label": "View" }, ...views), arms];
}

type Face = Evaluator & Store;

async function face(): Promise<Face> {
  const given = JSON.parse(byId("start").textContent ?? "{}") as { evaluator: string; zlib?: string };
  if (given.evaluator === "program") return new Program();
  if (given.evaluator === "playground") return Playground.load(place().example);
  const { place: at, ...report } = (await unpacked(given.zlib ?? "", "deflate").json()) as ReportStart;
  // The first look: the work and the control that the report was written with.
  const isFirst = Object.entries(place()).every(([name, value]) => !value || name === "units");
  if (isFirst) move({ work: at.work ?? "", target: at.target ?? "" });
  return new Report({ place: at, ...report }, place().example, (note) => (byId("note").textContent = note));
}

async function start(): Promise<void> {
  const found = await face();
  const workbench = new Workbench(found, found);
  await workbench.open();
  if (found.follow) await workbench.follow();
}

start().catch((failure: unknown) => {
  new Problems().outdates("start", `${capital(said(failure))}.`);
});
