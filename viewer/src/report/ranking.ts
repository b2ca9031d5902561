// SPDX-License-Identifier: BSD-3-Clause
// What each variation alone changes in a figure, from the best to the worst.
import { distinct, figureOf, type Change, type ReportData } from "./data";
import { changeColor, panels, valueAxis, type Figure } from "./figure_parts";

const ROW_PX = 17;
const NAMES_PX = 210;

const columnOf = ({ sensor, method }: Change) => `${sensor}, ${method}`;

type Api = { value: (i: number) => number; coord: (point: number[]) => number[]; size: (range: number[]) => number[] };

const series = (changes: Change[], names: string[], panel: number, moreIsBetter: boolean) => ({
  type: "custom",
  name: "change",
  xAxisIndex: panel,
  yAxisIndex: panel,
  encode: { x: [1, 2, 3], y: 0 },
  data: changes.map(({ variation, value, low, high }) => [names.indexOf(variation), value, low ?? value, high ?? value]),
  renderItem: ({ dataIndex }: { dataIndex: number }, api: Api) => {
    const row = api.value(0);
    const [zero, y] = api.coord([0, row]);
    const [value, low, high] = [1, 2, 3].map((k) => api.coord([api.value(k), row])[0]);
    const height = 0.6 * api.size([0, 1])[1];
    const shape = { x: Math.min(zero, value), y: y - height / 2, width: Math.max(1, Math.abs(value - zero)), height };
    const fill = changeColor(changes[dataIndex], moreIsBetter);
    const interval = { type: "line", shape: { x1: low, y1: y, x2: high, y2: y }, style: { stroke: "#1f2933", lineWidth: 1.2 } };
    return { type: "group", children: [{ type: "rect", shape, style: { fill } }, ...(low === high ? [] : [interval])] };
  },
});

function ranking(data: ReportData, world: string, key: string): Figure {
  const { info } = figureOf(data, key);
  const shown = data.changes.filter((c) => c.world === world && c.figure === key);
  const columns = distinct(shown, columnOf);
  const sign = info.more_is_better ? -1 : 1;
  const first = shown.filter((c) => columnOf(c) === columns[0]).sort((a, b) => sign * (a.value - b.value));
  const names = distinct([...first, ...shown], (c) => c.variation);
  const drawn = panels({
    id: `ranking-${world}-${key}`,
    title: `${info.label}: change by each variation, ${world}`,
    world,
    caption:
      "Median of the differences from the base on the same flights and seeds; lines are intervals at 95 % by bootstrap. " +
      "Green: better, red: worse, gray: the interval contains zero or is unknown. A variation with which most runs are lost has no bar.",
    names: columns,
    legend: [],
    columns: 2,
    width: 520,
    height: 90 + ROW_PX * names.length,
    tooltip: { show: false },
    xAxis: (i) => valueAxis(i, info.unit, { nameGap: 22 }),
    yAxis: (gridIndex) => ({
      type: "category",
      gridIndex,
      inverse: true,
      data: names,
      axisLabel: { fontSize: 10, width: NAMES_PX - 10, overflow: "truncate", interval: 0 },
    }),
    series: columns.map((column, panel) =>
      series(
        shown.filter((c) => columnOf(c) === column),
        names,
        panel,
        info.more_is_better,
      ),
    ),
  });
  for (const grid of drawn.option.grid as { left: number; width: number }[]) {
    grid.left += NAMES_PX - 50;
    grid.width -= NAMES_PX - 50;
  }
  drawn.columns = ["variation", "change", "low", "high"];
  return drawn;
}

/** The rankings of a world; none of a study that varies nothing. */
export const rankingsOf = (data: ReportData, world: string): Figure[] =>
  distinct(
    data.changes.filter((c) => c.world === world),
    (c) => c.figure,
  ).map((key) => ranking(data, world, key));
