// SPDX-License-Identifier: BSD-3-Clause
// Every chart of a report: the page and the SVG files draw the same ones.
import { RUN_COLORS } from "../view/colors";
import {
  baseOf,
  count,
  CPU,
  distinct,
  DRIFT,
  figureOf,
  fiveNumbers,
  keptOf,
  label,
  meanOf,
  MEMORY,
  OWN_OUTLIERS,
  spreadOf,
  type ReportData,
  type Run,
} from "./data";
import { base, binAxis, groups, legendOf, line, panels, sensorColor, timeAxis, valueAxis, type Figure } from "./figure_parts";
import type { DistanceHistogram } from "./page";
import { rankingsOf } from "./ranking";
import { responsesOf } from "./responses";
import { waterfallsOf } from "./waterfall";

const THRESHOLD = "#e0a800";
const SYMBOLS = ["circle", "rect", "triangle", "diamond", "pin"];
const MAX_PANELS = 24;
const MIN_OUTLIERS_PERCENT = 0.001; // where the logarithmic scale begins
export const MIN_ERROR_CM = 0.1; // likewise

/** The parts of an algorithm's own memory: key, name, color. */
export const MEMORY_PARTS = [
  ["map_bytes", "map", "#2b6cb0"],
  ["scan_buffer_bytes", "scan buffer", "#d9a441"],
  ["backlog_bytes", "backlog", "#d1453b"],
] as const;

type Of = (run: Run) => number | null;
const sensorsOf = (runs: Run[]) => distinct(runs, (run) => run.sensor);
const cellOf = (runs: Run[], algorithm: string, sensor: string) => runs.filter((run) => label(run) === algorithm && run.sensor === sensor);

/** Says that some of the runs are not in a chart. */
const absent = (all: Run[], drawn: Run[]) =>
  drawn.length < all.length
    ? ` Not drawn, as lost or without the figure: ${all.length - drawn.length} of ${count(all.length, "run")}.`
    : "";

const inWorld = (runs: Run[], world: string) => runs.filter((run) => run.world === world);

/** The shares of the bins and of what lies beyond them, %. */
function sharesOf({ counts, beyond }: DistanceHistogram): number[] {
  const all = [...counts, beyond];
  const points = all.reduce((sum, n) => sum + n, 0);
  return all.map((n) => (100 * n) / points);
}

/** Centimeters over time, on a logarithmic scale. */
export function centimeters(curve: { t_s: number[]; translation_m: number[] }): number[][] {
  return curve.t_s.map((t, i) => [t, Math.max(100 * curve.translation_m[i], MIN_ERROR_CM)]);
}

/**
 * Histograms of the points' distances to the mesh, one panel per algorithm, the sensors overlaid, the outlier threshold in
 * yellow. The last bar is the share of points beyond it.
 */
function histograms(all: Run[], world: string, kind: "own_map" | "all_returns"): Figure | null {
  const runs = all.filter((run) => run.world === world && run[kind]);
  if (runs.length === 0) return null;
  const [algorithms, sensors] = [distinct(runs, label), sensorsOf(runs)];
  const bins = runs[0][kind]!.counts.length;
  const bars = algorithms.flatMap((algorithm, panel) =>
    sensors.flatMap((sensor) => {
      const same = cellOf(runs, algorithm, sensor);
      if (same.length === 0) return [];
      const data = meanOf(same.map((run) => sharesOf(run[kind]!))).map((v) => Number(v.toPrecision(4)));
      const itemStyle = { color: sensorColor(sensor, sensors), opacity: 0.55 };
      return [{ type: "bar", name: sensor, xAxisIndex: panel, yAxisIndex: panel, barGap: "-100%", barCategoryGap: "8%", itemStyle, data }];
    }),
  );
  const max = Math.min(100, Math.ceil((1.02 * Math.max(...bars.flatMap(({ data }) => data))) / 20) * 20);
  // the threshold line has its own axis in centimeters, over the bars' axis of bins
  const thresholds = algorithms.map((_, i) => {
    const ends = [0, max].map((y) => [bins, y]);
    return line("", THRESHOLD, ends, {
      xAxisIndex: algorithms.length + i,
      yAxisIndex: i,
      silent: true,
      tooltip: { show: false },
      lineStyle: { width: 2 },
    });
  });
  const own = kind === "own_map";
  return panels({
    id: `histogram-${world}${own ? "" : "-all-returns"}`,
    title: `Distance from map to mesh, ${world}${own ? "" : ", sampled returns"}`,
    world,
    caption:
      `Share of points by their distance to the mesh in bins of 1 cm, mean over seeds; the last bar is the share beyond ${bins} cm (yellow line). ` +
      (own
        ? "The map is the one that the algorithm publishes."
        : "The map consists of the scored returns (at most 20,000 a scan), placed by the estimated motion.") +
      absent(inWorld(all, world), runs),
    names: algorithms,
    legend: sensors,
    columns: 4,
    width: 290,
    height: 230,
    tooltip: { axisPointer: { type: "shadow" } },
    xAxis: (i) => binAxis(i, [...Array(bins).keys()].map(String).concat(`>${bins}`), (k) => k % 5 === 0 || k === bins),
    moreAxes: algorithms.map((_, gridIndex) => ({ type: "value", gridIndex, min: 0, max: bins + 1, show: false })),
    yAxis: (i, isLeft) => valueAxis(i, isLeft ? "% of points" : "", { max, nameGap: 30 }),
    series: [...bars, ...thresholds],
  });
}

/** The algorithm's memory over time, by its parts. */
function memory(all: Run[], world: string): Figure | null {
  const first = firstSeed(all.filter((run) => run.world === world && run.resources)).slice(0, MAX_PANELS);
  if (first.length === 0) return null;
  return panels({
    id: `memory-${world}`,
    title: `Memory of the algorithm, ${world}`,
    world,
    caption:
      "As counted by the algorithm, stacked: map (or tree), scan buffer, backlog of measurements not yet processed. The first seed that has it.",
    names: first.map((run) => `${label(run)}, ${run.sensor}`),
    legend: MEMORY_PARTS.map(([, name]) => name),
    columns: 4,
    width: 290,
    height: 210,
    xAxis: (i) => timeAxis(i),
    yAxis: (i, isLeft) => valueAxis(i, isLeft ? "MB" : "", { nameGap: 34, min: 0 }),
    series: first.flatMap((run, i) => memoryLines(run, { stack: `s${i}`, xAxisIndex: i, yAxisIndex: i })),
  });
}

export function memoryLines({ resources }: Run, more: Record<string, unknown>) {
  return MEMORY_PARTS.map(([key, name, color]) =>
    line(
      name,
      color,
      resources!.t_s.map((t, k) => [t, 1e-6 * resources![key][k]]),
      { lineStyle: { width: 1 }, areaStyle: { color, opacity: 0.5 }, ...more },
    ),
  );
}

/** Error of the path over time, one panel per sensor, one line per algorithm. */
function drift(all: Run[], world: string): Figure | null {
  const first = firstSeed(all.filter((run) => run.world === world && run.error));
  if (first.length === 0) return null;
  const [sensors, algorithms] = [sensorsOf(first), distinct(first, label)];
  return panels({
    id: `drift-${world}`,
    title: `Error of the path over time, ${world}`,
    world,
    caption:
      "Distance between the estimated and the true position after aligning the whole paths by SE(3), on a logarithmic scale. The first seed that has it.",
    names: sensors,
    legend: algorithms,
    columns: 2,
    width: 560,
    height: 260,
    xAxis: (i) => timeAxis(i),
    yAxis: (i) => valueAxis(i, "cm", { type: "log", nameGap: 34, min: MIN_ERROR_CM }),
    series: first.map((run) => {
      const panel = sensors.indexOf(run.sensor);
      return line(label(run), colorOf(algorithms, run), centimeters(run.error!), { xAxisIndex: panel, yAxisIndex: panel });
    }),
  });
}

const colorOf = (algorithms: string[], run: Run) => RUN_COLORS[algorithms.indexOf(label(run)) % RUN_COLORS.length];

/** RPE over flights and seeds: boxes with every run as a dot. */
function spread(data: ReportData, all: Run[], world: string): Figure | null {
  const { of } = figureOf(data, DRIFT);
  const runs = keptOf(inWorld(all, world)).filter((run) => of(run) !== null);
  const [algorithms, sensors] = [distinct(runs, label), sensorsOf(runs)];
  if (!algorithms.some((algorithm) => sensors.some((sensor) => cellOf(runs, algorithm, sensor).length > 1))) return null;
  const values = (algorithm: string, sensor: string) => cellOf(runs, algorithm, sensor).map((run) => of(run)!);
  const boxes = sensors.map((sensor) => ({
    type: "boxplot",
    name: sensor,
    itemStyle: { color: "#ffffff00", borderColor: sensorColor(sensor, sensors) },
    boxWidth: [8, 26],
    data: algorithms.map((algorithm) => {
      const list = values(algorithm, sensor);
      const allKept = list.length === cellOf(inWorld(all, world), algorithm, sensor).length;
      return list.length > 0 && allKept ? fiveNumbers(list) : [];
    }),
  }));
  const dots = sensors.map((sensor, k) => ({
    type: "scatter",
    name: sensor,
    symbolSize: 6,
    itemStyle: { color: sensorColor(sensor, sensors), opacity: 0.8 },
    symbolOffset: [`${(k - (sensors.length - 1) / 2) * 480}%`, 0],
    data: algorithms.flatMap((algorithm, i) => values(algorithm, sensor).map((v) => [i, v])),
  }));
  return groups(
    {
      id: `spread-${world}`,
      title: `Spread over flights and seeds, ${world}`,
      world,
      caption:
        "RPE over 1 m of each flight and seed: every run is a dot; boxes reach from the lower to the upper quartile with the median, whiskers to the extremes; a cell with lost runs has no box. " +
        absent(inWorld(all, world), runs),
    },
    algorithms,
    sensors,
    valueAxis(0, "RPE, cm per m", { nameGap: 36, min: 0 }),
    [...boxes, ...dots],
  );
}

/** Error against cost, with the Pareto front: the runs for which no other run is better in both. */
function pareto(data: ReportData, all: Run[], id: string, title: string, cost: Of, axis: string): Figure | null {
  const { of } = figureOf(data, DRIFT);
  const runs = keptOf(all).filter((run) => of(run) !== null && cost(run) !== null);
  if (runs.length < 2) return null;
  const [algorithms, sensors] = [distinct(runs, label), sensorsOf(runs)];
  const legendHeight = 23 * Math.ceil(algorithms.length / 3);
  const point = (run: Run) => ({
    name: `${label(run)}, ${run.sensor}, ${run.world}, seed ${run.seed}`,
    value: [cost(run)!, of(run)!],
    symbol: SYMBOLS[sensors.indexOf(run.sensor) % SYMBOLS.length],
  });
  const dots = algorithms.map((algorithm, i) => ({
    type: "scatter",
    name: algorithm,
    symbolSize: 10,
    itemStyle: { color: RUN_COLORS[i % RUN_COLORS.length], opacity: 0.85 },
    data: runs.filter((run) => label(run) === algorithm).map(point),
  }));
  const front = line("", "#9aa3ad", paretoFront(runs.map((run) => [cost(run)!, of(run)!])), {
    step: "end",
    silent: true,
    lineStyle: { width: 1, type: "dashed" },
  });
  const formatter = ({ data: { name, value } }: { data: ReturnType<typeof point> }) =>
    `${name}<br>${value.map((v) => Number(v.toPrecision(3))).join(", ")}`;
  return {
    id,
    title,
    world: "",
    width: 560,
    height: 360 + legendHeight,
    caption:
      "Every run of every world: the color shows the algorithm, the shape the sensor. Lower left is better; the gray steps join the runs for which no other run is better in both." +
      absent(all, runs),
    option: {
      ...base(title),
      legend: legendOf(algorithms, { top: 24 }),
      tooltip: { confine: true, formatter },
      grid: { left: 60, right: 24, top: 50 + legendHeight, bottom: 48 },
      xAxis: valueAxis(0, axis, { nameGap: 26, type: "log" }),
      yAxis: valueAxis(0, "RPE, cm per m", { nameGap: 36, type: "log" }),
      series: [front, ...dots],
    },
  };
}

/** The points for which no other is smaller in both coordinates, sorted by the first. */
function paretoFront(points: number[][]): number[][] {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  let best = Infinity;
  return sorted.filter(([, y]) => (y < best ? ((best = y), true) : false));
}

function firstSeed(runs: Run[]): Run[] {
  return runs.filter((run, i) => runs.findIndex((other) => label(other) === label(run) && other.sensor === run.sensor) === i);
}

/** Outlier shares as bars, one group per algorithm. */
function outliers(data: ReportData, all: Run[], world: string): Figure | null {
  const figure = figureOf(data, OWN_OUTLIERS);
  const runs = inWorld(all, world);
  if (!runs.some((run) => figure.of(run) !== null)) return null;
  const [algorithms, sensors] = [distinct(runs, label), sensorsOf(runs)];
  const share = (same: Run[]) => {
    const median = spreadOf(same, figure)?.median;
    return median === undefined ? null : Number(Math.min(100, Math.max(MIN_OUTLIERS_PERCENT, median)).toPrecision(4));
  };
  const bars = sensors.map((sensor) => ({
    type: "bar",
    name: sensor,
    barMaxWidth: 30,
    itemStyle: { color: sensorColor(sensor, sensors) },
    data: algorithms.map((algorithm) => share(cellOf(runs, algorithm, sensor))),
  }));
  const caption =
    "Share of the published map's points farther than 20 cm from the mesh, median over flights and seeds, on a logarithmic scale; 100 %: lost.";
  const yAxis = valueAxis(0, "%", { nameGap: 40, type: "log", min: MIN_OUTLIERS_PERCENT, max: 100, startValue: MIN_OUTLIERS_PERCENT });
  return groups({ id: `outliers-${world}`, title: `Points beyond 20 cm, ${world}`, caption, world }, algorithms, sensors, yAxis, bars, {
    trigger: "axis",
  });
}

/** The charts of `all`, world by world: of the study's base, and of what its variations do. */
export function figuresOf(data: ReportData, all: Run[]): Figure[] {
  const runs = baseOf(all);
  const ofWorld = (world: string) => [
    ...waterfallsOf(data, world),
    ...rankingsOf(data, world),
    ...responsesOf(data, all, world),
    histograms(runs, world, "own_map"),
    histograms(runs, world, "all_returns"),
    outliers(data, runs, world),
    drift(runs, world),
    memory(runs, world),
    spread(data, runs, world),
  ];
  return [
    ...distinct(all, (run) => run.world).flatMap(ofWorld),
    pareto(data, runs, "pareto-cpu", "Error against CPU time", figureOf(data, CPU).of, "CPU time, % of one core"),
    pareto(data, runs, "pareto-memory", "Error against memory", figureOf(data, MEMORY).of, "memory of the algorithm, MB"),
  ].filter((figure): figure is Figure => figure !== null);
}
