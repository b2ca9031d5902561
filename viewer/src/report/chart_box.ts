// SPDX-License-Identifier: BSD-3-Clause
// A chart in the page: drawn when it comes into sight, saved as SVG, PNG and CSV.
import { element, whenInSight } from "../view/elements";
import { echarts } from "./charts";
import type { Figure } from "./figure_parts";
import { saveButtons } from "./save";

export type Chart = ReturnType<typeof echarts.init>;
type Series = { name?: string; data?: unknown[]; xAxisIndex?: number };

const seriesOf = (figure: Figure) => figure.option.series as Series[];

/** The points of every series: a row each. */
function rowsOf(figure: Figure): (string | number | null)[][] {
  const rows = seriesOf(figure).flatMap(({ name, data }) =>
    (data ?? []).map((point, i) => {
      const values = (point as { value?: unknown }).value ?? point;
      return [name ?? "", ...(Array.isArray(values) ? values : [i, values])] as (string | number | null)[];
    }),
  );
  return [figure.columns ?? ["series", "x", "y"], ...rows];
}

export class ChartBox {
  readonly root: HTMLElement;
  chart: Chart | null = null;
  private marked: number | null = null;
  private canvas = element("div", { className: "chart" });
  private watch = whenInSight(this.canvas, () => this.draw());

  constructor(
    readonly figure: Figure,
    private onDraw: (chart: Chart) => void = () => undefined,
  ) {
    this.canvas.style.cssText = `width:${figure.width}px;height:${figure.height}px`;
    const caption = element("figcaption", {}, figure.caption);
    caption.style.maxWidth = `${figure.width}px`;
    this.root = element(
      "figure",
      { id: figure.id },
      element("div", { className: "scroll", tabIndex: 0 }, this.canvas),
      caption,
      saveButtons(
        figure.id,
        () => this.svg(),
        () => rowsOf(figure),
      ),
    );
  }

  draw(): Chart {
    this.watch.disconnect();
    if (this.chart) return this.chart;
    this.chart = echarts.init(this.canvas, null, { renderer: "svg", width: this.figure.width, height: this.figure.height });
    this.chart.setOption(this.figure.option);
    this.canvas.querySelector("svg")!.setAttribute("viewBox", `0 0 ${this.figure.width} ${this.figure.height}`); // paper is narrower
    if (this.marked !== null) this.markTime(this.marked);
    this.onDraw(this.chart);
    return this.chart;
  }

  svg(): string {
    const address = this.draw().getDataURL({ type: "svg" });
    return decodeURIComponent(address.slice(address.indexOf(",") + 1));
  }

  /** Marks an instant in every panel of a chart over time. */
  markTime(time: number) {
    this.marked = time;
    const seen = new Set<number>();
    this.chart?.setOption({
      series: seriesOf(this.figure).map(({ xAxisIndex = 0 }) => {
        if (seen.has(xAxisIndex)) return {};
        seen.add(xAxisIndex);
        const lineStyle = { color: "#f97316", type: "solid", width: 1.5 };
        return { markLine: { symbol: "none", silent: true, animation: false, label: { show: false }, lineStyle, data: [{ xAxis: time }] } };
      }),
    });
    this.chart?.getZr().flush(); // at once, whether or not the browser draws frames
  }

  dispose() {
    this.watch.disconnect();
    this.chart?.dispose();
  }
}
