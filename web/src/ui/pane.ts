/** The pane of the editor: it folds to a bar, wraps its lines, and is as wide as its edge is dragged. */

import { move, place } from "./address";
import { button, make } from "./dom";

/** Width in pixels: the least, and a step of an arrow key. */
const [LEAST, STEP] = [220, 40];

export class Pane {
  private readonly fold = button("‹ Fold", () => this.turn("folded"), { id: "fold-editor" });
  private readonly wrap = button("Wrap lines", () => this.turn("wrapped"), { id: "wrap-editor" });
  private readonly edge = make("div", {
    id: "editor-edge",
    role: "separator",
    tabindex: "0",
    "aria-orientation": "vertical",
    "aria-label": "Width of the editor",
  });
  private readonly is = { folded: false, wrapped: false };
  private width = 0;

  constructor(
    private readonly pane: HTMLElement,
    private readonly wraps: (does: boolean) => void,
  ) {
    const words = place().pane.split(",");
    this.is = { folded: words.includes("folded"), wrapped: words.includes("wrapped") };
    this.width = Number(words.find((word) => /^\d+$/.test(word)) ?? 0);
    pane.prepend(make("p", { class: "pane-bar" }, this.fold, this.wrap));
    pane.append(this.edge);
    this.edge.addEventListener("pointerdown", (event) => this.edge.setPointerCapture(event.pointerId));
    this.edge.addEventListener("pointermove", (event) => {
      if (this.edge.hasPointerCapture(event.pointerId)) this.widen(event.clientX - pane.getBoundingClientRect().left);
    });
    this.edge.addEventListener("pointerup", () => this.keep());
    this.edge.addEventListener("keydown", ({ key }) => {
      const by = { ArrowLeft: -STEP, ArrowRight: STEP }[key];
      if (by) this.widen(pane.getBoundingClientRect().width + by);
      if (by) this.keep();
    });
    this.show();
  }

  private turn(what: "folded" | "wrapped"): void {
    this.is[what] = !this.is[what];
    this.keep();
  }

  private widen(pixels: number): void {
    this.width = Math.round(Math.min(Math.max(pixels, LEAST), 0.7 * innerWidth));
    this.show();
  }

  private keep(): void {
    const { folded, wrapped } = this.is;
    const words = [folded ? "folded" : "", wrapped ? "wrapped" : "", this.width ? String(this.width) : ""];
    move({ pane: words.filter(Boolean).join(",") });
    this.show();
  }

  private show(): void {
    const { folded, wrapped } = this.is;
    document.body.toggleAttribute("data-folded", folded);
    this.fold.textContent = folded ? "›" : "‹ Fold";
    this.fold.setAttribute("aria-label", folded ? "Show the machine file" : "Fold the machine file");
    this.fold.setAttribute("aria-expanded", String(!folded));
    this.wrap.setAttribute("aria-pressed", String(wrapped));
    const main = this.pane.parentElement;
    if (this.width) main?.style.setProperty("--file", `${this.width}px`);
    this.edge.setAttribute("aria-valuenow", String(this.width || Math.round(this.pane.getBoundingClientRect().width)));
    this.wraps(wrapped);
  }
}
