/** Units of the reader: figures of the program, um and urad, as they are read. */

import assert from "node:assert/strict";
import { test } from "node:test";
import * as units from "../src/units";

/** Reads a text with an address. */
function read(text: string, hash = ""): void {
  Object.assign(globalThis, { location: { hash } });
  units.follow(text);
}

test("figures are read in the units of the file unless the address names others", () => {
  read("errors: { EXX: 4 um, EC0Y: 8 arcsec, EA0Z: 12 urad, EB0C: 3arcsec }");
  assert.equal(units.quantity(25.4), "25.4 µm");
  assert.equal(units.quantity(4.84813681109536, "urad"), "1.00 arcsec");
  read("errors: { EXX: 4 um, EC0Y: 8 urad }  # 100 arcsec/mm is none");
  assert.equal(units.quantity(4.84813681109536, "urad"), "4.85 µrad");
  read("axes: { X: { travel: [0 in, 20 in] } }");
  assert.equal(units.quantity(25.4), "1000 µin");
  read("axes: { X: { travel: [0 in, 20 in] } }", "#units=um-urad");
  assert.equal(units.quantity(25.4), "25.4 µm");
});

test("conversions are exact, and what is typed comes back", () => {
  read("", "#units=uin-arcsec");
  // An inch is 25.4 mm; a turn has 1296000 arcsec.
  assert.equal(units.inReaders(0.0254, "µm"), 1);
  assert.ok(Math.abs(units.inReaders(2e6 * Math.PI, "urad") - 1296000) < 1e-6);
  assert.equal(units.inReaders(7, "mm"), 7);
  for (const typed of ["600", "0.1", "1234.5678", ""]) assert.equal(units.toField(units.fromField(typed)), typed);
  assert.equal(units.fromField("600"), "15.24");
  assert.equal(units.between([2.54, 25.4]), "100 to 1000 µin");
  assert.equal(units.bound(5, "um"), "196.9 µin");
});

test("sentences of the program are read in the same units, ratios stay", () => {
  read("", "#units=uin-arcsec");
  assert.equal(
    units.said("limit 25.4 um: 12.7 to 50.8 µm, 4.848136811 urad"),
    "limit 1000 µin: 500 to 2000 µin, 1 arcsec",
  );
  assert.equal(units.said("X short by 3 mm, 12 um/m, -2.54 um"), "X short by 3 mm, 12 um/m, −100 µin");
  read("");
  assert.equal(units.said("limit 25.4 um"), "limit 25.4 µm");
});

test("positions, scale and their sentences are in inches beside micro-inch, else in mm", () => {
  read("", "#units=uin-arcsec");
  // An inch is 25.4 mm; two decimals more than in mm.
  assert.equal(units.position(-254, "mm"), "−10 in");
  assert.equal(units.position(100, "mm"), "3.937 in");
  assert.equal(units.position(-12.34, "deg"), "−12.3 °");
  assert.deepEqual(units.roundLength(700), { mm: 508, words: "20 in" });
  assert.equal(units.positions("Z short by up to 254 mm below -508 mm"), "Z short by up to 10 in below −20 in");
  read("", "#units=um-urad");
  assert.equal(units.position(100.04, "mm"), "100 mm");
  assert.deepEqual(units.roundLength(700), { mm: 500, words: "500 mm" });
  assert.equal(units.positions("by 177.15 mm"), "by 177.15 mm");
});
