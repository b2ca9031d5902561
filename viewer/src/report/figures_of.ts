// SPDX-License-Identifier: BSD-3-Clause
// Every figure of a report as an ECharts option: the page and the SVG files draw the same ones.
import { RUN_COLORS } from "../view/colors";
import { distinct, DRIFT, figureOf, fiveNumbers, label, meanOf, MEMORY, OWN_OUTLIERS, REAL_TIME, type ReportData, type Run } from "./data";
import type { DistanceHistogram } from "./metrics";
import { theme } from "./theme";

export interface Figure {
  id: string;
  title: string;
  caption: string;
  world: string; // empty: of all worlds
  width: number;
  height: number;
  option: Record<string, unknown>; // ECharts
}

const THRESHOLD = "#e0a800";
const FONT = "sans-serif";
const SYMBOLS = ["circle", "rect", "triangle", "diamond", "pin"];

/**
 * Blue for the Mid-360, red for the OS0-128; for others a color by their
 * order.
 */
export function sensorColor(sensor: string, sensors: string[]): string {
  if (/mid.?360/i.test(sensor)) return "#2b6cb0";
  if (/os0/i.test(sensor)) return "#d1453b";
  return RUN_COLORS[(2 + sensors.indexOf(sensor)) % RUN_COLORS.length];
}

export const base = (title: string) => ({
  animation: false,
  backgroundColor: theme.paper,
  textStyle: { fontFamily: FONT, color: theme.ink },
  title: { text: title, left: 6, top: 2, textStyle: { fontSize: 14, fontFamily: FONT, color: theme.ink } },
  tooltip: { confine: true },
});

interface Cell {
  left: number;
  top: number;
  width: number;
  height: number;
}

/** Position and size of panel `i` in a figure with `columns` panels per row, px. */
function cellOf(i: number, columns: number, width: number, height: number): Cell {
  return { left: 56 + (i % columns) * width, top: 70 + Math.floor(i / columns) * height, width: width - 70, height: height - 72 };
}

/** Height of a figure of `count` panels with its title and legend, px. */
function heightOf(count: number, columns: number, height: number): number {
  return 42 + height * Math.ceil(count / columns);
}

function panelTitle(text: string, cell: Cell) {
  return { text, left: cell.left, top: cell.top - 20, textStyle: { fontSize: 11.5, fontWeight: 600, fontFamily: FONT, color: theme.ink } };
}

export const valueAxis = (gridIndex: number, name: string, more = {}) => ({
  type: "value",
  gridIndex,
  name,
  nameLocation: "middle",
  nameTextStyle: { fontSize: 10, color: theme.faint },
  axisLabel: { fontSize: 10, color: theme.faint },
  splitLine: { lineStyle: { color: theme.grid } },
  ...more,
});

type MapKind = "own_map" | "all_returns";

/** The shares of the bins and of what lies beyond them, %. */
function sharesOf({ counts, beyond }: DistanceHistogram): number[] {
  const all = [...counts, beyond];
  const points = all.reduce((sum, n) => sum + n, 0);
  return all.map((n) => (100 * n) / points);
}

/**
 * Histograms of the points' distances to the mesh, one panel per
 * algorithm, the sensors overlaid, the outlier threshold in yellow. The last bar is the share of
 * points beyond it.
 */
function histograms(all: Run[], world: string, kind: MapKind): Figure | null {
  const runs = all.filter((run) => run.world === world && run[kind]);
  if (runs.length === 0) return null;
  const algorithms = distinct(runs, label);
  const sensors = distinct(runs, (run) => run.sensor);
  const columns = Math.min(algorithms.length, 4);
  const bins = runs[0][kind]!.counts.length;
  const names = [...Array(bins).keys()].map(String).concat(`>${bins}`);
  let top = 0;
  const series: unknown[] = [];
  algorithms.forEach((algorithm, panel) =>
    sensors.forEach((sensor) => {
      const same = runs.filter((run) => label(run) === algorithm && run.sensor === sensor);
      if (same.length === 0) return;
      const shares = meanOf(same.map((run) => sharesOf(run[kind]!)));
      top = Math.max(top, ...shares);
      const color = sensorColor(sensor, sensors);
      series.push({
        type: "bar",
        name: sensor,
        xAxisIndex: panel,
        yAxisIndex: panel,
        barGap: "-100%",
        barCategoryGap: "8%",
        itemStyle: { color, opacity: 0.55 },
        data: shares.map((v) => Number(v.toPrecision(4))),
      });
    }),
  );
  const full = Math.min(100, Math.ceil((top * 1.02) / 20) * 20);
  // the threshold line has its own axis in centimeters, over the bars' axis of bins
  algorithms.forEach((_, panel) =>
    series.push({
      type: "line",
      xAxisIndex: algorithms.length + panel,
      yAxisIndex: panel,
      symbol: "none",
      silent: true,
      tooltip: { show: false },
      lineStyle: { color: THRESHOLD, width: 2 },
      data: [
        [bins, 0],
        [bins, full],
      ],
    }),
  );
  const cells = algorithms.map((_, i) => cellOf(i, columns, 290, 230));
  const title = `Distance from map to mesh, ${world}` + (kind === "own_map" ? "" : ", all returns");
  return {
    id: `histogram-${world}${kind === "own_map" ? "" : "-all-returns"}`,
    title,
    caption:
      `Share of points by their distance to the mesh in bins of 1 cm, mean over seeds; the last bar is the share beyond ${bins} cm (yellow line). ` +
      (kind === "own_map"
        ? "The map is the one that the algorithm publishes."
        : "The map consists of every return, placed by the estimated path, in the same way for every algorithm."),
    width: 60 + 290 * columns,
    height: heightOf(algorithms.length, columns, 230),
    world,
    option: {
      ...base(""),
      title: [{ ...base(title).title }, ...algorithms.map((name, i) => panelTitle(name, cells[i]))],
      tooltip: { trigger: "axis", confine: true, axisPointer: { type: "shadow" } },
      legend: { top: 22, left: 50, data: sensors, textStyle: { fontSize: 11, color: theme.ink } },
      grid: cells,
      xAxis: [
        ...cells.map((_, i) => ({
          type: "category",
          gridIndex: i,
          data: names,
          name: "cm",
          nameGap: 4,
          nameTextStyle: { fontSize: 10, color: theme.faint },
          axisLabel: { fontSize: 10, color: theme.faint, interval: (k: number) => k % 5 === 0 || k === bins },
          axisTick: { show: false },
        })),
        ...cells.map((_, i) => ({ type: "value", gridIndex: i, min: 0, max: bins + 1, show: false })),
      ],
      yAxis: cells.map((_, i) => valueAxis(i, i % columns === 0 ? "% of points" : "", { max: full, nameGap: 30 })),
      series,
    },
  };
}

/** The parts of an algorithm's own memory: key, name, color. */
export const MEMORY_PARTS = [
  ["map_bytes", "map (tree)", "#2b6cb0"],
  ["scan_buffer_bytes", "scan buffer", "#d9a441"],
  ["backlog_bytes", "backlog", "#d1453b"],
] as const;
const MAX_PANELS = 24;

/** The algorithm's memory over time, by its parts. */
function memory(all: Run[], world: string): Figure | null {
  const first = firstSeed(all.filter((run) => run.world === world && run.resources)).slice(0, MAX_PANELS);
  if (first.length === 0) return null;
  const columns = Math.min(first.length, 4);
  const cells = first.map((_, i) => cellOf(i, columns, 290, 210));
  const title = `Memory of the algorithm, ${world}`;
  return {
    id: `memory-${world}`,
    title,
    caption: "As counted by the algorithm, stacked: map (or tree), scan buffer, backlog of measurements not yet processed. First seed.",
    width: 60 + 290 * columns,
    height: heightOf(first.length, columns, 210),
    world,
    option: {
      ...base(""),
      title: [{ ...base(title).title }, ...first.map((run, i) => panelTitle(`${label(run)}, ${run.sensor}`, cells[i]))],
      tooltip: { trigger: "axis", confine: true },
      legend: { top: 22, left: 50, data: MEMORY_PARTS.map(([, name]) => name), textStyle: { fontSize: 11, color: theme.ink } },
      grid: cells,
      xAxis: cells.map((_, i) =>
        valueAxis(i, "s", {
          nameGap: 18,
          min: "dataMin",
          max: "dataMax",
          splitLine: { show: false },
          axisLabel: { fontSize: 10, color: theme.faint, formatter: (v: number) => v.toFixed(0), showMaxLabel: true, hideOverlap: true },
        }),
      ),
      yAxis: cells.map((_, i) => valueAxis(i, i % columns === 0 ? "MB" : "", { nameGap: 34, min: 0 })),
      series: first.flatMap((run, i) =>
        MEMORY_PARTS.map(([key, name, color]) => ({
          type: "line",
          name,
          stack: `s${i}`,
          xAxisIndex: i,
          yAxisIndex: i,
          symbol: "none",
          lineStyle: { width: 1, color },
          itemStyle: { color },
          areaStyle: { color, opacity: 0.5 },
          data: run.resources!.t_s.map((t, k) => [t, 1e-6 * run.resources![key][k]]),
        })),
      ),
    },
  };
}

export const MIN_ERROR_CM = 0.1; // where the logarithmic scale begins
export const onLogScale = (cm: number | null) => (cm === null ? null : Math.max(cm, MIN_ERROR_CM));

/**
 * Error of the path over time, one panel per sensor, one line per algorithm; logarithmic, so that a
 * diverged run does not hide the others.
 */
function drift(all: Run[], world: string): Figure | null {
  const first = firstSeed(all.filter((run) => run.world === world && run.error));
  if (first.length === 0) return null;
  const sensors = distinct(first, (run) => run.sensor);
  const algorithms = distinct(first, label);
  const columns = Math.min(sensors.length, 2);
  const legend = 18 * (Math.ceil(algorithms.length / 7) - 1); // px of its rows after the first
  const cells = sensors.map((_, i) => cellOf(i, columns, 560, 260)).map((cell) => ({ ...cell, top: cell.top + legend }));
  const title = `Error of the path over time, ${world}`;
  return {
    id: `drift-${world}`,
    title,
    caption:
      "Distance between the estimated and the true position after aligning the whole paths by SE(3), on a logarithmic scale. First seed.",
    width: 60 + 560 * columns,
    height: heightOf(sensors.length, columns, 260) + legend,
    world,
    option: {
      ...base(""),
      title: [{ ...base(title).title }, ...sensors.map((name, i) => panelTitle(name, cells[i]))],
      tooltip: { trigger: "axis", confine: true },
      legend: { top: 22, left: 50, data: algorithms, textStyle: { fontSize: 11, color: theme.ink } },
      grid: cells,
      xAxis: cells.map((_, i) =>
        valueAxis(i, "s", {
          nameGap: 18,
          min: "dataMin",
          max: "dataMax",
          splitLine: { show: false },
          axisLabel: { fontSize: 10, color: theme.faint, formatter: (v: number) => v.toFixed(0) },
        }),
      ),
      yAxis: cells.map((_, i) => valueAxis(i, "cm", { type: "log", nameGap: 34, min: MIN_ERROR_CM })),
      series: first.map((run) => ({
        type: "line",
        name: label(run),
        xAxisIndex: sensors.indexOf(run.sensor),
        yAxisIndex: sensors.indexOf(run.sensor),
        symbol: "none",
        lineStyle: { width: 1.3 },
        color: RUN_COLORS[algorithms.indexOf(label(run)) % RUN_COLORS.length],
        data: run.error!.t_s.map((t, k) => [t, onLogScale(100 * run.error!.translation_m[k])]),
      })),
    },
  };
}

/** RPE over flights and seeds: boxes with every run as a dot. */
function spread(data: ReportData, all: Run[], world: string): Figure | null {
  const { of } = figureOf(data, DRIFT);
  const runs = all.filter((run) => run.world === world && of(run) !== null);
  const algorithms = distinct(runs, label);
  const sensors = distinct(runs, (run) => run.sensor);
  const several = algorithms.some((a) => sensors.some((s) => runs.filter((r) => label(r) === a && r.sensor === s).length > 1));
  if (!several) return null;
  const title = `Spread over flights and seeds, ${world}`;
  const boxes = sensors.map((sensor) => ({
    type: "boxplot",
    name: sensor,
    itemStyle: { color: "#ffffff00", borderColor: sensorColor(sensor, sensors) },
    boxWidth: [8, 26],
    data: algorithms.map((algorithm) => {
      const values = valuesOf(runs, algorithm, sensor, of);
      return values.length > 0 ? fiveNumbers(values) : [];
    }),
  }));
  const dots = sensors.map((sensor, k) => ({
    type: "scatter",
    name: sensor,
    symbolSize: 6,
    itemStyle: { color: sensorColor(sensor, sensors), opacity: 0.8 },
    symbolOffset: [`${(k - (sensors.length - 1) / 2) * 480}%`, 0],
    data: algorithms.flatMap((algorithm, i) => valuesOf(runs, algorithm, sensor, of).map((v) => [i, v])),
  }));
  const width = Math.max(480, 120 + 150 * algorithms.length);
  return {
    id: `spread-${world}`,
    title,
    caption:
      "RPE over 1 m of each flight and seed: every run is a dot; boxes reach from the lower to the upper quartile with the median, whiskers to the extremes.",
    width,
    height: 320,
    world,
    option: {
      ...base(title),
      legend: { top: 24, left: 50, data: sensors, textStyle: { color: theme.ink } },
      grid: { left: 60, right: 20, top: 60, bottom: 44 },
      xAxis: { type: "category", data: algorithms, axisLabel: { fontSize: 10.5, interval: 0, width: 140, overflow: "break" } },
      yAxis: valueAxis(0, "RPE, cm per m", { nameGap: 36, min: 0 }),
      series: [...boxes, ...dots],
    },
  };
}

function valuesOf(runs: Run[], algorithm: string, sensor: string, of: (run: Run) => number | null): number[] {
  return runs.filter((r) => label(r) === algorithm && r.sensor === sensor).map((r) => of(r)!);
}

/** Error against cost, with the Pareto front: the runs for which no other run is better in both. */
function pareto(data: ReportData, all: Run[], id: string, cost: (run: Run) => number | null, axis: string): Figure | null {
  const { of } = figureOf(data, DRIFT);
  const runs = all.filter((run) => of(run) !== null && cost(run) !== null);
  if (runs.length < 2) return null;
  const algorithms = distinct(runs, label);
  const sensors = distinct(runs, (run) => run.sensor);
  const title = `Error against ${id === "pareto-cpu" ? "computing time" : "memory"}`;
  return {
    id,
    title,
    caption: `Every run of every world: the color shows the algorithm, the shape the sensor. Lower left is better; the gray steps join the runs for which no other run is better in both.`,
    width: 560,
    height: 360 + 23 * Math.ceil(algorithms.length / 3),
    world: "",
    option: {
      ...base(title),
      legend: { top: 24, left: 50, data: algorithms, textStyle: { fontSize: 11, color: theme.ink } },
      tooltip: {
        confine: true,
        formatter: (p: { data: { name: string; value: number[] } }) =>
          `${p.data.name}<br>${p.data.value.map((v) => Number(v.toPrecision(3))).join(", ")}`,
      },
      grid: { left: 60, right: 24, top: 50 + 23 * Math.ceil(algorithms.length / 3), bottom: 48 },
      xAxis: { ...valueAxis(0, axis, { nameGap: 26 }), type: "log" },
      yAxis: { ...valueAxis(0, "RPE, cm per m", { nameGap: 36 }), type: "log" },
      series: [
        {
          type: "line",
          step: "end",
          symbol: "none",
          silent: true,
          lineStyle: { color: "#9aa3ad", width: 1, type: "dashed" },
          data: paretoFront(runs.map((r) => [cost(r)!, of(r)!])),
        },
        ...algorithms.map((algorithm, i) => ({
          type: "scatter",
          name: algorithm,
          symbolSize: 10,
          itemStyle: { color: RUN_COLORS[i % RUN_COLORS.length], opacity: 0.85 },
          data: runs
            .filter((run) => label(run) === algorithm)
            .map((run) => ({
              name: `${label(run)}, ${run.sensor}, ${run.world}, seed ${run.seed}`,
              value: [cost(run)!, of(run)!],
              symbol: SYMBOLS[sensors.indexOf(run.sensor) % SYMBOLS.length],
            })),
        })),
      ],
    },
  };
}

/** The points for which no other is smaller in both coordinates, sorted by the first. */
export function paretoFront(points: number[][]): number[][] {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  let best = Infinity;
  return sorted.filter(([, y]) => (y < best ? ((best = y), true) : false));
}

function firstSeed(runs: Run[]): Run[] {
  const seen = new Set<string>();
  return runs.filter((run) => {
    const cell = `${label(run)}|${run.sensor}`;
    return seen.has(cell) ? false : seen.add(cell);
  });
}

/** Outlier shares as bars, one group per algorithm. */
function outliers(data: ReportData, all: Run[], world: string): Figure | null {
  const { of } = figureOf(data, OWN_OUTLIERS);
  const runs = all.filter((run) => run.world === world && of(run) !== null);
  if (runs.length === 0) return null;
  const algorithms = distinct(runs, label);
  const sensors = distinct(runs, (run) => run.sensor);
  const title = `Points beyond 20 cm, ${world}`;
  return {
    id: `outliers-${world}`,
    title,
    caption: "Share of the published map's points farther than 20 cm from the mesh, mean over seeds, on a logarithmic scale.",
    width: Math.max(480, 120 + 150 * algorithms.length),
    height: 300,
    world,
    option: {
      ...base(title),
      legend: { top: 24, left: 50, data: sensors, textStyle: { color: theme.ink } },
      tooltip: { trigger: "axis", confine: true },
      grid: { left: 60, right: 20, top: 60, bottom: 44 },
      xAxis: { type: "category", data: algorithms, axisLabel: { fontSize: 10.5, interval: 0, width: 140, overflow: "break" } },
      yAxis: { ...valueAxis(0, "%", { nameGap: 40 }), type: "log", min: 0.001, max: 100, startValue: 0.001 },
      series: sensors.map((sensor) => ({
        type: "bar",
        name: sensor,
        barMaxWidth: 30,
        itemStyle: { color: sensorColor(sensor, sensors) },
        data: algorithms.map((algorithm) => {
          const same = runs.filter((r) => label(r) === algorithm && r.sensor === sensor);
          if (same.length === 0) return null;
          return Number(Math.max(0.001, meanOf(same.map((r) => [of(r)!]))[0]).toPrecision(4));
        }),
      })),
    },
  };
}

/** The charts of `runs`, world by world. */
export function figuresOf(data: ReportData, runs: Run[]): Figure[] {
  const worlds = distinct(runs, (run) => run.world);
  const factor = figureOf(data, REAL_TIME).of;
  const computing = (run: Run) => (factor(run) ? 1 / factor(run)! : null);
  return [
    ...worlds.flatMap((world) => [
      histograms(runs, world, "own_map"),
      histograms(runs, world, "all_returns"),
      outliers(data, runs, world),
      drift(runs, world),
      memory(runs, world),
      spread(data, runs, world),
    ]),
    pareto(data, runs, "pareto-cpu", computing, "computing, s per s of flight"),
    pareto(data, runs, "pareto-memory", figureOf(data, MEMORY).of, "memory of the algorithm, MB"),
  ].filter((figure): figure is Figure => figure !== null);
}
