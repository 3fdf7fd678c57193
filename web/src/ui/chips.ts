/** The chain as chips: an axis is dragged, or moved by the arrow keys, to another place or across the bed. */

import { isAxis, moved, words } from "../editor/chain";
import { make } from "./dom";

const NAMES: Record<string, string> = { w: "workpiece", b: "bed", t: "tool" };

export class Chips {
  private list: string[] = [];
  private held: { from: number; to: number } | null = null;
  private focused: string | null = null;

  /** `write` takes the words of a new chain. */
  constructor(
    private readonly parent: HTMLElement,
    private readonly write: (list: string[]) => void,
  ) {}

  show(chain: string): void {
    if (this.held) return;
    this.list = words(chain);
    this.parent.replaceChildren(...this.list.map((word, i) => this.chip(word, i)));
    if (this.focused !== null)
      this.chips()
        .find((chip) => chip.dataset["axis"] === this.focused)
        ?.focus();
  }

  private chips(): HTMLElement[] {
    return [...this.parent.children] as HTMLElement[];
  }

  private chip(word: string, i: number): HTMLElement {
    if (!isAxis(word)) return make("span", { class: `chip fixed ${word === "b" ? "bed" : ""}` }, NAMES[word] ?? word);
    const axis = word.replace(/'$/, "");
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
    if (next !== this.list && next.join(" ") !== this.list.join(" ")) this.write(next);
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
