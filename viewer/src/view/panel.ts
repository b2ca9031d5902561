// SPDX-License-Identifier: BSD-3-Clause
// Controls around a View: what is shown and how, the time line, the color key, the values of the
// clicked point.
import { cssGradient, OUTLIER, rampColor, rampOf } from "./colors";
import { button, checkbox, choice, element, section, slider, type Slider } from "./elements";
import type { ColorBy } from "./point_material";
import type { Vec3 } from "./scene";
import { colorsOf, hasField, usualRange, writeHash, type State } from "./state";
import { SURFACE_LOOKS } from "./surface";
import type { Standpoint, View } from "./view";

const COLOR_LABEL: Record<ColorBy, string> = {
  distance: "distance to the mesh, m",
  intensity: "intensity",
  time: "time, s",
  height: "height, m",
  solid: "",
};
const FRAMES_PER_SECOND = 20;
const CLICK_TOLERANCE_PX = 4;

export interface PanelOptions {
  /** The view fills the page: settings are kept in the address after "#", keys act wherever the focus is. */
  ofPage: boolean;
  /** Called when the time line moves. */
  onTime?: (time: number) => void;
}

export class Panel {
  private key = element("div", { className: "key" });
  private readout = element("div", { className: "readout" });
  private status = element("div", { className: "status" });
  private labels = element("div", { className: "labels" });
  private layerList = element("div", { className: "layers" });
  private timeSlider: Slider | null = null;
  private playing = false;
  private initial: State;

  constructor(
    readonly view: View,
    readonly root: HTMLElement,
    public state: State,
    private options: PanelOptions,
  ) {
    this.initial = { ...state };
    root.append(this.labels, this.key, this.readout);
    root.append(this.controls());
    if (view.header.time) root.append(this.timeBar(...view.header.time));
    this.applyAll();
    this.listenForPicks();
    (options.ofPage ? window : root).addEventListener("keydown", (event) => this.onKey(event as KeyboardEvent));
    view.onFrame = () => this.showStatus();
  }

  private controls(): HTMLElement {
    const { view, state } = this;
    const standpoints: [Standpoint, string][] = [
      ["oblique", "3D"],
      ["top", "Top"],
      ["side", "Side"],
      ["front", "Front"],
    ];
    const children: HTMLElement[] = [
      element(
        "div",
        { className: "buttons" },
        ...standpoints.map(([name, label]) => button(label, `look from this direction (${name})`, () => this.change({ view: name }))),
      ),
      element(
        "div",
        { className: "buttons" },
        button("Side by side", "two pictures with the same camera", () => this.change({ split: !this.state.split })),
        button("Dark", "dark or light background", () => this.change({ dark: !this.state.dark })),
        button("PNG", "save this picture", () => this.savePicture()),
      ),
      section("Shown", this.layerList),
      section(
        "Color",
        choice("by", colorsOf(view.header), state.color, (color) => this.change({ color, range: null })),
        this.rangeFields(),
      ),
    ];
    const points = section(
      "Points",
      slider("size", { min: 1, max: 8, step: 0.5, value: state.size, shown: (v) => `${v} px` }, (size) => this.change({ size })).element,
      slider("at most", { min: 4, max: 7.5, step: 0.1, value: Math.log10(view.budget), shown: (v) => shortCount(10 ** v) }, (v) =>
        this.change({ budget: Math.round(10 ** v) }),
      ).element,
    );
    if (hasField(view.header, "distance")) {
      points.append(checkbox(`only beyond ${view.header.outlier_m * 100} cm`, state.outliers, (outliers) => this.change({ outliers })));
    }
    if (view.header.clouds.length > 0) children.push(points);
    if (view.header.meshes.length > 0) {
      children.push(
        section(
          "Mesh",
          choice("look", SURFACE_LOOKS, state.surface, (surface) => this.change({ surface })),
        ),
      );
    }
    children.push(section("Cut", ...this.cutSliders()), this.status);
    return this.options.ofPage
      ? element("aside", { className: "panel" }, ...children)
      : element("details", { className: "panel" }, element("summary", {}, "Controls"), ...children);
  }

  private rangeFields(): HTMLElement {
    const ends = [0, 1].map((i) => {
      const input = element("input", { type: "number", step: "any", placeholder: "auto", title: i ? "upper end" : "lower end" });
      input.onchange = () => {
        const values = ends.map((e) => e.value.trim());
        const usual = usualRange(this.view.header, this.state.color);
        const range = values.map((v, k) => (v === "" ? usual[k] : Number(v))) as [number, number];
        this.change({ range: values.every((v) => v === "") ? null : range });
      };
      return input;
    });
    return element("label", { className: "field range" }, "from, to", ...ends);
  }

  private cutSliders(): HTMLElement[] {
    const [low, high] = this.view.header.bounds;
    const inside = (v: number, a: number) => Math.min(Math.max(v, low[a]), high[a]);
    const cut = (this.state.cut ?? [low, high]).map((corner) => corner.map(inside)) as [Vec3, Vec3];
    return ["x", "y", "z"].flatMap((axis, a) =>
      [0, 1].map((end) => {
        const shown = (v: number) => `${v.toFixed(1)} m`;
        const step = Math.max((high[a] - low[a]) / 200, 1e-3);
        return slider(`${axis} ${end ? "to" : "from"}`, { min: low[a], max: high[a], step, value: cut[end][a], shown }, (value) => {
          cut[end][a] = value;
          this.change({ cut: withoutBoundLimits(cut, low, high) });
        }).element;
      }),
    );
  }

  private timeBar(from: number, to: number): HTMLElement {
    const play = button("▶", "play (space)", () => this.play(!this.playing));
    play.className = "play";
    const shown = (v: number) => `${v.toFixed(1)} s`;
    this.timeSlider = slider("time", { min: from, max: to, step: (to - from) / 2000, value: to, shown }, (t) =>
      this.change({ t: t >= to ? null : t }),
    );
    const windows = ["all", "10 s", "3 s", "1 s", "0.1 s"] as const;
    const window = choice("last", windows, "all", (w) => this.change({ window: w === "all" ? null : parseFloat(w) }));
    return element("div", { className: "timebar" }, play, this.timeSlider.element, window);
  }

  /** Changes some settings, shows the result, and writes the settings to the address. */
  change(some: Partial<State>) {
    this.state = { ...this.state, ...some };
    this.apply(some);
    if (this.options.ofPage) history.replaceState(null, "", `#${writeHash(this.state, this.initial)}`);
  }

  private applyAll() {
    this.apply(this.state);
  }

  private apply(some: Partial<State>) {
    const { view, state } = this;
    if ("split" in some) view.setSplit(state.split);
    if ("view" in some || "split" in some) view.standAt(state.view);
    if ("color" in some || "range" in some) view.setColorBy(state.color, state.range ?? usualRange(view.header, state.color));
    if ("outliers" in some) view.style.uOutliersOnly.value = state.outliers ? 1 : 0;
    if ("size" in some) view.style.uPixels.value = state.size * view.renderer.getPixelRatio();
    if (state.budget !== null) view.budget = state.budget;
    if ("surface" in some) view.setSurfaceLook(state.surface);
    if ("cut" in some)
      view.setCut(
        ...(state.cut ?? [
          [-1e9, -1e9, -1e9],
          [1e9, 1e9, 1e9],
        ]),
      );
    if ("t" in some || "window" in some) this.applyTime();
    if ("dark" in some) {
      this.root.classList.toggle("dark", state.dark);
      view.setBackground(state.dark ? "#12161c" : "#f6f7f9");
      view.style.uSolid.value.set(state.dark ? "#cbd5e1" : "#334155");
    }
    this.showKey();
    this.showLayers();
    view.invalidate();
  }

  private applyTime() {
    const span = this.view.header.time;
    if (!span) return;
    const { t, window } = this.state;
    const to = t ?? span[1];
    const from = window === null ? -Infinity : to - window;
    this.view.setTime(from, t === null && window === null ? Infinity : to);
    this.timeSlider?.set(to);
    this.options.onTime?.(to);
  }

  private play(on: boolean) {
    const span = this.view.header.time!;
    this.playing = on;
    if (on && (this.state.t === null || this.state.t >= span[1])) this.change({ t: span[0] });
    const step = () => {
      if (!this.playing) return;
      const t = (this.state.t ?? span[0]) + 1 / FRAMES_PER_SECOND;
      if (t >= span[1]) this.playing = false;
      this.change({ t: t >= span[1] ? null : t });
      if (this.playing) window.setTimeout(step, 1000 / FRAMES_PER_SECOND);
    };
    step();
  }

  /** Updates the list of layers, with a checkbox for each side. */
  showLayers() {
    const sides = this.state.split ? 2 : 1;
    this.layerList.replaceChildren(
      ...this.view.layers.map((layer) => {
        const ticks = Array.from({ length: sides }, (_, side) => {
          const input = element("input", {
            type: "checkbox",
            checked: layer.shown[side],
            title: sides === 1 ? "show" : side ? "right" : "left",
          });
          input.onchange = () => {
            layer.shown[side] = input.checked;
            this.showLayers();
            this.view.invalidate();
          };
          return input;
        });
        const mark = element("span", { className: `mark ${layer.kind}` });
        mark.style.background = layer.kind === "cloud" ? "none" : layer.color;
        return element("div", { className: "layer" }, ...ticks, mark, element("span", { title: layer.name }, layer.name));
      }),
    );
    this.labels.replaceChildren(
      ...Array.from({ length: sides }, (_, side) => {
        const names = this.view.layers.filter((l) => l.kind === "cloud" && l.shown[side]).map((l) => l.name);
        return element("span", {}, names.join(" + "));
      }),
    );
  }

  private showKey() {
    const { colorBy, range } = this.view;
    this.key.hidden = colorBy === "solid";
    const ends = range.map((v) => String(Number(v.toPrecision(4))));
    const bar = element("i", {});
    bar.style.background = cssGradient(rampOf(colorBy));
    this.key.replaceChildren(COLOR_LABEL[colorBy], element("br"), ends[0], bar, ends[1]);
    if (colorBy !== "distance") return;
    const beyond = element("i", { className: "beyond" });
    beyond.style.background = `rgb(${OUTLIER.join(",")})`;
    this.key.append(beyond, `beyond ${this.view.header.outlier_m}`);
  }

  private showStatus() {
    const { view } = this;
    const loaded = view.clouds.reduce((sum, cloud) => sum + cloud.loaded, 0);
    const all = view.header.clouds.reduce((sum, cloud) => sum + cloud.points, 0);
    this.status.textContent =
      `${shortCount(view.drawn)} of ${shortCount(loaded)} points drawn` +
      (loaded < all ? `, ${shortCount(all)} in total` : "") +
      ` (${view.header.frame})`;
  }

  private listenForPicks() {
    const canvas = this.view.renderer.domElement;
    let down: [number, number] = [0, 0];
    canvas.addEventListener("pointerdown", (e) => (down = [e.offsetX, e.offsetY]));
    canvas.addEventListener("pointerup", (e) => {
      if (Math.hypot(e.offsetX - down[0], e.offsetY - down[1]) > CLICK_TOLERANCE_PX) return;
      this.showPoint(e.offsetX, e.offsetY);
    });
  }

  /** Shows the position and the fields of the point under a pixel. */
  showPoint(x: number, y: number) {
    const picked = this.view.pick(x, y);
    this.readout.hidden = !picked;
    if (!picked) return;
    const place = picked.position.toArray().map((v, i) => (v + this.view.header.origin[i]).toFixed(3));
    const values = picked.values.map(
      ({ field, value }) => `${field.name}: ${value === null ? "none" : `${Number(value.toPrecision(4))} ${field.unit}`}`,
    );
    this.readout.replaceChildren(
      ...[picked.cloud.header.name, `x, y, z: ${place.join(", ")} m`, ...values].map((line) => element("div", {}, line)),
    );
  }

  private onKey(event: KeyboardEvent) {
    if (event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement) return;
    const standpoint = { "1": "oblique", "2": "top", "3": "side", "4": "front" }[event.key] as Standpoint | undefined;
    if (standpoint) this.change({ view: standpoint });
    if (event.key === " " && this.view.header.time) {
      event.preventDefault();
      this.play(!this.playing);
    }
  }

  /** Downloads the picture with its color key as a PNG file. */
  async savePicture() {
    this.view.render();
    const source = this.view.renderer.domElement;
    const canvas = element("canvas", { width: source.width, height: source.height });
    const pen = canvas.getContext("2d")!;
    pen.drawImage(source, 0, 0);
    this.drawKey(pen, source.height, this.view.renderer.getPixelRatio());
    const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, "image/png"));
    if (!blob) return;
    const link = element("a", { href: URL.createObjectURL(blob), download: `${this.view.header.title.replace(/[^\w.-]+/g, "_")}.png` });
    link.click();
    URL.revokeObjectURL(link.href);
  }

  private drawKey(pen: CanvasRenderingContext2D, height: number, scale: number) {
    if (this.view.colorBy === "solid") return;
    const [x, y, width] = [14 * scale, height - 26 * scale, 160 * scale];
    const ramp = rampOf(this.view.colorBy);
    for (let i = 0; i < width; ++i) {
      pen.fillStyle = `rgb(${rampColor(ramp, i / width).join(",")})`;
      pen.fillRect(x + i, y, 1.5, 10 * scale);
    }
    pen.fillStyle = this.state.dark ? "#e5e7eb" : "#1c2430";
    pen.font = `${12 * scale}px sans-serif`;
    pen.fillText(
      `${COLOR_LABEL[this.view.colorBy]}: ${this.view.range.map((v) => Number(v.toPrecision(4))).join(" ... ")}`,
      x,
      y - 6 * scale,
    );
  }
}

/**
 * The cut without limits where its ends are at the bounds, so that outliers beyond the bounds stay
 * visible.
 */
function withoutBoundLimits(cut: [Vec3, Vec3], low: Vec3, high: Vec3): [Vec3, Vec3] | null {
  const eps = [0, 1, 2].map((a) => (high[a] - low[a]) / 150);
  const from = cut[0].map((v, a) => (v <= low[a] + eps[a] ? -1e9 : v)) as Vec3;
  const to = cut[1].map((v, a) => (v >= high[a] - eps[a] ? 1e9 : v)) as Vec3;
  return from.every((v) => v === -1e9) && to.every((v) => v === 1e9) ? null : [from, to];
}

export function shortCount(n: number): string {
  if (n >= 1e6) return `${(n / 1e6).toFixed(n < 1e7 ? 2 : 1)} M`;
  return n >= 1e4 ? `${(n / 1e3).toFixed(0)} k` : String(Math.round(n));
}
