// SPDX-License-Identifier: BSD-3-Clause
// The user's settings, kept in the address after "#", so that a link shows the same picture.
import { COLOR_BY, type ColorBy } from "./point_material";
import type { SceneHeader, Vec3 } from "./scene";
import { SURFACE_LOOKS, type SurfaceLook } from "./surface";
import type { Standpoint } from "./view";

export interface State {
  color: ColorBy;
  range: [number, number] | null; // null: the default range of the color
  outliers: boolean;
  surface: SurfaceLook;
  split: boolean;
  view: Standpoint;
  size: number; // of points, px
  budget: number | null; // points drawn at most; null: the View's default
  t: number | null; // null: the end
  window: number | null; // s before t that are shown; null: all
  cut: [Vec3, Vec3] | null;
  dark: boolean;
}

export function hasField(header: SceneHeader, name: string): boolean {
  return header.clouds.some((cloud) => cloud.fields.some((field) => field.name === name));
}

/** The color modes that the scene has data for. */
export function colorsOf(header: SceneHeader): ColorBy[] {
  const always: ColorBy[] = ["height", "solid"];
  const byField = COLOR_BY.filter((by) => hasField(header, by));
  const byPath: ColorBy[] = header.paths.some((path) => path.has_error) && !byField.includes("distance") ? ["distance"] : [];
  return [...byField, ...byPath, ...always];
}

/** The default range of values of a color mode. */
export function usualRange(header: SceneHeader, by: ColorBy): [number, number] {
  if (by === "distance") return [0, header.outlier_m];
  if (by === "height") return [header.bounds[0][2], header.bounds[1][2]];
  const fields = header.clouds.flatMap((cloud) => cloud.fields.filter((field) => field.name === by));
  if (fields.length === 0) return [0, 1];
  return [Math.min(...fields.map((f) => f.min)), Math.max(...fields.map((f) => f.max))];
}

export function initialState(header: SceneHeader): State {
  const t = header.window_s !== null && header.time ? header.time[0] + header.window_s : null;
  return {
    color: colorsOf(header)[0],
    range: null,
    outliers: false,
    surface: "see-through",
    split: false,
    view: "oblique",
    size: 2,
    budget: null,
    t,
    window: header.window_s,
    cut: null,
    dark: false,
  };
}

const numbers = (text: string) => text.split(",").map(Number);

/** Overrides `state` by the settings after "#"; ignores unknown keys and invalid values. */
export function readHash(state: State, hash: string): State {
  const given = new URLSearchParams(hash.replace(/^#/, ""));
  const next = { ...state };
  const number = (key: string) => {
    const value = given.has(key) ? Number(given.get(key)) : NaN;
    return Number.isFinite(value) ? value : null;
  };
  const color = given.get("color") as ColorBy;
  if (COLOR_BY.includes(color)) next.color = color;
  const surface = given.get("surface") as SurfaceLook;
  if (SURFACE_LOOKS.includes(surface)) next.surface = surface;
  const view = given.get("view") as Standpoint;
  if (["top", "side", "front", "oblique"].includes(view)) next.view = view;
  for (const key of ["outliers", "split", "dark"] as const) {
    if (given.has(key)) next[key] = given.get(key) === "1";
  }
  next.size = number("size") ?? next.size;
  for (const key of ["budget", "t", "window"] as const) next[key] = number(key) ?? next[key];
  const range = numbers(given.get("range") ?? "");
  if (range.length === 2 && range.every(Number.isFinite)) next.range = range as [number, number];
  const cut = numbers(given.get("cut") ?? "");
  if (cut.length === 6 && cut.every(Number.isFinite)) next.cut = [cut.slice(0, 3) as Vec3, cut.slice(3) as Vec3];
  return next;
}

/** The inverse of readHash: the settings that differ from `initial`. */
export function writeHash(state: State, initial: State): string {
  const out = new URLSearchParams();
  for (const key of Object.keys(initial) as (keyof State)[]) {
    const value = state[key];
    if (JSON.stringify(value) === JSON.stringify(initial[key]) || value === null) continue;
    out.set(key, typeof value === "boolean" ? (value ? "1" : "0") : String(value));
  }
  return out.toString().replace(/%2C/g, ",");
}
