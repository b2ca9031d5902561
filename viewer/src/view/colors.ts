// SPDX-License-Identifier: BSD-3-Clause
// Colors of values: the lightness of the ramps increases, so that they are readable in grayscale
// print and with color blindness.

export type Rgb = [number, number, number];

/** Dark blue to yellow; red beyond the end. */
const DISTANCE_RAMP: Rgb[] = [
  [0, 34, 78],
  [55, 83, 130],
  [110, 125, 125],
  [180, 165, 90],
  [254, 226, 52],
];
const VALUE_RAMP: Rgb[] = [
  [62, 20, 92],
  [62, 72, 140],
  [42, 118, 142],
  [48, 163, 120],
  [140, 200, 70],
  [238, 226, 60],
];
export const OUTLIER: Rgb = [214, 32, 39];
export const TRUTH = "#4b5563";
/**
 * One color per run, the same in every chart and view; distinguishable with color blindness, too.
 */
export const RUN_COLORS = [
  "#2b6cb0",
  "#c2410c",
  "#4d7c0f",
  "#7c3aed",
  "#0f766e",
  "#be185d",
  "#a16207",
  "#334155",
  "#0891b2",
  "#f59e0b",
  "#65a30d",
  "#94a3b8",
];

export function rampOf(name: string): Rgb[] {
  return name === "distance" ? DISTANCE_RAMP : VALUE_RAMP;
}

/** The ramp's color at `s` of 0 ... 1. */
export function rampColor(ramp: Rgb[], s: number): Rgb {
  const position = Math.min(Math.max(s, 0), 1) * (ramp.length - 1);
  const low = Math.min(Math.floor(position), ramp.length - 2);
  const t = position - low;
  return ramp[low].map((c, i) => Math.round((1 - t) * c + t * ramp[low + 1][i])) as Rgb;
}

/** 256 RGBA texels. */
export function rampTexels(ramp: Rgb[]): Uint8Array {
  const texels = new Uint8Array(256 * 4);
  for (let i = 0; i < 256; ++i) texels.set([...rampColor(ramp, i / 255), 255], 4 * i);
  return texels;
}

export function cssGradient(ramp: Rgb[]): string {
  return `linear-gradient(90deg,${ramp.map((c) => `rgb(${c.join(",")})`).join(",")})`;
}
