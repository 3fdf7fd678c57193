/** Light or dark, as the reader's system says. */

export function followTheme(changed: (dark: boolean) => void): void {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const tell = () => changed(dark.matches);
  dark.addEventListener("change", tell);
  tell();
}
