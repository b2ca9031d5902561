// SPDX-License-Identifier: BSD-3-Clause
// The data of the charts, written by lidarena/report/report_data.cpp.

export interface Series {
  t_s: number[];
  [column: string]: (number | null)[];
}

export interface MapFigures {
  histogram_percent: number[];  // bins of 1 cm, 0 ... 20 cm
  outliers_percent: number;
  rmse_cm: number;
  points: number;
}

export interface Run {
  name: string;
  world: string;
  flight: string;
  sensor: string;
  algorithm: string;
  preset: string;
  seed: number;
  status: string;
  rpe_cm_per_m: number | null;
  cpu_share: number | null;  // seconds of computing per second of flight
  memory_mb: number | null;
  map: MapFigures | null;  // as published by the algorithm
  all_returns: MapFigures | null;  // every return, placed by the estimated path
  error: Series | null;  // t_s, cm: distance between the paths after SE(3) alignment
  memory: Series | null;  // t_s, map_mb, scan_buffer_mb, backlog_mb
}

export interface ReportData {
  title: string;
  worlds: string[];
  runs: Run[];
}

export interface Figure {
  id: string;
  title: string;
  caption: string;
  width: number;
  height: number;
  option: Record<string, unknown>;  // ECharts
  /** The x axis is time: the chart marks the instant that the 3D view's time line shows. */
  overTime: boolean;
}

export function label(run: { algorithm: string; preset: string }): string {
  return run.preset ? `${run.algorithm} (${run.preset})` : run.algorithm;
}

/** The distinct values of `key`, in the order of their first occurrence. */
export function distinct<T>(runs: Run[], key: (run: Run) => T): T[] {
  return [...new Set(runs.map(key))];
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
