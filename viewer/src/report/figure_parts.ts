// SPDX-License-Identifier: BSD-3-Clause
// What the charts of a report are made of: ECharts options in the colors of the screen.
import { RUN_COLORS } from "../view/colors";
import { theme } from "./theme";

export interface Figure {
  id: string;
  title: string;
  caption: string;
  world: string; // empty: of all worlds
  width: number;
  height: number;
  columns?: string[]; // of the data saved as CSV
  option: Record<string, unknown>; // ECharts
}

type Options = Record<string, unknown>;
const FONT = "sans-serif";
const LEGEND_MARK_PX = 45;
const LEGEND_LETTER_PX = 6.5;
const LEGEND_ROW_PX = 18;

/** Blue for the Mid-360, red for the OS0-128; for others a color by their order. */
export function sensorColor(sensor: string, sensors: string[]): string {
  if (/mid.?360/i.test(sensor)) return "#2b6cb0";
  if (/os0/i.test(sensor)) return "#d1453b";
  return RUN_COLORS[(2 + sensors.indexOf(sensor)) % RUN_COLORS.length];
}

const [BETTER, WORSE, OPEN] = ["#2f855a", "#d1453b", "#b8c0cb"];

/** Of a change with its interval: gray where that contains zero, since the figures do not carry more. */
export function changeColor({ low, high }: { low: number | null; high: number | null }, moreIsBetter: boolean): string {
  if (low === null || high === null || (low <= 0 && high >= 0)) return OPEN;
  return low > 0 === moreIsBetter ? BETTER : WORSE;
}

export const base = (title: string) => ({
  animation: false,
  backgroundColor: theme.paper,
  textStyle: { fontFamily: FONT, color: theme.ink },
  title: { text: title, left: 6, top: 2, textStyle: { fontSize: 14, fontFamily: FONT, color: theme.ink } },
  tooltip: { confine: true },
});

export const legendOf = (data: string[], more: Options = {}) => ({
  top: 22,
  left: 50,
  data,
  textStyle: { fontSize: 11, color: theme.ink },
  ...more,
});

const small = () => ({ fontSize: 10, color: theme.faint });

export const valueAxis = (gridIndex: number, name: string, more: Options = {}) => ({
  type: "value",
  gridIndex,
  name,
  nameLocation: "middle",
  nameTextStyle: small(),
  axisLabel: small(),
  splitLine: { lineStyle: { color: theme.grid } },
  ...more,
});

export const timeAxis = (gridIndex: number, more: Options = {}) => {
  const axisLabel = { ...small(), formatter: (v: number) => String(Math.round(10 * v) / 10), showMaxLabel: true, hideOverlap: true };
  return valueAxis(gridIndex, "s", { nameGap: 18, min: "dataMin", max: "dataMax", splitLine: { show: false }, axisLabel, ...more });
};

/** Names below the axis; those that `labeled` refuses are left out. */
export const binAxis = (gridIndex: number, data: string[], labeled: (k: number) => boolean) => ({
  type: "category",
  gridIndex,
  data,
  name: "cm",
  nameGap: 4,
  nameTextStyle: small(),
  axisLabel: { ...small(), interval: labeled },
  axisTick: { show: false },
});

export const line = (name: string, color: string, data: unknown[], more: Options = {}) => ({
  type: "line",
  name,
  color,
  symbol: "none",
  lineStyle: { width: 1.3 },
  data,
  ...more,
});

interface Described {
  id: string;
  title: string;
  caption: string;
  world: string;
}

/** A figure of several panels, `columns` side by side, each `width` x `height` px. */
export interface Panels extends Described {
  names: string[];
  legend: string[];
  columns: number;
  width: number;
  height: number;
  tooltip?: Options;
  xAxis: (i: number) => Options;
  moreAxes?: Options[];
  yAxis: (i: number, isLeft: boolean) => Options;
  series: unknown[];
}

export function panels({ id, title, caption, world, names, legend, width, height, series, ...p }: Panels): Figure {
  const columns = Math.min(names.length, p.columns);
  const legendPx = legend.reduce((sum, entry) => sum + LEGEND_MARK_PX + LEGEND_LETTER_PX * entry.length, 0);
  const legendRows = Math.ceil(legendPx / (columns * width - 60));
  const top = 52 + LEGEND_ROW_PX * legendRows;
  const grid = names.map((_, i) => ({
    left: 56 + (i % columns) * width,
    top: top + Math.floor(i / columns) * height,
    width: width - 70,
    height: height - 72,
  }));
  const titles = names.map((text, i) => ({
    text,
    left: grid[i].left,
    top: grid[i].top - 20,
    textStyle: { fontSize: 11.5, fontWeight: 600, fontFamily: FONT, color: theme.ink },
  }));
  return {
    id,
    title,
    caption,
    world,
    width: 60 + width * columns,
    height: top - 28 + height * Math.ceil(names.length / columns),
    option: {
      ...base(""),
      grid,
      series,
      title: [base(title).title, ...titles],
      legend: legendOf(legend),
      tooltip: { trigger: "axis", confine: true, ...p.tooltip },
      xAxis: [...names.map((_, i) => p.xAxis(i)), ...(p.moreAxes ?? [])],
      yAxis: names.map((_, i) => p.yAxis(i, i % columns === 0)),
    },
  };
}

/** A figure with one group of marks per algorithm. */
export function groups(
  what: Described,
  algorithms: string[],
  sensors: string[],
  yAxis: Options,
  series: unknown[],
  tooltip: Options = {},
): Figure {
  const axisLabel = { fontSize: 10.5, color: theme.faint, interval: 0, width: 140, overflow: "break" };
  return {
    ...what,
    width: Math.max(480, 120 + 150 * algorithms.length),
    height: 310,
    option: {
      ...base(what.title),
      legend: legendOf(sensors, { top: 24 }),
      tooltip: { confine: true, ...tooltip },
      grid: { left: 60, right: 20, top: 60, bottom: 44 },
      xAxis: { type: "category", data: algorithms, axisLabel },
      yAxis,
      series,
    },
  };
}
