/** Tabs: one of several panels is shown; the arrow keys go from tab to tab. */

import { move, place } from "./address";
import { button, make } from "./dom";

/** A panel with its name in the address and its label. */
export interface Tab {
  name: string;
  label: string;
  panel: HTMLElement;
  /** Hears that the panel is seen. */
  opened?: () => void;
}

export class Tabs {
  private readonly buttons: HTMLButtonElement[];

  constructor(
    parent: HTMLElement,
    label: string,
    private readonly tabs: Tab[],
  ) {
    this.buttons = tabs.map((tab) => this.button(tab));
    const list = make("div", { role: "tablist", "aria-label": label }, ...this.buttons);
    list.addEventListener("keydown", (event) => this.key(event));
    parent.append(list, ...tabs.map((tab) => tab.panel));
    this.open(tabs.find((tab) => tab.name === place().view)?.name ?? tabs[0]?.name ?? "");
  }

  open(name: string): void {
    this.tabs.forEach((tab, i) => {
      const isOpen = tab.name === name;
      tab.panel.hidden = !isOpen;
      this.buttons[i]?.setAttribute("aria-selected", String(isOpen));
      this.buttons[i]?.setAttribute("tabindex", isOpen ? "0" : "-1");
      if (isOpen) tab.opened?.();
    });
  }

  private button(tab: Tab): HTMLButtonElement {
    tab.panel.setAttribute("role", "tabpanel");
    tab.panel.setAttribute("aria-label", tab.label);
    tab.panel.id = `panel-${tab.name}`;
    return button(tab.label, () => this.choose(tab.name), {
      role: "tab",
      id: `tab-${tab.name}`,
      "aria-controls": tab.panel.id,
    });
  }

  choose(name: string): void {
    move({ view: name });
    this.open(name);
  }

  private key(event: KeyboardEvent): void {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!by) return;
    event.preventDefault();
    const at = this.buttons.indexOf(document.activeElement as HTMLButtonElement);
    const next = this.buttons[(at + by + this.buttons.length) % this.buttons.length];
    next?.click();
    next?.focus();
  }
}
