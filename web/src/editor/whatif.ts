/** What if: a slider for the number at the cursor, and for every error and tolerance of the file. */

import type { Editor } from "./editor";
import type { ErrorNumber } from "../evaluator/types";
import { inherited, type Inherited, override } from "./override";
import { type FileNumber, numberAt, numbers, range } from "./numbers";
import { make } from "../ui/dom";
import { nameOf } from "./names";
import { Text } from "@codemirror/state";

/** Sections of a file whose numbers have a slider in the list, in the order of the list. */
const LISTED = ["errors", "tolerances", "tool", "tools"];

export class WhatIf {
  private readonly row = make("div", { class: "slider-row" });
  private readonly input = make("input", { type: "range", id: "number" });
  private readonly label = make("label", { for: "number" });
  private readonly output = make("output", { for: "number" });
  private readonly choice = make("select", { "aria-label": "Number of the file" });
  private chosen: FileNumber | null = null;
  private held = false;
  private listed: FileNumber[] = [];
  private doc: Text = Text.empty;
  /** Numbers that another file gives. */
  private elsewhere: Inherited[] = [];
  private known: Record<string, ErrorNumber> = {};

  constructor(
    parent: HTMLElement,
    private readonly editor: Editor,
  ) {
    this.row.append(this.choice, this.output, this.input);
    parent.append(make("h2", {}, "What if"), this.label, this.row);
    this.input.addEventListener("input", () => this.drag());
    this.input.addEventListener("change", () => this.drop());
    this.choice.addEventListener("change", () => this.choose());
    this.follow();
  }

  /** True if the number is the size of an error or of a bound, and nothing of the chain. */
  get keepsChain(): boolean {
    return ["errors", "tolerances"].includes(this.chosen?.path[0] ?? "");
  }

  /** The cursor or the text has moved. */
  follow(): void {
    if (this.held) return;
    const { state } = this.editor.view;
    if (!this.doc.eq(state.doc)) this.list();
    this.doc = state.doc;
    const here = numberAt(state, state.selection.main.head);
    this.take(here ?? this.again() ?? this.listed[0] ?? null);
  }

  /** The number that was chosen before, where it stands now. */
  private again(): FileNumber | undefined {
    const key = this.chosen && nameOf(this.chosen);
    return numbers(this.editor.view.state).find((number) => nameOf(number) === key);
  }

  /** The machine has these errors, wherever they stand. */
  know(known: Record<string, ErrorNumber>): void {
    if (JSON.stringify(known) === JSON.stringify(this.known)) return;
    this.known = known;
    this.list();
    if (this.chosen) this.choice.value = nameOf(this.chosen);
    else this.follow();
  }

  private list(): void {
    const all = numbers(this.editor.view.state);
    this.elsewhere = inherited(this.editor.view.state, this.known);
    this.listed = LISTED.flatMap((section) => all.filter((number) => number.path[0] === section));
    this.choice.replaceChildren(
      ...this.listed.map((number) => make("option", { value: nameOf(number) }, nameOf(number))),
      ...(this.elsewhere.length ? [this.group()] : []),
    );
  }

  /** Numbers of other files: the one that is chosen becomes an entry of this file. */
  private group(): HTMLElement {
    const entry = ({ error, text }: Inherited) => make("option", { value: `override ${error}` }, `${error}: ${text}`);
    return make("optgroup", { label: "Given elsewhere: write into this file" }, ...this.elsewhere.map(entry));
  }

  private take(number: FileNumber | null): void {
    this.chosen = number;
    this.row.hidden = number === null;
    if (!number) return void (this.label.textContent = "No error, tolerance or tool of this file is a number.");
    const { min, max, step } = range(number);
    Object.assign(this.input, { min: String(min), max: String(max), step: String(step) });
    this.input.value = String(number.value);
    const name = nameOf(number);
    this.choice.value = name;
    const known = this.choice.value === name;
    if (!known) this.choice.prepend(make("option", { value: name, selected: "" }, name));
    this.label.textContent = "Number at the cursor, or one of the list:";
    this.shown(number.value, number);
  }

  private shown(value: number, number: FileNumber): void {
    const text = `${Number(value.toFixed(range(number).decimals))} ${number.unit}`.trim();
    this.output.textContent = text.replace("-", "−");
    this.input.setAttribute("aria-valuetext", `${nameOf(number)} ${text}`);
  }

  private choose(): void {
    const from = this.elsewhere.find(({ error }) => this.choice.value === `override ${error}`);
    if (from) this.editor.change(override(this.editor.view.state, from));
    const wanted = from ? `${from.section} › ${from.error}` : this.choice.value;
    const number = numbers(this.editor.view.state).find((of) => nameOf(of) === wanted);
    if (!number) return;
    this.chosen = number;
    this.editor.view.dispatch({ selection: { anchor: number.from }, scrollIntoView: true });
  }

  private drag(): void {
    if (!this.chosen) return;
    this.held = true;
    const value = Number(this.input.value);
    this.editor.drag(this.chosen, value, range(this.chosen).decimals);
    this.shown(value, this.chosen);
  }

  private drop(): void {
    this.held = false;
    this.editor.drop();
    this.follow();
  }
}
