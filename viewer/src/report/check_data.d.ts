// SPDX-License-Identifier: BSD-3-Clause
// Made by viewer/page_types.mjs from the field lists of lidarena/stages/check_recording.hpp.

export interface CheckPage {
  recording: string;
  lidar: string;
  /** empty: none */
  imu: string;
  /** from the first measurement to the last [s] */
  seconds: number;
  /** the most severe first */
  findings: Finding[];
  /** of the recording */
  topics: TopicSummary[];
  curves: CheckCurves;
  /** of the specific force */
  accel_spectrum: Spectrum | null;
  /** of the angular rate */
  gyro_spectrum: Spectrum | null;
}

export interface Finding {
  severity: "note" | "warning" | "fault";
  /** kind of the finding, such as imu_saturated */
  key: string;
  /** what was found, with its figures */
  text: string;
  /** the figure */
  value: number;
  /** of the figure */
  unit: string;
  /** since the first measurement [s] */
  from_s: number;
  /** 0, as from_s: all of the recording [s] */
  to_s: number;
  remedy: string;
  /** the remedy as keys of programs */
  settings: Record<string, string>;
}

export interface TopicSummary {
  topic: string;
  type: string;
  /** of scans and IMU samples in recordings of others, else empty */
  frame_id: string;
  messages: number;
  /** 0: unknown [Hz] */
  rate_hz: number;
  /** whether its messages become events */
  is_read: boolean;
}

export interface CheckCurves {
  /** since the first measurement [s] */
  imu_t_s: number[];
  /** size of the angular rate [rad/s] */
  gyro_rad_s: number[];
  /** size of the specific force [m/s^2] */
  accel_m_s2: number[];
  /** stamps of the sweeps [s] */
  sweep_t_s: number[];
  /** points of each sweep */
  sweep_points: number[];
  /** time since the sweep before [s] */
  sweep_gap_s: number[];
  /** midway between two poses [s] */
  pose_t_s: number[];
  /** angular rate as the sweeps show it [rad/s] */
  lidar_rate_rad_s: number[];
}

export interface Spectrum {
  /** [Hz] */
  frequency_hz: number[];
  /** square of the unit per Hz, summed over the axes */
  density: number[];
}
