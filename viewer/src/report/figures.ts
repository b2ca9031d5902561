// SPDX-License-Identifier: BSD-3-Clause
// For Node.js: `node figures.cjs DATA.json OUT` draws every figure as OUT/ID.svg and lists them on
// standard output, one per line: id, title and caption, separated by tabs.
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { echarts } from "./charts";
import type { ReportData } from "./data";
import { figuresOf } from "./figures_of";

const [input, out] = process.argv.slice(2);
mkdirSync(out, { recursive: true });
for (const figure of figuresOf(JSON.parse(readFileSync(input, "utf8")) as ReportData)) {
  const chart = echarts.init(null, null, { renderer: "svg", ssr: true, width: figure.width, height: figure.height });
  chart.setOption({ backgroundColor: "#ffffff", ...figure.option });
  writeFileSync(path.join(out, `${figure.id}.svg`), `${chart.renderToSVGString()}\n`);
  chart.dispose();
  process.stdout.write(`${figure.id}\t${figure.title}\t${figure.caption}\n`);
}
