// SPDX-License-Identifier: BSD-3-Clause
// From one sensor to another: what each change contributes to a figure.
import { figureOf, type Contributions, type ReportData } from "./data";
import { changeColor, panels, valueAxis, type Figure } from "./figure_parts";

const WHOLE = "#64748b";

/** A bar from `from` to `to`, and the interval of its end. */
interface Bar {
  name: string;
  from: number;
  to: number;
  color: string;
  interval?: [number, number];
}

function barsOf({ base, all, parts }: Contributions, moreIsBetter: boolean): Bar[] {
  const bars: Bar[] = [{ name: "base", from: 0, to: base, color: WHOLE }];
  let at = base;
  for (const part of parts) {
    const { name, value, low, high } = part;
    const interval: [number, number] | undefined = low !== null && high !== null ? [at + low, at + high] : undefined;
    bars.push({ name, from: at, to: at + value, color: changeColor(part, moreIsBetter), interval });
    at += value;
  }
  return [...bars, { name: "all", from: 0, to: all, color: WHOLE }];
}

type Api = { value: (i: number) => number; coord: (point: number[]) => number[]; size: (range: number[]) => number[] };

const series = (bars: Bar[], panel: number) => ({
  type: "custom",
  name: "contribution",
  xAxisIndex: panel,
  yAxisIndex: panel,
  encode: { x: 0, y: [1, 2, 3, 4] },
  data: bars.map(({ from, to, interval }, i) => [i, from, to, interval?.[0] ?? to, interval?.[1] ?? to]),
  renderItem: (_: unknown, api: Api) => {
    const i = api.value(0);
    const [x, y1] = api.coord([i, api.value(1)]);
    const [y2, low, high] = [2, 3, 4].map((k) => api.coord([i, api.value(k)])[1]);
    const width = 0.6 * api.size([1, 0])[0];
    const shape = { x: x - width / 2, y: Math.min(y1, y2), width, height: Math.max(1, Math.abs(y1 - y2)) };
    const stroke = { type: "line", shape: { x1: x, y1: low, x2: x, y2: high }, style: { stroke: "#1f2933", lineWidth: 1.2 } };
    return { type: "group", children: [{ type: "rect", shape, style: { fill: bars[i].color } }, ...(low === high ? [] : [stroke])] };
  },
});

function waterfall(data: ReportData, world: string, key: string): Figure {
  const { info } = figureOf(data, key);
  const shown = data.contributions.filter((c) => c.world === world && c.figure === key);
  const all = shown.map((c) => barsOf(c, info.more_is_better));
  const drawn = panels({
    id: `waterfall-${world}-${key}`,
    title: `${info.label}: what each change contributes, ${world}`,
    world,
    caption:
      "Shapley values of all combinations of the changes, of medians over flights and seeds; lines are intervals at 95 % by bootstrap. " +
      "Green: better, red: worse, gray: the interval contains zero or is unknown.",
    names: shown.map((c) => `${c.sensor}, ${c.method}`),
    legend: [],
    columns: 2,
    width: 420,
    height: 300,
    tooltip: { show: false },
    xAxis: (gridIndex) => ({
      type: "category",
      gridIndex,
      data: all[gridIndex].map(({ name }) => name),
      axisLabel: { rotate: 30, interval: 0, fontSize: 10, width: 90, overflow: "truncate" },
    }),
    yAxis: (i, isLeft) => valueAxis(i, isLeft ? info.unit : "", { nameGap: 40, min: 0 }),
    series: all.map(series),
  });
  (drawn.option.grid as { height: number }[]).forEach((grid) => (grid.height -= 30));
  drawn.columns = ["change", "from", "to", "low", "high"];
  return drawn;
}

/** The waterfalls of a world; none unless all combinations of changes were flown. */
export const waterfallsOf = (data: ReportData, world: string): Figure[] =>
  [...new Set(data.contributions.filter((c) => c.world === world).map((c) => c.figure))].map((key) => waterfall(data, world, key));
