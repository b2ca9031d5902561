// SPDX-License-Identifier: BSD-3-Clause
// Made by viewer/metrics_types.mjs from the field lists of lidarena/results.

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

export interface DistanceHistogram {
  /** width of a bin; the first begins at zero [m] */
  bin_m: number;
  /** points */
  counts: number[];
  /** points farther than the last bin */
  beyond: number;
}
