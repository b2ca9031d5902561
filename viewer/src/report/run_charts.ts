// SPDX-License-Identifier: BSD-3-Clause
// The charts of one run over time: errors, what happened, processing time, memory. They have one time axis.
import { distinct, shown, type EventKind, type Run, type Sensor } from "./data";
import { base, legendOf, line, timeAxis, valueAxis, type Figure } from "./figure_parts";
import { centimeters, memoryLines, MIN_ERROR_CM } from "./figures_of";

const WIDTH = 560;
const FAST_TURN_COLOR = "#d9a441";
const EVENT_COLORS: Record<string, string> = {
  fast_turn: FAST_TURN_COLOR,
  few_points: "#7c3aed",
  degenerate: "#2b6cb0",
  diverged: "#d62027",
  loop: "#0f766e",
  imu_gap: "#64748b",
  imu_saturated: "#be185d",
  imu_restart: "#c2410c",
};
const LANE_PX = 12;
const LEGEND_ENTRIES = 4; // of a row

interface Shape {
  value: (dimension: number) => number;
  coord: (point: [number, number]) => [number, number];
  style: () => object;
}

/** A bar from the begin of an event to its end, wide enough to be seen. */
function eventBar(_: unknown, { value, coord, style }: Shape): object {
  const [x, y] = coord([value(0), value(1)]);
  const [right] = coord([value(2), value(1)]);
  const shape = { x: x - 1, y: y - 0.4 * LANE_PX, width: Math.max(right - x, 1) + 2, height: 0.8 * LANE_PX };
  return { type: "rect", shape, style: style() };
}

/** A strip with a lane for each kind of event that the run has. */
function eventStrip(run: Run, kinds: EventKind[], end: number): Figure | null {
  if (!run.events) return null;
  const present = distinct(run.events, ([kind]) => kind).sort((a, b) => a - b);
  const series = present.map((kind, lane) => ({
    type: "custom",
    name: kinds[kind].label,
    color: EVENT_COLORS[kinds[kind].name] ?? "#334155",
    renderItem: eventBar,
    encode: { x: [0, 2], y: 1 },
    data: run.events!.filter(([of]) => of === kind).map(([, t, duration, value]) => [t, lane, t + duration, value]),
  }));
  const top = 26 + 18 * Math.ceil(present.length / LEGEND_ENTRIES);
  const formatter = ({ seriesIndex, value }: { seriesIndex: number; value: number[] }) => {
    const { label, value: meaning } = kinds[present[seriesIndex]];
    const span = value[2] > value[0] ? ` to ${value[2].toFixed(2)}` : "";
    return `${label}: ${value[0].toFixed(2)}${span} s<br>${meaning}: ${shown(value[3])}`;
  };
  return {
    id: "run-events",
    title: "Events",
    caption:
      present.length === 0 ? "None in this run (events.csv)." : "From events.csv; the lanes from above are in the order of the legend.",
    world: "",
    width: WIDTH,
    height: top + LANE_PX * present.length + 26,
    columns: ["event", "begin, s", "lane", "end, s", "value"],
    option: {
      ...base("Events"),
      tooltip: { confine: true, formatter },
      legend: legendOf(
        series.map(({ name }) => name),
        { top: 22, left: 50, itemWidth: 14 },
      ),
      grid: { left: 56, right: 16, top, bottom: 26 },
      xAxis: timeAxis(0, { min: 0, max: end, name: "", axisLine: { onZero: false } }),
      yAxis: { type: "value", min: -0.5, max: Math.max(present.length, 1) - 0.5, inverse: true, show: false },
      series,
    },
  };
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

export function runCharts(run: Run, sensor: Sensor | undefined, kinds: EventKind[]): Figure[] {
  const { error, drift, resources } = run;
  const ends = [error, drift, resources].map((curve) => curve?.t_s[curve.t_s.length - 1] ?? 0);
  const end = Math.ceil(Math.max(...ends, ...(run.events ?? []).map(([, t, duration]) => t + duration)));
  const turns = (run.events ?? []).filter(([kind]) => kinds[kind].name === "fast_turn");
  const figures: Figure[] = [];
  const shade = {
    markArea: {
      silent: true,
      itemStyle: { color: FAST_TURN_COLOR, opacity: 0.22 },
      data: turns.map(([, t, duration]) => [{ xAxis: t }, { xAxis: t + duration }]),
    },
  };
  if (error || drift) {
    figures.push(
      overTime(
        "run-error",
        "Error",
        "Distance to the true position after alignment by SE(3), and the error of each piece of 1 m" +
          (turns.length > 0 ? "; shaded: fast turns." : "."),
        valueAxis(0, "cm", { type: "log", nameGap: 36, min: MIN_ERROR_CM }),
        [
          ...(error ? [line("path", "#2b6cb0", centimeters(error), shade)] : []),
          ...(drift ? [line("drift per m", "#c2410c", centimeters(drift))] : []),
        ],
        end,
      ),
    );
  }
  const strip = eventStrip(run, kinds, end);
  if (strip) figures.push(strip);
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
