// SPDX-License-Identifier: BSD-3-Clause
// The data of the page, written by lidarena/report/report_data.cpp, and what is computed from it.
import type { DistanceHistogram, ErrorsOverTime, ResourcesOverTime } from "./metrics";

export interface FigureInfo {
  key: string;
  label: string;
  unit: string;
  more_is_better: boolean;
}

export interface Run {
  name: string;
  folder: string;
  dataset: string;
  world: string;
  flight: string;
  sensor: string;
  algorithm: string;
  preset: string; // with the timing mode of the sensors, if the study sets one
  seed: number;
  status: string;
  reason: string;
  command: string;
  statuses: Record<string, number> | null; // how many scans had which
  coverage_percent: number | null;
  values: (number | null)[]; // of ReportData.figures
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

/** What was tried in a world, the best first. */
export interface Candidate {
  world: string;
  sensor: string;
  algorithm: string;
  preset: string;
  usable: boolean;
  verdict: string;
}

export interface Cell {
  text: string;
  value?: number;
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

export interface ReportData {
  title: string;
  version: string;
  made_on: string[];
  figures: FigureInfo[];
  sensors: Sensor[];
  decision: Candidate[];
  reference: { world: string; sensor: string; algorithm: string; figure: string; value: number }[];
  tables: Table[];
  runs: Run[];
}

/** Keys of the figures that the page names. */
export const DRIFT = "rpe_1m_at_poses_translation";
export const MAP_RMSE = "reprojected_map_rmse";
export const OUTLIERS = "reprojected_map_outliers";
export const OWN_OUTLIERS = "own_map_outliers";
export const LATENCY = "latency_p95";
export const MEMORY = "own_memory_peak";
export const REAL_TIME = "real_time_factor";

export function figureOf(data: ReportData, key: string): { info: FigureInfo; of: (run: Run) => number | null } {
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

/** A figure over the runs of a cell that succeeded and have it. */
export interface Spread {
  median: number;
  min: number;
  max: number;
  n: number;
}

export function spreadOf(runs: Run[], of: (run: Run) => number | null): Spread | null {
  const values = runs.filter((run) => run.status === "ok").flatMap((run) => of(run) ?? []);
  if (values.length === 0) return null;
  const [min, , median, , max] = fiveNumbers(values);
  return { median, min, max, n: values.length };
}

/** A figure with three significant digits, whole numbers in full. */
export function shown(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (Number.isInteger(value) && Math.abs(value) < 1e6) return String(value);
  if (Math.abs(value) < 1e-3) return value.toExponential(1);
  return Math.abs(value) >= 100 ? value.toFixed(0) : String(Number(value.toPrecision(3)));
}

export function count(n: number, one: string, many = `${one}s`): string {
  return `${n} ${n === 1 ? one : many}`;
}
