/** The chain as chips: an axis is dragged, or moved by the arrow keys, to another place or across the bed; a list
 * behind them adds and removes axes. */

import { STANDARD, nameOf } from "../editor/axes";
import { isAxis, moved, words } from "../editor/chain";
import { make } from "./dom";

const NAMES: Record<string, string> = { w: "workpiece", b: "bed", t: "tool" };

/** What is wished of the chain. */
export interface ChainWishes {
  /** Takes the words of a new chain. */
  move(list: string[]): void;
  add(list: string[], axis: string): void;
  remove(list: string[], axis: string): void;
}

export class Chips {
  private list: string[] = [];
  private held: { from: number; to: number } | null = null;
  private focused: string | null = null;

  constructor(
    private readonly parent: HTMLElement,
    private readonly wishes: ChainWishes,
  ) {}

  show(chain: string): void {
    if (this.held) return;
    this.list = words(chain);
    // The chips that go take the focus with them.
    const { focused } = this;
    this.parent.replaceChildren(...this.list.map((word, i) => this.chip(word, i)), this.choice());
    this.focused = focused;
    if (focused !== null)
      this.chips()
        .find((chip) => chip.dataset["axis"] === focused)
        ?.focus();
  }

  private chips(): HTMLElement[] {
    return [...this.parent.querySelectorAll<HTMLElement>(".chip")];
  }

  private choice(): HTMLElement {
    const own = this.list.filter(isAxis).map(nameOf);
    const free = Object.entries(STANDARD).filter(([name]) => !own.includes(name));
    const choice = make(
      "select",
      { class: "axes-choice", "aria-label": "Add or remove an axis", title: "Add or remove an axis" },
      make("option", { value: "" }, "Add or remove…"),
      make(
        "optgroup",
        { label: "Add, next to the tool" },
        ...free.map(([name, kind]) => make("option", { value: `+${name}` }, `${name}, ${kind}`)),
      ),
      make(
        "optgroup",
        { label: "Remove, with its errors" },
        ...own.map((name) => make("option", { value: `-${name}` }, name)),
      ),
    );
    choice.addEventListener("change", () => {
      const { value } = choice;
      choice.value = "";
      if (value.startsWith("+")) this.wishes.add(this.list, value.slice(1));
      if (value.startsWith("-")) this.wishes.remove(this.list, value.slice(1));
    });
    return choice;
  }

  private chip(word: string, i: number): HTMLElement {
    if (!isAxis(word)) return make("span", { class: `chip fixed ${word === "b" ? "bed" : ""}` }, NAMES[word] ?? word);
    const axis = nameOf(word);
    const side = word.endsWith("'") ? "carries the workpiece" : "carries the tool";
    const label = `${axis}, ${side}; move it with the arrow keys or drag it`;
    const chip = make(
      "button",
      {
        type: "button",
        class: `chip axis ${word.endsWith("'") ? "work" : "tool"}`,
        title: label,
        "aria-label": label,
        "data-axis": axis,
      },
      word,
    );
    chip.addEventListener("keydown", (event) => this.key(event, i, axis));
    chip.addEventListener("pointerdown", (event) => this.grab(event, chip, i));
    chip.addEventListener("blur", () => (this.focused = null));
    return chip;
  }

  private key(event: KeyboardEvent, i: number, axis: string): void {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!by) return;
    event.preventDefault();
    this.focused = axis;
    this.place(i, i + by);
  }

  private place(from: number, to: number): void {
    const next = moved(this.list, from, to);
    if (next !== this.list && next.join(" ") !== this.list.join(" ")) this.wishes.move(next);
  }

  private grab(event: PointerEvent, chip: HTMLElement, from: number): void {
    if (event.button !== 0) return;
    this.held = { from, to: from };
    chip.setPointerCapture(event.pointerId);
    chip.classList.add("held");
    const start = event.clientX;
    const drag = (at: PointerEvent) => {
      chip.style.transform = `translateX(${at.clientX - start}px)`;
      if (this.held) this.held.to = this.over(at.clientX, from);
      this.parent.dataset["to"] = String(this.held?.to ?? from);
    };
    const drop = () => {
      chip.removeEventListener("pointermove", drag);
      const to = this.held?.to ?? from;
      this.held = null;
      this.show(this.list.join(" "));
      this.place(from, to);
    };
    chip.addEventListener("pointermove", drag);
    chip.addEventListener("pointerup", drop, { once: true });
    chip.addEventListener("pointercancel", drop, { once: true });
  }

  /** Index at which a chip would stand that is let go here. */
  private over(x: number, from: number): number {
    const middles = this.chips().map(
      (chip) =>
        chip.offsetLeft + chip.offsetWidth / 2 + this.parent.getBoundingClientRect().left - this.parent.offsetLeft,
    );
    return middles.filter((middle, i) => i !== from && middle < x).length;
  }
}
