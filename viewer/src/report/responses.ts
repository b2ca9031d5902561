// SPDX-License-Identifier: BSD-3-Clause
// What a study's varied keys do to its figures: curves of one key, heat maps of two, and how many runs keep track.
import {
  distinct,
  DRIFT,
  figureOf,
  grouped,
  keptOf,
  label,
  LIVE_DRIFT,
  MAP_RMSE,
  OWN_RMSE,
  shown,
  spreadOf,
  type FigureOf,
  type ReportData,
  type Run,
} from "./data";
import { RUN_COLORS } from "../view/colors";
import { line, panels, sensorColor, valueAxis, type Figure } from "./figure_parts";

const SETS = "sets"; // in place of a key: the names of sets
const SHOWN = [DRIFT, LIVE_DRIFT, OWN_RMSE, MAP_RMSE];
const LOG_FROM_RATIO = 20; // of the largest value to the smallest: a logarithmic axis
const LOST = { visualMap: false, itemStyle: { color: "#c9ced6" }, label: { formatter: "lost" } };
const NAMES_OF_SETS = { axisLabel: { rotate: 40, interval: 0, fontSize: 9, width: 120, overflow: "truncate" } };
const HEAT_COLORS = ["#f4f8ee", "#f7c873", "#d1453b", "#5c1a33"];

type Value = string | number | boolean | null;
const valueOf = (run: Run, key: string) => run.varied[key] as Value;
const textOf = (value: Value | Value[]) => (Array.isArray(value) ? `[${value.join(", ")}]` : String(value));

/** The runs that differ from the base in no other key. */
const within = (runs: Run[], keys: string[]) =>
  runs.filter((run) => keys.every((key) => key in run.varied) && run.differs.every((key) => keys.includes(key)));

/** The values of a key: numbers by size, others in the order of the runs. */
function valuesOf(runs: Run[], key: string): Value[] {
  const values = [...new Map(runs.map((run) => [textOf(valueOf(run, key)), valueOf(run, key)])).values()];
  return values.every((value) => typeof value === "number") ? (values as number[]).sort((a, b) => a - b) : values;
}

const lostNote = (runs: Run[]) => {
  const lost = runs.length - keptOf(runs).length;
  return lost > 0 ? ` Lost, and counted as the worst: ${lost} of ${runs.length} runs; a median that is lost is not drawn.` : "";
};

function axisOf(values: Value[], key: string): { axis: (i: number) => Record<string, unknown>; place: (value: Value) => number } {
  const numbers = values.filter((value): value is number => typeof value === "number");
  if (numbers.length < values.length) {
    const axis = (gridIndex: number) => ({
      type: "category",
      gridIndex,
      data: values.map(textOf),
      name: key,
      nameLocation: "middle",
      nameGap: 22,
    });
    return { axis, place: (value) => values.findIndex((other) => textOf(other) === textOf(value)) };
  }
  const isLog = numbers[0] > 0 && numbers[numbers.length - 1] / numbers[0] >= LOG_FROM_RATIO;
  const more = isLog
    ? { type: "log", min: numbers[0], max: numbers[numbers.length - 1] }
    : { min: numbers[0], max: numbers[numbers.length - 1] };
  return { axis: (i) => valueAxis(i, key, { nameGap: 22, ...more }), place: (value) => value as number };
}

type Api = { value: (i: number) => number; coord: (point: number[]) => number[] };

/** From the best run to the worst. */
const whiskers = (name: string, color: string, panel: number, data: number[][]) => ({
  type: "custom",
  name,
  xAxisIndex: panel,
  yAxisIndex: panel,
  silent: true,
  itemStyle: { color },
  encode: { x: 0, y: [1, 2] },
  data,
  renderItem: (_: unknown, api: Api) => {
    const [x, y1] = api.coord([api.value(0), api.value(1)]);
    const y2 = api.coord([api.value(0), api.value(2)])[1];
    const style = { stroke: color, lineWidth: 1.2, opacity: 0.6 };
    const stroke = (a: number[], b: number[]) => ({ type: "line", shape: { x1: a[0], y1: a[1], x2: b[0], y2: b[1] }, style });
    return { type: "group", children: [stroke([x, y1], [x, y2]), stroke([x - 3, y1], [x + 3, y1]), stroke([x - 3, y2], [x + 3, y2])] };
  },
});

/** The series of a panel: medians by value, with their ranges. */
function cellsOf(same: Run[], values: Value[], of: (run: Run) => Value, place: (value: Value) => number, figure: FigureOf) {
  const cells = grouped(same, (run) => textOf(of(run)));
  const spreads = values.flatMap((value) => {
    const spread = spreadOf(cells.get(textOf(value)) ?? [], figure);
    return spread && Number.isFinite(spread.median) ? [{ x: place(value), ...spread }] : [];
  });
  const ranges = spreads
    .filter(({ best, worst }) => Number.isFinite(worst) && best !== worst)
    .map(({ x, best, worst }) => [x, best, worst]);
  return { medians: spreads.map(({ x, median }) => [x, median]), ranges };
}

const leaveRoomForNames = (drawn: Figure) =>
  (drawn.option.grid as { height: number }[]).forEach((grid) => {
    grid.height -= 70;
  });

/** A figure against the values of one key, or by the names of sets: a panel per method, a line per sensor. */
function curve(runs: Run[], world: string, key: string, of: (run: Run) => Value, figure: FigureOf): Figure | null {
  const isSets = key === SETS;
  const values = isSets ? distinct(runs, of) : valuesOf(runs, key);
  const methods = distinct(runs, label);
  const sensors = distinct(runs, (run) => run.sensor);
  if (values.length < 2 || !runs.some((run) => figure.of(run) !== null)) return null;
  const { axis, place } = axisOf(values, isSets ? "" : key);
  const series = methods.flatMap((method, panel) =>
    sensors.flatMap((sensor) => {
      const same = runs.filter((run) => label(run) === method && run.sensor === sensor);
      const { medians, ranges } = cellsOf(same, values, of, place, figure);
      const color = sensorColor(sensor, sensors);
      const joined = isSets ? { lineStyle: { width: 0 } } : {};
      const more = { xAxisIndex: panel, yAxisIndex: panel, symbol: "circle", symbolSize: 6, ...joined };
      return [line(sensor, color, medians, more), whiskers(sensor, color, panel, ranges)];
    }),
  );
  const drawn = panels({
    id: `response-${world}-${key}-${figure.info.key}`,
    title: isSets ? `${figure.info.label} by variation, ${world}` : `${figure.info.label} against ${key}, ${world}`,
    world,
    caption: `Median over flights and seeds; bars reach from the best run to the worst. ${isSets ? "Base: nothing varied." : "All other keys as in the base."}${lostNote(runs)}`,
    names: methods,
    legend: sensors,
    columns: isSets ? 3 : 4,
    width: isSets ? 400 : 290,
    height: isSets ? 300 : 230,
    tooltip: { trigger: "item" },
    xAxis: (i) => ({ ...axis(i), ...(isSets ? NAMES_OF_SETS : {}) }),
    yAxis: (i, isLeft) => valueAxis(i, isLeft ? figure.info.unit : "", { nameGap: 40, min: 0 }),
    series,
  });
  if (isSets) leaveRoomForNames(drawn);
  return drawn;
}

/** How many of the runs keep track, in percent, with Wilson's interval at 95 % (E. Wilson, 1927). */
function survivalOf(runs: Run[]): { share: number; low: number; high: number } {
  const n = runs.length;
  const share = keptOf(runs).length / n;
  const z2 = 1.96 ** 2 / n;
  const half = Math.sqrt(z2 * share * (1 - share) + z2 ** 2 / 4);
  const [low, high] = [-half, half].map((side) => (100 * (share + z2 / 2 + side)) / (1 + z2));
  return { share: 100 * share, low, high };
}

/** The share of runs that keep track against the values of one key: a panel per sensor, a line per method. */
function survival(runs: Run[], world: string, key: string, of: (run: Run) => Value): Figure | null {
  const isSets = key === SETS;
  const values = isSets ? distinct(runs, of) : valuesOf(runs, key);
  if (values.length < 2 || keptOf(runs).length === runs.length) return null;
  const methods = distinct(runs, label);
  const sensors = distinct(runs, (run) => run.sensor);
  const { axis, place } = axisOf(values, isSets ? "" : key);
  const series = sensors.flatMap((sensor, panel) =>
    methods.flatMap((method, i) => {
      const same = runs.filter((run) => label(run) === method && run.sensor === sensor);
      const cells = grouped(same, (run) => textOf(of(run)));
      const shares = values.flatMap((value) => {
        const cell = cells.get(textOf(value));
        return cell ? [{ x: place(value), ...survivalOf(cell) }] : [];
      });
      const color = RUN_COLORS[i % RUN_COLORS.length];
      const joined = isSets ? { lineStyle: { width: 0 } } : {};
      const more = { xAxisIndex: panel, yAxisIndex: panel, symbol: "circle", symbolSize: 6, ...joined };
      return [
        line(
          method,
          color,
          shares.map(({ x, share }) => [x, share]),
          more,
        ),
        whiskers(
          method,
          color,
          panel,
          shares.map(({ x, low, high }) => [x, low, high]),
        ),
      ];
    }),
  );
  const drawn = panels({
    id: `survival-${world}-${key}`,
    title: isSets ? `Runs that keep track by variation, ${world}` : `Runs that keep track against ${key}, ${world}`,
    world,
    caption: `Share of runs that are not lost, of all flights and seeds; bars: Wilson's interval at 95 %. ${isSets ? "Base: nothing varied." : "All other keys as in the base."}`,
    names: sensors,
    legend: methods,
    columns: 2,
    width: 520,
    height: 300,
    tooltip: { trigger: "item" },
    xAxis: (i) => ({ ...axis(i), ...(isSets ? NAMES_OF_SETS : {}) }),
    yAxis: (i, isLeft) => valueAxis(i, isLeft ? "%" : "", { nameGap: 40, min: 0, max: 100 }),
    series,
  });
  if (isSets) leaveRoomForNames(drawn);
  drawn.columns = [isSets ? "index of the variation" : key, "%", "high"];
  return drawn;
}

/** A figure against two keys: a panel per method and sensor. */
function heatMap(all: Run[], world: string, [x, y]: [string, string], figure: FigureOf): Figure | null {
  const runs = within(all, [x, y]).filter((run) => run.world === world);
  if (!runs.some((run) => run.differs.length === 2)) return null;
  const [columns, rows] = [valuesOf(runs, x), valuesOf(runs, y)];
  const names = distinct(runs, (run) => `${label(run)}, ${run.sensor}`);
  const series = names.map((name, panel) => {
    const same = runs.filter((run) => `${label(run)}, ${run.sensor}` === name);
    const data = columns.flatMap((a, i) =>
      rows.flatMap((b, j) => {
        const cell = same.filter((run) => textOf(valueOf(run, x)) === textOf(a) && textOf(valueOf(run, y)) === textOf(b));
        const median = spreadOf(cell, figure)?.median;
        if (median === undefined) return [];
        return [Number.isFinite(median) ? { value: [i, j, Number(median.toPrecision(3))] } : { value: [i, j, 0], ...LOST }];
      }),
    );
    const text = ({ value }: { value: number[] }) => shown(value[2]);
    return { type: "heatmap", name, xAxisIndex: panel, yAxisIndex: panel, data, label: { show: true, fontSize: 10, formatter: text } };
  });
  const kept = series.map(({ data }) => data.filter((cell) => !("visualMap" in cell)).map(({ value }) => value[2]));
  const drawn = panels({
    id: `heat-${world}-${x}-${y}-${figure.info.key}`,
    title: `${figure.info.label} (${figure.info.unit}) against ${x} and ${y}, ${world}`,
    world,
    caption: `Median over flights and seeds, colored from the smallest to the largest of each panel. All other keys as in the base.`,
    names,
    legend: [],
    columns: 3,
    width: 340,
    height: 250,
    tooltip: { trigger: "item" },
    xAxis: (gridIndex) => ({ type: "category", gridIndex, data: columns.map(textOf), name: x, nameLocation: "middle", nameGap: 22 }),
    yAxis: (gridIndex, isLeft) => ({
      type: "category",
      gridIndex,
      data: rows.map(textOf),
      name: isLeft ? y : "",
      nameLocation: "middle",
      nameGap: 40,
    }),
    series,
  });
  drawn.columns = ["method, sensor", `index of ${x}`, `index of ${y}`, figure.info.key];
  drawn.option.visualMap = kept.map((medians, seriesIndex) => {
    const [min, max] = medians.length > 0 ? [Math.min(...medians), Math.max(...medians)] : [0, 1];
    return { show: false, seriesIndex, min, max, inRange: { color: HEAT_COLORS } };
  });
  return drawn;
}

/** The charts of a study that varies settings; none of any other study. */
export function responsesOf(data: ReportData, runs: Run[], world: string): (Figure | null)[] {
  const keys = [...new Set(runs.flatMap((run) => Object.keys(run.varied)))];
  const figures = SHOWN.map((key) => figureOf(data, key));
  const pairs = keys.flatMap((a, i) => keys.slice(i + 1).map((b): [string, string] => [a, b]));
  const here = runs.filter((run) => run.world === world);
  const sets = here.filter((run) => run.differs.every((name) => name === run.variation));
  return [
    survival(sets, world, SETS, (run) => run.variation || "base"),
    ...keys.map((key) => survival(within(here, [key]), world, key, (run) => valueOf(run, key))),
    ...figures.map((figure) => curve(sets, world, SETS, (run) => run.variation || "base", figure)),
    ...keys.flatMap((key) => figures.map((figure) => curve(within(here, [key]), world, key, (run) => valueOf(run, key), figure))),
    ...pairs.flatMap((pair) => figures.map((figure) => heatMap(runs, world, pair, figure))),
  ];
}
