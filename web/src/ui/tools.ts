/** The tool in use, of a machine that has several. */

import { place } from "./address";
import { make } from "./dom";

export class ToolChoice {
  chosen = place().tool;
  private readonly select = make("select", { id: "tool" });
  private readonly row = make("label", { for: "tool" }, "Tool ", this.select);

  constructor(parent: HTMLElement, take: (tool: string) => void) {
    parent.append(this.row);
    this.row.hidden = true;
    this.select.addEventListener("change", () => take((this.chosen = this.select.value)));
  }

  show(names: string[]): void {
    this.row.hidden = names.length < 2;
    this.select.replaceChildren(...names.map((name) => make("option", {}, name)));
    this.select.value = names.includes(this.chosen) ? this.chosen : (names[0] ?? "");
  }
}
