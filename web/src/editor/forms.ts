/** Axes, bounds and the job as forms beside the text: each field is a value of the file, and a change touches its own
 * lines only. The program says what is wrong, at its place in the text. */

import type { Axis, Chain, Sources } from "../evaluator/types";
import { button, make } from "../ui/dom";
import type { Change } from "./chain";
import type { Editor } from "./editor";
import { keysBelow, put, read, taken } from "./put";

/** Fields of an axis: key, label, and an example. */
const AXIS: [string, string, string][] = [
  ["travel", "Travel", "[0 mm, 500 mm], or continuous"],
  ["origin", "A point of it, mm", "[250, 225, -350]"],
  ["direction", "Direction", "by its letter"],
  ["controller", "In the control", "by its name"],
];

/** Fields of a job. */
const JOB: [string[], string, string][] = [
  [["job", "tool_poses"], "File of tool poses", "work.csv"],
  [["job", "limit"], "Limit", "30 um"],
  [["job", "reference"], "Reference", "zero"],
  [["job", "path"], "One continuous path", "true"],
  [["job", "tool"], "Tool", "the first"],
  [["job", "place", "origin"], "Place of the part, mm", "[0, 0, 0]"],
  [["job", "place", "rotation"], "Turned about X, Y, Z, deg", "[0, 0, 0]"],
];

/** Bounds that are named by a pair of axes. */
const PAIR = /^([^-\s]+)-([^-\s]+)$/;

export class Forms {
  private readonly panel = make("details", { id: "forms" }, make("summary", {}, "Forms: axes, bounds, job"));
  private readonly body = make("div", { class: "forms" });
  private chain: Chain | null = null;
  private words: Record<string, string> = {};
  /** Errors that have a value already. */
  private valued: string[] = [];
  /** What the fields were made of. */
  private made = "";

  constructor(
    parent: HTMLElement,
    private readonly editor: Editor,
  ) {
    this.panel.append(this.body);
    this.panel.addEventListener("toggle", () => this.update());
    parent.append(this.panel);
  }

  /** Takes the machine of the text as it is now; `words` are those of its errors. */
  follow(chain: Chain, words: Record<string, string>, sources: Sources | null): void {
    [this.chain, this.words] = [chain, words];
    this.valued = (sources?.errors ?? []).map(({ error }) => error);
    this.update();
  }

  private get state() {
    return this.editor.view.state;
  }

  private update(): void {
    const { chain, state } = this;
    if (!chain || !this.panel.open) return;
    const axes = chain.axes.map(({ name, kind, side }) => [name, kind, side]);
    const bounds = keysBelow(state, ["tolerances"]);
    const made = JSON.stringify([axes, bounds, this.words, [...this.valued].sort()]);
    // Fields that stay keep the cursor, and take what the text says.
    if (made === this.made) return this.refill();
    this.made = made;
    const { id } = document.activeElement ?? { id: "" };
    const job = JOB.map(([keys, label, example]) => this.field(keys, label, example));
    this.body.replaceChildren(
      ...[make("h3", {}, "Axes"), ...chain.axes.map((axis) => this.axis(axis))],
      ...[make("h3", {}, "Bounds"), ...bounds.map((name) => this.bound(name)), ...this.another(bounds)],
      ...[make("h3", {}, "Job"), make("fieldset", { id: "form-job" }, ...job)],
    );
    // The fields that go take the focus with them.
    if (id) document.getElementById(id)?.focus();
  }

  private axis(axis: Axis): HTMLElement {
    const side = axis.side === "workpiece" ? "carries the part" : "carries the tool";
    const legend = make("legend", {}, `${axis.name}, ${axis.kind}, ${side}`);
    const fields = AXIS.map(([key, label, example]) => this.field(["axes", axis.name, key], label, example));
    return make("fieldset", { "data-axis-form": axis.name }, legend, ...fields);
  }

  /** A bound: its words where it is an error, and a button that takes it away. */
  private bound(name: string): HTMLElement {
    const keys = ["tolerances", name];
    const [, first, second] = PAIR.exec(name) ?? [];
    const words = first ? `squareness of ${first} and ${second}` : this.inWords(name);
    const row = this.field(keys, words ? `${name}: ${words}` : name, "12 um, or 20 urad");
    const gone = () => this.change(taken(this.state, keys));
    const label = { "aria-label": `Remove the bound ${name}` };
    const remove = button("Remove", gone, label);
    remove.disabled = this.editor.isReadOnly;
    return make("div", { class: "bound" }, row, remove);
  }

  /** An error that gets a bound. */
  private another(bounds: string[]): HTMLElement[] {
    const free = Object.keys(this.words).filter((name) => !bounds.includes(name) && !this.valued.includes(name));
    if (this.editor.isReadOnly || !free.length) return [];
    const choice = make(
      "select",
      { id: "bound-error", "aria-label": "Error that gets a bound" },
      ...free.map((name) => make("option", { value: name }, `${name}: ${this.inWords(name)}`)),
    );
    const value = make("input", {
      type: "text",
      id: "bound-value",
      placeholder: "12 um, or 20 urad",
      "aria-label": "Its bound",
    });
    const add = () => {
      if (value.value.trim()) this.change(put(this.state, ["tolerances", choice.value], value.value.trim()));
    };
    return [make("p", { class: "add" }, choice, value, button("Add a bound", add, { id: "bound-add" }))];
  }

  private inWords(name: string): string {
    return (this.words[name] ?? "").replace(/\.$/, "");
  }

  private field(keys: string[], label: string, example: string): HTMLElement {
    const id = `form-${keys.join("-")}`;
    const input = make("input", { type: "text", id, placeholder: example, spellcheck: "false", autocomplete: "off" });
    input.dataset["keys"] = JSON.stringify(keys);
    this.fill(input, keys);
    input.addEventListener("change", () => {
      const text = input.value.trim();
      this.change(text ? put(this.state, keys, text) : taken(this.state, keys));
    });
    return make("label", {}, make("span", {}, label), input);
  }

  /** What the file itself says; what stands in braces or over lines is changed in the text. */
  private fill(input: HTMLInputElement, keys: string[]): void {
    const there = read(this.state, keys);
    const isLong = there?.isLong ?? false;
    input.value = isLong ? "in the text" : (there?.text ?? "");
    input.disabled = isLong || this.editor.isReadOnly;
    input.title = isLong ? "It has entries of its own: change it in the text" : "";
  }

  private refill(): void {
    for (const input of this.body.querySelectorAll<HTMLInputElement>("input[data-keys]"))
      if (input !== document.activeElement) this.fill(input, JSON.parse(input.dataset["keys"] ?? "[]") as string[]);
  }

  private change(edits: Change[]): void {
    if (edits.length) this.editor.change(edits);
  }
}
