// SPDX-License-Identifier: BSD-3-Clause
// The charts of one run over time: errors, processing time, memory. They have one time axis.
import type { Path } from "../view/points";
import type { Run, Sensor } from "./data";
import { base, legendOf, line, timeAxis, valueAxis, type Figure } from "./figure_parts";
import { centimeters, memoryLines, MIN_ERROR_CM } from "./figures_of";

const FAST_TURN_RAD_S = 1.0;
const WIDTH = 560;

/** The spans of time, s, in which the body turns faster than FAST_TURN_RAD_S. */
export function fastTurns({ t_s, quaternions }: Path): [number, number][] {
  const spans: [number, number][] = [];
  for (let i = 0; i + 1 < t_s.length; ++i) {
    let dot = 0;
    for (let k = 0; k < 4; ++k) dot += quaternions[4 * i + k] * quaternions[4 * i + 4 + k];
    const rate = (2 * Math.acos(Math.min(1, Math.abs(dot)))) / (t_s[i + 1] - t_s[i]);
    if (!(rate > FAST_TURN_RAD_S)) continue;
    const last = spans[spans.length - 1];
    if (last && last[1] === t_s[i]) last[1] = t_s[i + 1];
    else spans.push([t_s[i], t_s[i + 1]]);
  }
  return spans;
}

function overTime(id: string, title: string, caption: string, yAxis: object, series: { name: string }[], end: number): Figure {
  const valueFormatter = (v: number) => (typeof v === "number" ? String(Number(v.toPrecision(3))) : "–");
  const legend = legendOf(
    series.map(({ name }) => name),
    { top: 4, left: "auto", right: 8 },
  );
  return {
    id,
    title,
    caption,
    world: "",
    width: WIDTH,
    height: 200,
    option: {
      ...base(title),
      tooltip: { trigger: "axis", confine: true, valueFormatter },
      legend,
      grid: { left: 56, right: 16, top: 34, bottom: 36 },
      xAxis: timeAxis(0, { min: 0, max: end }),
      yAxis,
      series,
    },
  };
}

export function runCharts(run: Run, sensor: Sensor | undefined, turns: [number, number][]): Figure[] {
  const { error, drift, resources } = run;
  const end = Math.ceil(Math.max(error?.t_s[error.t_s.length - 1] ?? 0, resources?.t_s[resources.t_s.length - 1] ?? 0));
  const figures: Figure[] = [];
  const shade = {
    markArea: {
      silent: true,
      itemStyle: { color: "rgba(217,164,65,0.22)" },
      data: turns.map(([from, to]) => [{ xAxis: from }, { xAxis: to }]),
    },
  };
  if (error || drift) {
    figures.push(
      overTime(
        "run-error",
        "Error",
        "Distance to the true position after alignment by SE(3), and the error of each piece of 1 m; " +
          `shaded: the body turns faster than ${FAST_TURN_RAD_S} rad/s.`,
        valueAxis(0, "cm", { type: "log", nameGap: 36, min: MIN_ERROR_CM }),
        [
          ...(error ? [line("path", "#2b6cb0", centimeters(error), shade)] : []),
          ...(drift ? [line("drift per m", "#c2410c", centimeters(drift))] : []),
        ],
        end,
      ),
    );
  }
  if (!resources) return figures;
  const period = sensor?.lidar ? 1000 / sensor.lidar.rate_hz : null;
  figures.push(
    overTime(
      "run-latency",
      "Processing time of a scan",
      period ? `Above the line (${period.toFixed(0)} ms, the scan period) the method is late.` : "",
      valueAxis(0, "ms", { nameGap: 36 }),
      [
        line(
          "processing time",
          "#0f766e",
          resources.t_s.map((t, i) => [t, 1000 * resources.latency_s[i]]),
        ),
        ...(period
          ? [
              line("scan period", "#e0a800", [
                [0, period],
                [end, period],
              ]),
            ]
          : []),
      ],
      end,
    ),
  );
  figures.push(
    overTime(
      "run-memory",
      "Own memory",
      "Map, scan buffer and backlog as the method counts them.",
      valueAxis(0, "MB", { nameGap: 36 }),
      memoryLines(run, { stack: "memory" }),
      end,
    ),
  );
  return figures;
}
