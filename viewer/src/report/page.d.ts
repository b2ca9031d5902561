// SPDX-License-Identifier: BSD-3-Clause
// Made by viewer/page_types.mjs from the field lists of lidarena/report/page_data.hpp.

export interface ReportData {
  title: string;
  version: string;
  /** machines and versions of the runs */
  made_on: string[];
  figures: FigureInfo[];
  sensors: Sensor[];
  decision: Decision;
  claims: Claims;
  /** of a study with all combinations of changes */
  contributions: Contributions[];
  /** of a study that varies settings */
  changes: Change[];
  /** published figures */
  reference: ReferenceFigure[];
  event_kinds: EventKind[];
  tables: Table[];
  runs: Run[];
  /** runs that count for no method */
  without_result: RunWithoutResult[];
}

export interface FigureInfo {
  key: string;
  label: string;
  unit: string;
  more_is_better: boolean;
  /** whether it is a column of the list of runs */
  in_runs: boolean;
}

export interface Sensor {
  name: string;
  lidar: Lidar | null;
}

export interface Lidar {
  rows: number;
  columns: number;
  /** [Hz] */
  rate_hz: number;
  /** [m] */
  max_range_m: number;
}

export interface Decision {
  criteria: Criterion[];
  candidates: Candidate[];
}

export interface Criterion {
  key: string;
  label: string;
  unit: string;
  /** by default */
  weight: number;
}

export interface Candidate {
  world: string;
  sensor: string;
  algorithm: string;
  preset: string;
  runs: number;
  /** runs that are not lost */
  kept: number;
  /** of the criteria; null: not known or lost */
  values: (number | null)[];
  /** the same as text */
  cells: Cell[];
  own_map: Cell;
  verdict: string;
  on_front: boolean;
  dominated_by: string;
}

/** Keys with their default value are left out. */
export interface Cell {
  /** as shown */
  text?: string;
  /** not rounded */
  value?: number;
  /** the figure as known at each scan */
  live?: string;
  /** range and runs of a median */
  spread?: string;
  /** a published figure */
  reference?: string;
  bold?: boolean;
  underlined?: boolean;
}

export interface Claims {
  cells: string[];
  /** by figure: better, worse, as indices of cells */
  better: Record<string, [number, number][]>;
  /** by figure: on how many pairs of runs that rests */
  words: Record<string, string>;
}

export interface Contributions {
  world: string;
  sensor: string;
  /** with its preset */
  method: string;
  /** its key */
  figure: string;
  flights: number;
  /** with nothing changed */
  base: number;
  /** with all changed */
  all: number;
  parts: Contribution[];
}

export interface Contribution {
  name: string;
  /** in the unit of the figure */
  value: number;
  low: number | null;
  high: number | null;
}

export interface Change {
  world: string;
  sensor: string;
  /** with its preset */
  method: string;
  /** its key */
  figure: string;
  variation: string;
  /** flown with the base as well */
  flights: number;
  /** median of the differences from the base, in the figure's unit */
  value: number;
  /** of the interval at 95 % */
  low: number | null;
  high: number | null;
}

export interface ReferenceFigure {
  world: string;
  sensor: string;
  algorithm: string;
  /** key of a figure, or of a property of a sensor */
  figure: string;
  /** in the figure's unit */
  value: number;
}

export interface EventKind {
  name: string;
  label: string;
  /** what the value of an event is, with its unit */
  value: string;
}

export interface Table {
  /** name of its files */
  id: string;
  title: string;
  note: string;
  head: string[];
  rows: Cell[][];
}

export interface Run {
  /** of the run's folder */
  name: string;
  /** relative to the page */
  folder: string;
  dataset: string;
  world: string;
  flight: string;
  sensor: string;
  algorithm: string;
  /** with the timing mode of the sensors, if the study sets one */
  preset: string;
  /** what differs from the base of the study; may be empty */
  variation: string;
  /** each key that the study varies, with its value in this run */
  varied: Record<string, unknown>;
  /** those keys whose value is not that of the base; of a named set, its name */
  differs: string[];
  seed: number;
  status: string;
  /** why the run is lost (results/lost.hpp); empty if it is not */
  lost: string;
  /** when the method ended itself [s] */
  ended_at_s: number | null;
  /** whether points of its own map are means of several returns */
  mean_map: boolean;
  /** makes the run again */
  command: string;
  /** how many scans had which */
  statuses: Record<string, number> | null;
  /** of the flight, by the trajectory [%] */
  coverage_percent: number | null;
  /** index of the kind, begin since the first scan and duration (0: an instant) in s, value; in the order of their begins */
  events: [number, number, number, number][] | null;
  /** of all figures, in their order */
  values: (number | null)[];
  /** upper bound of a share of which 0 of N points were found, by its figure [%] */
  zero_bounds: Record<string, number>;
  /** scored points of how many, where a map was sampled */
  sampled: Record<string, [number, number]>;
  /** as published by the algorithm */
  own_map: DistanceHistogram | null;
  /** the scored returns, placed by the estimated motion */
  all_returns: DistanceHistogram | null;
  /** after SE(3) alignment */
  error: ErrorsOverTime | null;
  /** over pieces of 1 m */
  drift: ErrorsOverTime | null;
  resources: ResourcesOverTime | null;
}

export interface DistanceHistogram {
  /** width of a bin; the first begins at zero [m] */
  bin_m: number;
  /** points */
  counts: number[];
  /** points farther than the last bin */
  beyond: number;
}

export interface ErrorsOverTime {
  /** since the truth's first pose [s] */
  t_s: number[];
  /** [m] */
  translation_m: number[];
  /** [rad] */
  rotation_rad: number[];
  /** consecutive errors behind one row */
  largest_of: number;
}

export interface ResourcesOverTime {
  /** consecutive scans behind one row */
  largest_of: number;
  /** sensor time [s] */
  t_s: number[];
  /** of one scan [s] */
  latency_s: number[];
  /** whole process [B] */
  rss_bytes: number[];
  /** whole process, shared pages in proportion [B] */
  pss_bytes: number[];
  /** map, scan buffer and backlog [B] */
  own_bytes: number[];
  /** [B] */
  map_bytes: number[];
  /** [B] */
  scan_buffer_bytes: number[];
  /** [B] */
  backlog_bytes: number[];
}

export interface RunWithoutResult {
  name: string;
  /** missing or not flown */
  status: string;
  reason: string;
}
