// SPDX-License-Identifier: BSD-3-Clause
// The data of the page, written by lidarena/report/report_data.cpp, and what is computed from it.
import type { FigureInfo, ReportData, Run } from "./page";

export type * from "./page";

/** Keys of the figures that the page names. */
export const DRIFT = "rpe_1m_at_poses_translation";
export const MAP_RMSE = "reprojected_map_rmse";
export const OUTLIERS = "reprojected_map_outliers";
export const OWN_RMSE = "own_map_rmse";
export const OWN_OUTLIERS = "own_map_outliers";
export const LIVE_DRIFT = "live_rpe_1m_at_poses_translation";
export const MEMORY = "own_memory_peak";
export const CPU = "cpu_load";

export interface FigureOf {
  info: FigureInfo;
  of: (run: Run) => number | null;
}

export function figureOf(data: ReportData, key: string): FigureOf {
  const index = data.figures.findIndex((figure) => figure.key === key);
  if (index < 0) throw new Error(`the data has no figure ${key}`);
  return { info: data.figures[index], of: (run) => run.values[index] };
}

export function label(run: { algorithm: string; preset: string }): string {
  return run.preset ? `${run.algorithm} (${run.preset})` : run.algorithm;
}

/** Names a cell: a sensor with a method. */
export function cellOf(run: { sensor: string; algorithm: string; preset: string }): string {
  return `${run.sensor}|${label(run)}`;
}

export function grouped<T>(items: T[], key: (item: T) => string): Map<string, T[]> {
  const groups = new Map<string, T[]>();
  for (const item of items) {
    const group = groups.get(key(item));
    if (group) group.push(item);
    else groups.set(key(item), [item]);
  }
  return groups;
}

/** The distinct values of `key`, in the order of their first occurrence. */
export function distinct<T, U>(items: T[], key: (item: T) => U): U[] {
  return [...new Set(items.map(key))];
}

/** The element-wise mean of lists of equal length. */
export function meanOf(lists: number[][]): number[] {
  return lists[0].map((_, i) => lists.reduce((sum, list) => sum + list[i], 0) / lists.length);
}

/** Smallest, lower quartile, median, upper quartile, largest (linear between ranks). */
export function fiveNumbers(values: number[]): number[] {
  const sorted = [...values].sort((a, b) => a - b);
  return [0, 0.25, 0.5, 0.75, 1].map((q) => {
    const rank = q * (sorted.length - 1);
    const low = Math.floor(rank);
    return sorted[low] + (rank - low) * (sorted[Math.min(low + 1, sorted.length - 1)] - sorted[low]);
  });
}

/** A figure over the runs of a cell: the value of a lost run is infinite, the worst. */
export interface Spread {
  median: number;
  best: number;
  worst: number;
  bound: number | null; // of a median share of zero
}

/** The runs of the study's base; those of its variations are other settings. */
export const baseOf = (runs: Run[]) => runs.filter((run) => run.variation === "");

export const keptOf = (runs: Run[]) => runs.filter((run) => !run.lost);

/** Null where no run that is kept has the figure. */
export function spreadOf(runs: Run[], { info, of }: FigureOf): Spread | null {
  const sign = info.more_is_better ? -1 : 1;
  const known = keptOf(runs).filter((run) => of(run) !== null);
  if (known.length === 0 && keptOf(runs).length > 0) return null;
  const worst = Array<number>(runs.length - keptOf(runs).length).fill(sign * Infinity);
  const values = [...known.map((run) => of(run)!), ...worst].sort((a, b) => sign * (a - b) || 0);
  if (values.length === 0) return null;
  const half = Math.floor(values.length / 2);
  const median = values.length % 2 === 1 ? values[half] : (values[half - 1] + values[half]) / 2;
  const bounds = known.flatMap((run) => run.zero_bounds?.[info.key] ?? []);
  return {
    median,
    best: values[0],
    worst: values[values.length - 1],
    bound: median === 0 && bounds.length > 0 ? Math.max(...bounds) : null,
  };
}

/** A figure with three significant digits, whole numbers in full; an infinite one is that of a lost run. */
export function shown(value: number | null | undefined): string {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return "lost";
  if (Number.isInteger(value) && Math.abs(value) < 1e6) return String(value);
  if (Math.abs(value) < 1e-3) return value.toExponential(1);
  return Math.abs(value) >= 100 ? value.toFixed(0) : String(Number(value.toPrecision(3)));
}

/** The same with the upper bound of a share of zero. */
export const shownShare = (value: number | null | undefined, bound: number | null | undefined) =>
  shown(value) + (bound ? ` (below ${shown(bound)})` : "");

export function count(n: number, one: string, many = `${one}s`): string {
  return `${n} ${n === 1 ? one : many}`;
}
