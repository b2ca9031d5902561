// SPDX-License-Identifier: BSD-3-Clause
// Colors of charts, which follow the reader's light or dark screen; paper is light.

const LIGHT = { ink: "#1c2430", faint: "#5b6470", grid: "#e3e6ea", paper: "#ffffff" };
const DARK = { ink: "#e5e7eb", faint: "#9aa4b2", grid: "#313a47", paper: "#1a2029" };

export type Theme = typeof LIGHT;
export const theme: Theme = { ...LIGHT };

const dark = typeof matchMedia === "undefined" ? null : matchMedia("(prefers-color-scheme: dark)");

/** Calls `redraw` whenever the colors have changed. */
export function followTheme(redraw: () => void) {
  const set = (colors: Theme) => {
    Object.assign(theme, colors);
    redraw();
  };
  Object.assign(theme, dark?.matches ? DARK : LIGHT);
  dark?.addEventListener("change", () => set(dark.matches ? DARK : LIGHT));
  window.addEventListener("beforeprint", () => set(LIGHT));
  window.addEventListener("afterprint", () => set(dark?.matches ? DARK : LIGHT));
}
