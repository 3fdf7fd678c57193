/** Light or dark, as the reader's system says. */

/** `printed` hears before the page is printed, which is always light, and afterwards. */
export function followTheme(changed: (dark: boolean) => void, printed: (does: boolean, dark: boolean) => void): void {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const tell = () => changed(dark.matches);
  dark.addEventListener("change", tell);
  tell();
  window.addEventListener("beforeprint", () => printed(true, false));
  window.addEventListener("afterprint", () => printed(false, dark.matches));
}
