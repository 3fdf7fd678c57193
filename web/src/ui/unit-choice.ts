/** The choice of units: kept in the address, and told to the report below, which the program wrote in um and urad. */

import { both, CHOICES, follow } from "../units";
import { move, place } from "./address";
import { make } from "./dom";

export class UnitChoice {
  readonly select = make(
    "select",
    { id: "units", "aria-label": "Units" },
    make("option", { value: "" }, "Units of the file"),
    ...CHOICES.map(([value, words]) => make("option", { value }, words)),
  );

  /** `turned` hears that all that is shown is read in other units. */
  constructor(
    private readonly text: () => string,
    turned: () => void,
  ) {
    this.select.value = place().units;
    this.select.addEventListener("change", () => {
      move({ units: this.select.value });
      if (this.take()) turned();
    });
  }

  /** Takes the units of the address, or of the text; true if they are others. */
  take(): boolean {
    const before = document.body.dataset["units"];
    follow(this.text());
    const units = JSON.stringify(both());
    document.body.dataset["units"] = units;
    return before !== units;
  }
}
