// SPDX-License-Identifier: BSD-3-Clause
// Script of the report's page: draws all of it from the data in the page.
import "../view/view.css";
import "./report.css";
import { element, jsonOf, whenInSight } from "../view/elements";
import { blocksInPage, type SceneHeader } from "../view/scene";
import { ChartBox } from "./chart_box";
import { baseOf, cellOf, distinct, label, type ReportData, type Run, type Table } from "./data";
import { decision } from "./decision";
import { figuresOf } from "./figures_of";
import { keepFocus } from "./keyboard";
import { bestAndWorst, colorKey, compared, matrix, type Page } from "./overview";
import { RunView } from "./run_view";
import { drawn } from "./save";
import { pictureSvg, placePictures, type WorldScene } from "./scenes";
import { choices, passes, readSettings, writeSettings, type Settings } from "./settings";
import { number, tableElement, word, type ShownTable } from "./tables";
import { followTheme } from "./theme";

const DEFINITIONS =
  "Drift (RPE): the true path is cut into segments of 1 m that begin and end at estimated poses; in each, the estimated motion is compared with the true one; " +
  "root mean square over all segments. ATE: distance between the two paths after aligning them. Map: point-to-mesh distance to the same mesh that was scanned, of " +
  "the method's own map or of sampled returns, placed along the estimated path. Figures are those of the final trajectory unless they are called live; metrics.json in each run's folder also " +
  "holds those of other segment lengths and alignments, and the id of each definition. A run is lost if it has no result of the whole flight, if a figure " +
  "of its path is not finite, or if it drifts by more than 1 m or 20 degrees per m; it counts as the worst run of its cell everywhere. CPU time is that of all threads; 100 % is one core. " +
  "A share of 0 of N points has the upper bound 3/N, as if points were independent.";

const marks = document.documentElement.dataset; // read by tests only

function scenesInPage(): WorldScene[] {
  const scenes: WorldScene[] = [];
  for (let i = 0; document.getElementById(`scene-${i}`); ++i) {
    const header = jsonOf<SceneHeader>(`scene-${i}`);
    scenes.push({ world: header.title, header, source: blocksInPage(`block-${i}`, true) });
  }
  return scenes;
}

const isOfExpectations = (table: Table) => table.id.startsWith("expectations-");

class Report implements Page {
  data = jsonOf<ReportData>("data");
  scenes = scenesInPage();
  settings = readSettings(location.hash, this.data);
  runs: Run[] = []; // of the base, that pass the filters
  listed: Run[] = []; // of all variations
  private opened: RunView | null = null;
  private pictures = 0; // asked for so far
  private boxes: ChartBox[] = [];
  private head = element("header");
  private overview = element("section", { id: "overview" });
  private scenesSection = element("section", { id: "scenes" });
  private charts = element("section", { id: "charts" });
  private lists = element("section", { id: "runs" });
  private main = element(
    "main",
    {},
    this.overview,
    this.scenesSection,
    this.charts,
    this.expectations(),
    this.lists,
    this.tables(),
    this.again(),
  );

  constructor() {
    document.body.prepend(this.head, this.main);
    followTheme(() => this.drawCharts());
    this.showScenes();
    this.show();
    window.addEventListener("hashchange", () => {
      this.settings = readSettings(location.hash, this.data);
      this.show();
    });
    window.addEventListener("keydown", (event) => this.onKey(event));
    window.addEventListener("beforeprint", () => {
      this.boxes.forEach((box) => box.draw());
      this.opened?.drawAll();
      this.overview.querySelectorAll<HTMLDetailsElement>("details.note").forEach((note) => (note.open = true));
    });
    marks.ready = "1";
    marks.drawnMs = String(Math.round(performance.now()));
  }

  change = (some: Partial<Settings>) => {
    this.settings = { ...this.settings, ...some };
    history.replaceState(null, "", `#${writeSettings(this.settings)}`);
    keepFocus(() => this.show(Object.keys(some)));
  };

  /** Escape closes the opened run, PageUp and PageDown step through the runs that pass the filters. */
  private onKey(event: KeyboardEvent) {
    const inField = (event.target as Element).closest?.("input, select, textarea");
    if (!this.opened || event.ctrlKey || event.altKey || event.metaKey || event.defaultPrevented) return;
    if (event.key === "Escape") this.change({ run: "" });
    if ((event.key === "PageUp" || event.key === "PageDown") && !inField) {
      event.preventDefault();
      this.opened.step(event.key === "PageDown" ? 1 : -1);
    }
  }

  /** Draws what depends on the settings, or only on those called `changed`. */
  private show(changed = ["filters", "figure", "front", "run"]) {
    this.listed = this.data.runs.filter((run) => passes(run, this.settings));
    this.runs = baseOf(this.listed);
    if (changed.includes("filters")) {
      this.showOverview();
      this.drawCharts();
      const worlds = distinct(this.runs, (run) => run.world);
      for (const part of this.scenesSection.querySelectorAll<HTMLElement>("[data-world]"))
        part.hidden = !worlds.includes(part.dataset.world!);
      this.lists.replaceChildren(...this.listsOfRuns());
    } else {
      if (changed.includes("figure")) document.getElementById("matrix")!.replaceWith(matrix(this));
      if (changed.includes("front")) this.showPicture();
      if (changed.includes("weights")) document.getElementById("decision")!.replaceWith(decision(this));
    }
    if (changed.includes("run")) this.showRun();
  }

  private showOverview() {
    this.head.replaceChildren(
      element("h1", {}, this.data.title),
      element("p", { className: "compared" }, compared(this)),
      this.filters(),
      this.navigation(),
    );
    this.overview.replaceChildren(decision(this), element("div", { className: "seen" }), matrix(this));
    this.showPicture();
  }

  private async showPicture() {
    const turn = ++this.pictures;
    const picture = await bestAndWorst(this);
    if (turn !== this.pictures) return; // another one was asked for
    const seen = this.overview.querySelector(".seen");
    keepFocus(() => (picture ? seen?.replaceWith(picture) : seen?.remove()));
    marks.seen = picture ? "1" : "0";
  }

  private filters(): HTMLElement {
    const bar = element("form", { className: "filters" });
    for (const [name, values] of choices(this.data)) {
      const chosen = this.settings.filters[name];
      const select = element(
        "select",
        { name },
        element("option", { value: "" }, "all"),
        ...values.map((value) => element("option", { value, selected: value === chosen }, value)),
      );
      select.onchange = () => {
        const filters = { ...this.settings.filters, [name]: select.value || undefined };
        if (!select.value) delete filters[name];
        this.change({ filters });
      };
      bar.append(element("label", {}, name, select));
    }
    return bar;
  }

  private navigation(): HTMLElement {
    const sections = [...this.main.querySelectorAll<HTMLElement>(":scope > section[id]")].filter(
      ({ id }) => id !== "run" && id !== "overview",
    );
    const names: Record<string, string> = {
      scenes: "Scenes",
      charts: "Charts",
      expectations: "Expectations",
      runs: "Runs",
      tables: "Tables",
      again: "Make it again",
    };
    return element(
      "nav",
      {},
      ...sections.map(({ id }) => {
        const link = element("a", { href: `#${id}` }, names[id]);
        link.onclick = (event) => {
          // the address keeps the settings
          event.preventDefault();
          document.getElementById(id)!.scrollIntoView();
        };
        return link;
      }),
    );
  }

  private showRun() {
    const closed = this.opened?.run;
    const { scrollY } = window;
    this.opened?.dispose();
    this.opened?.root.remove();
    this.opened = null;
    const run = this.data.runs.find(({ name }) => name === this.settings.run);
    if (!run) {
      if (closed) document.querySelector<HTMLElement>(`[data-cell="${cellOf(closed)}"] button`)?.focus();
      return;
    }
    this.opened = new RunView(this, run);
    this.overview.after(this.opened.root);
    if (closed) return window.scrollTo({ top: scrollY });
    this.opened.root.focus({ preventScroll: true });
    this.opened.root.scrollIntoView();
  }

  private drawCharts() {
    for (const box of this.boxes) box.dispose();
    const figures = figuresOf(this.data, this.listed);
    this.boxes = figures.map((figure) => new ChartBox(figure));
    const groups = distinct(this.boxes, (box) => box.figure.world).map((world) => {
      const ofWorld = this.boxes.filter((box) => box.figure.world === world).map((box) => box.root);
      return element("div", {}, element("h3", {}, world || "Error against cost"), element("div", { className: "figures" }, ...ofWorld));
    });
    this.charts.replaceChildren(element("h2", {}, "Charts"), ...groups);
    this.charts.hidden = groups.length === 0;
    marks.figures = String(figures.length);
  }

  private showScenes() {
    if (this.scenes.length === 0) return this.scenesSection.remove();
    this.scenesSection.append(element("h2", {}, "Scenes"), colorKey());
    for (const scene of this.scenes) {
      const row = element("div", { className: "figures" }, "…");
      const part = element("div", {}, element("h3", {}, scene.world), row);
      part.dataset.world = scene.world;
      this.scenesSection.append(part);
      whenInSight(row, async () => {
        const pictures = await placePictures(scene, { width: 388, maxHeight: 300 });
        row.replaceChildren(...pictures.map((picture) => drawn(picture.id, pictureSvg(picture))));
      });
    }
  }

  private expectations(): HTMLElement | string {
    const tables = this.data.tables.filter(isOfExpectations);
    return tables.length === 0
      ? ""
      : element(
          "section",
          { id: "expectations" },
          element("h2", {}, "What the study expects"),
          ...tables.map((table) => tableElement(table)),
        );
  }

  private listsOfRuns(): (HTMLElement | string)[] {
    const open = (run: Run) => ({ ...word(run.name), open: () => this.change({ run: run.name }) });
    const columns = this.data.figures
      .map((figure, i) => ({ ...figure, i }))
      .filter(({ i }) => this.listed.some((run) => run.values[i] !== null));
    const main = columns.filter(({ in_runs }) => in_runs);
    const varies = this.listed.some((run) => run.variation !== "");
    const bad = this.listed.filter((run) => run.lost);
    const failed: ShownTable = {
      id: "failures",
      title: "Runs that are lost or have no result",
      note: "A run that is missing or was not flown counts for no method.",
      head: ["run", "state", "reason"],
      rows: [
        ...bad.map((run) => [open(run), word(run.status === "ok" ? "lost" : run.status), word(run.lost)]),
        ...this.data.without_result.map((run) => [word(run.name), word(run.status), word(run.reason)]),
      ],
    };
    const all: ShownTable = {
      id: "runs",
      title: "All runs",
      note: "A click on a name opens the run, a click on a head sorts. CSV files hold unrounded figures.",
      head: [
        "run",
        "world",
        "flight",
        "sensor",
        "method",
        ...(varies ? ["variation"] : []),
        "seed",
        "status",
        "coverage, %",
        ...main.map(({ label: text, unit }) => `${text}, ${unit}`),
      ],
      rows: this.listed.map((run) => [
        open(run),
        word(run.world),
        word(run.flight),
        word(run.sensor),
        word(label(run)),
        ...(varies ? [word(run.variation || "base")] : []),
        number(run.seed),
        word(run.lost ? (run.status === "ok" ? "lost" : run.status) : "ok"),
        number(run.coverage_percent),
        ...main.map(({ i, key }) => number(run.values[i], run.zero_bounds?.[key])),
      ]),
    };
    return [element("h2", {}, "Runs"), failed.rows.length > 0 ? tableElement(failed) : "", tableElement(all)];
  }

  private tables(): HTMLElement {
    return element(
      "section",
      { id: "tables" },
      element("h2", {}, "Tables of the whole study"),
      element("p", { className: "note" }, "The same as in the folder tables/, where each is CSV, Markdown, LaTeX and JSON."),
      element(
        "div",
        { className: "tables" },
        ...this.data.tables.filter((table) => !isOfExpectations(table)).map((table) => tableElement(table)),
      ),
    );
  }

  private again(): HTMLElement {
    const { data } = this;
    const commands = {
      id: "commands",
      title: "Commands that make each run again",
      head: ["run", "commands"],
      note: "The noise depends on seed and sensor only, so the same seed gives the same measurements. All sensors of a study are simulated on the same flight.",
      rows: data.runs.map((run) => [word(run.name), word(run.command)]),
    };
    return element(
      "section",
      { id: "again" },
      element("h2", {}, "How to make it again"),
      element("p", {}, DEFINITIONS),
      tableElement(commands),
      element(
        "p",
        { className: "note" },
        data.made_on.length > 0 ? `Runs made on: ${data.made_on.join("; ")}. ` : "",
        `This page was made by lidarena ${data.version} from the result files only.`,
      ),
    );
  }
}

new Report();
