// SPDX-License-Identifier: BSD-3-Clause
// The data of the page, written by lidarena/report/report_data.cpp, and what is computed from it.
import type { DistanceHistogram, ErrorsOverTime, ResourcesOverTime } from "./metrics";

export interface FigureInfo {
  key: string;
  label: string;
  unit: string;
  more_is_better: boolean;
  in_runs: boolean; // a column of the list of runs
}

/** A kind of what can happen during a run, lidarena/dataset/run_events.hpp. */
export interface EventKind {
  name: string;
  label: string;
  value: string; // what the value of an event is, with its unit
}
/** [index of its kind, begin since the first scan and duration (0: an instant) in s, value] */
export type RunEvent = [number, number, number, number];

export interface Run {
  name: string;
  folder: string;
  dataset: string;
  world: string;
  flight: string;
  sensor: string;
  algorithm: string;
  preset: string; // with the timing mode of the sensors, if the study sets one
  variation: string; // what differs from the base of the study; empty: nothing
  varied: Record<string, unknown>; // each key that the study varies, with its value in this run
  differs: string[]; // those keys whose value is not that of the base; of a named set, its name
  seed: number;
  status: string;
  ended_at_s: number | null; // when the method ended itself
  lost: string; // why the run is lost, as lidarena/results/lost.hpp defines it; empty if it is not
  mean_map: boolean; // the points of its own map are means of several returns
  command: string;
  statuses: Record<string, number> | null; // how many scans had which
  coverage_percent: number | null;
  events: RunEvent[] | null; // in the order of their begins; null: not known
  values: (number | null)[]; // of ReportData.figures, as measured
  zero_bounds?: Record<string, number>; // upper bound (%) of a share of which 0 of N points were found, by its figure
  sampled?: Record<string, [number, number]>; // scored points of how many, where a map was sampled
  own_map?: DistanceHistogram | null; // as published by the algorithm
  all_returns?: DistanceHistogram | null; // the scored returns, placed by the estimated motion
  error?: ErrorsOverTime | null; // after SE(3) alignment
  drift?: ErrorsOverTime | null; // over pieces of 1 m
  resources?: ResourcesOverTime | null;
}

export interface Sensor {
  name: string;
  lidar: { rows: number; columns: number; rate_hz: number; max_range_m: number } | null;
  facts: { weight_kg?: number; power_max_w?: number; price?: string } | null;
}

/** What combinations are compared by; less is better. */
export interface Criterion {
  key: string;
  label: string;
  unit: string;
  weight: number; // by default
}

/** A combination of sensor and method in a world. */
export interface Candidate {
  world: string;
  sensor: string;
  algorithm: string;
  preset: string;
  runs: number;
  kept: number; // runs that are not lost
  values: (number | null)[]; // of the criteria; null: not known or lost
  cells: Cell[]; // the same as text
  own_map: Cell;
  verdict: string;
  on_front: boolean;
  dominated_by: string;
}

export interface Cell {
  text: string;
  value?: number;
  live?: string; // the figure as known at each scan
  spread?: string;
  reference?: string;
  bold?: boolean;
  underlined?: boolean;
}

export interface Table {
  id: string;
  title: string;
  note: string;
  head: string[];
  rows: Cell[][];
}

/** Which cells are better than which by the test of lidarena/results/claims.hpp, over all runs of the study. */
export interface Claims {
  cells: string[];
  better: Record<string, [number, number][]>; // by figure: [better, worse], indices of cells
  words: Record<string, string>; // by figure: on how many pairs of runs that rests
}

export interface ReportData {
  title: string;
  version: string;
  made_on: string[];
  figures: FigureInfo[];
  sensors: Sensor[];
  decision: { criteria: Criterion[]; candidates: Candidate[] };
  claims: Claims;
  reference: { world: string; sensor: string; algorithm: string; figure: string; value: number }[];
  event_kinds: EventKind[];
  tables: Table[];
  runs: Run[];
}

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
