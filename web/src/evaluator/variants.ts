/** The variants of the engine, and what this browser can run. */

export type Variant = "relaxed" | "plain";

/** A module with one instruction of relaxed SIMD: `f64x2.relaxed_madd` of three zeros. */
const RELAXED = [
  ...[0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 19, 1, 17, 0],
  ...[65, 0, 253, 17, 65, 0, 253, 17, 65, 0, 253, 17, 253, 135, 2, 11],
];

/** Returns the variants that can run here, the fastest first. Whether relaxed SIMD fuses, the engine finds out. */
export function variants(): Variant[] {
  return WebAssembly.validate(new Uint8Array(RELAXED)) ? ["relaxed", "plain"] : ["plain"];
}
