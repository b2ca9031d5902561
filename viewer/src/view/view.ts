// SPDX-License-Identifier: BSD-3-Clause
// The 3D view: one canvas, one or two pictures side by side under one camera, drawn on demand.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Cloud, type PickedPoint } from "./cloud";
import { RUN_COLORS, TRUTH } from "./colors";
import { makeStyle, setColorBy, type ColorBy, type PointStyle } from "./point_material";
import type { BlockSource, SceneHeader, Vec3 } from "./scene";
import { Surface, type SurfaceLook } from "./surface";
import { Track } from "./track";

const REST_MS_BEFORE_FULL_DRAW = 250; // all points are drawn this long after the last camera motion
const TARGET_FRAME_MS = 60; // target duration of a frame during camera motion
const SOFTWARE_BUDGET = 1_000_000;
const DEFAULT_BUDGET = 4_000_000;
const PICK_RADIUS_PX = 8;

/** An object that can be shown or hidden on either side. */
export interface Layer {
  name: string;
  kind: "cloud" | "path" | "mesh";
  color: string;
  shown: [boolean, boolean]; // left (or alone), right
  object: THREE.Object3D;
}

export type Standpoint = "top" | "side" | "front" | "oblique";

export class View {
  readonly renderer: THREE.WebGLRenderer;
  readonly camera = new THREE.PerspectiveCamera(50, 1, 0.05, 5000);
  readonly controls: OrbitControls;
  readonly layers: Layer[] = [];
  readonly clouds: Cloud[] = [];
  readonly tracks: Track[] = [];
  readonly surfaces: Surface[] = [];
  readonly style: PointStyle;
  colorBy: ColorBy = "height";
  range: [number, number] = [0, 1];
  split = false;
  private stood: Standpoint | null = null; // null after the user has moved the camera
  budget: number;
  surfaceLook: SurfaceLook = "see-through";
  drawn = 0;
  lastFrame_ms = 0;
  /** Called after each frame. */
  onFrame: () => void = () => undefined;
  private movingBudget: number;
  private scene = new THREE.Scene();
  private planes: THREE.Plane[];
  private lastMove = -Infinity;
  private queued = false;
  private time: [number, number] = [-Infinity, Infinity];

  constructor(
    readonly container: HTMLElement,
    readonly header: SceneHeader,
  ) {
    if (!document.createElement("canvas").getContext("webgl2")) throw new Error("this browser has no WebGL");
    this.renderer = new THREE.WebGLRenderer({ antialias: true, powerPreference: "high-performance" });
    this.renderer.localClippingEnabled = true;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.autoClear = false;
    container.appendChild(this.renderer.domElement);
    this.budget = this.isSoftware() ? SOFTWARE_BUDGET : DEFAULT_BUDGET;
    this.movingBudget = this.budget / 4;
    this.style = makeStyle(header.outlier_m);
    this.planes = [0, 1, 2].flatMap((axis) => [1, -1].map((sign) => new THREE.Plane(new THREE.Vector3().setComponent(axis, sign), 1e9)));
    this.addLights();
    this.setBackground("#f6f7f9");

    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.moved());
    this.controls.addEventListener("start", () => {
      this.stood = null;
    });
    this.standAt("oblique");
    new ResizeObserver(() => this.resize()).observe(container);
    this.resize();
  }

  /** Frees the GPU; the view cannot be used afterwards. */
  dispose() {
    this.queued = true; // draws no further frame
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  private isSoftware(): boolean {
    const gl = this.renderer.getContext();
    const info = gl.getExtension("WEBGL_debug_renderer_info");
    const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
    return /swiftshader|llvmpipe|software/i.test(name);
  }

  private addLights() {
    const sun = new THREE.DirectionalLight("#ffffff", 1.6);
    sun.position.set(0.4, -0.7, 1);
    this.scene.add(sun, new THREE.HemisphereLight("#ffffff", "#8b97a6", 1.7));
  }

  setBackground(color: string) {
    this.scene.background = null;
    this.renderer.setClearColor(color, 1);
    this.invalidate();
  }

  /**
   * Loads and shows everything; clouds appear with their first block, and their density increases.
   */
  async load(source: BlockSource, onProgress: (share: number) => void = () => undefined) {
    const { clouds, meshes, paths, block_bytes } = this.header;
    const total = block_bytes.reduce((sum, bytes) => sum + bytes, 0);
    let done = 0;
    const fetchBlock = async (index: number) => {
      const bytes = await source(index);
      done += block_bytes[index];
      onProgress(total > 0 ? done / total : 1);
      return bytes;
    };
    for (const path of paths) {
      const color = path.role === "truth" ? TRUTH : this.nextPathColor();
      this.addTrack(new Track(path, await fetchBlock(path.block), color, this.size() / 40, this.planes), color);
    }
    for (const mesh of meshes) this.addSurface(new Surface(mesh, await fetchBlock(mesh.block), this.planes));
    if (this.stood) this.standAt(this.stood); // fits the meshes into the picture
    const loads = clouds.map((cloud) => this.addCloud(new Cloud(cloud, this.style)));
    for (let part = 0; loads.some((cloud) => part < cloud.header.blocks.length); ++part) {
      for (const cloud of loads) {
        const block = cloud.header.blocks[part];
        if (block === undefined) continue;
        if (cloud.addBlock(await fetchBlock(block))) this.invalidate();
      }
    }
    this.invalidate();
  }

  private nextPathColor(): string {
    const estimates = this.tracks.filter((track) => track.header.role === "estimate").length;
    return RUN_COLORS[(1 + estimates) % RUN_COLORS.length];
  }

  private addTrack(track: Track, color: string) {
    this.tracks.push(track);
    // the path of a run is shown on the same side as its map
    const { clouds } = this.header;
    const ordinal = clouds.findIndex((cloud) => cloud.name === track.header.name);
    const shown: [boolean, boolean] = ordinal < 0 ? [true, true] : [clouds[ordinal].visible, ordinal === 1 || clouds.length === 1];
    this.addLayer({ name: track.header.name, kind: "path", color, shown, object: track.object });
    track.setTime(...this.time);
  }

  private addSurface(surface: Surface) {
    surface.setLook(this.surfaceLook);
    this.surfaces.push(surface);
    this.addLayer({ name: surface.header.name, kind: "mesh", color: "#9aa7b5", shown: [true, true], object: surface.object });
  }

  private addCloud(cloud: Cloud): Cloud {
    this.clouds.push(cloud);
    // side by side, the first cloud is shown on the left and the second on the right
    const ordinal = this.clouds.length - 1;
    const shown: [boolean, boolean] = [cloud.header.visible, this.header.clouds.length > 1 ? ordinal === 1 : true];
    this.addLayer({ name: cloud.header.name, kind: "cloud", color: RUN_COLORS[ordinal % RUN_COLORS.length], shown, object: cloud.group });
    return cloud;
  }

  private addLayer(layer: Layer) {
    this.layers.push(layer);
    this.scene.add(layer.object);
    this.invalidate();
  }

  /** Diagonal of what is shown, m. */
  size(): number {
    const [low, high] = this.header.bounds;
    return Math.max(Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]), 0.1);
  }

  /**
   * Box to fit into the picture: the meshes if there are any, because the map of a diverged run
   * extends far beyond them; else everything.
   */
  private framed(): THREE.Box3 {
    const box = new THREE.Box3();
    for (const surface of this.surfaces) box.expandByObject(surface.object);
    const [low, high] = this.header.bounds.map((v) => new THREE.Vector3(...v));
    return box.isEmpty() ? new THREE.Box3(low, high) : box;
  }

  standAt(standpoint: Standpoint) {
    const box = this.framed();
    const center = box.getCenter(new THREE.Vector3());
    const direction = {
      top: new THREE.Vector3(0, -1e-3, 1),
      side: new THREE.Vector3(1, 0, 0.02),
      front: new THREE.Vector3(0, -1, 0.02),
      oblique: new THREE.Vector3(-0.55, -0.9, 0.95),
    }[standpoint].normalize();
    this.camera.position.copy(center).addScaledVector(direction, this.distanceToFit(box, direction));
    this.controls.target.copy(center);
    this.controls.update();
    this.stood = standpoint;
    this.invalidate();
  }

  /** Camera distance from the box's center at which the box just fills the picture. */
  private distanceToFit({ min, max }: THREE.Box3, direction: THREE.Vector3): number {
    const half = max.clone().sub(min).multiplyScalar(0.5);
    const right = new THREE.Vector3().crossVectors(this.camera.up, direction).normalize();
    const up = new THREE.Vector3().crossVectors(direction, right);
    const slopeY = Math.tan((this.camera.fov * Math.PI) / 360);
    const slopeX = slopeY * this.aspect();
    let distance = 0.1;
    for (let corner = 0; corner < 8; ++corner) {
      const p = new THREE.Vector3(...([1, 2, 4].map((bit) => (corner & bit ? 1 : -1)) as Vec3)).multiply(half);
      const reach = Math.max(Math.abs(p.dot(right)) / slopeX, Math.abs(p.dot(up)) / slopeY);
      distance = Math.max(distance, p.dot(direction) + 1.04 * reach);
    }
    return distance;
  }

  private aspect(): number {
    const { clientWidth, clientHeight } = this.container;
    return ((this.split ? 0.5 : 1) * clientWidth) / Math.max(clientHeight, 1);
  }

  setColorBy(by: ColorBy, range: [number, number]) {
    this.colorBy = by;
    this.range = range;
    setColorBy(this.style, by, range);
    for (const track of this.tracks) track.setErrorColors(by === "distance" ? range[1] : null);
    this.invalidate();
  }

  /** Shows only what was measured from `from` to `to`, in seconds since the scene's time origin. */
  setTime(from: number, to: number) {
    this.time = [from, to];
    this.style.uTime.value.set(from, to);
    for (const track of this.tracks) track.setTime(from, to);
    this.invalidate();
  }

  /** Hides everything outside the box. */
  setCut(low: Vec3, high: Vec3) {
    this.style.uCutMin.value.set(...low);
    this.style.uCutMax.value.set(...high);
    this.planes.forEach((plane, i) => {
      const axis = i >> 1;
      plane.constant = i % 2 === 0 ? -low[axis] : high[axis];
    });
    this.invalidate();
  }

  setSurfaceLook(look: SurfaceLook) {
    this.surfaceLook = look;
    for (const surface of this.surfaces) surface.setLook(look);
    this.invalidate();
  }

  setSplit(split: boolean) {
    this.split = split;
    this.invalidate();
  }

  private moved() {
    this.lastMove = performance.now();
    window.setTimeout(() => this.invalidate(), REST_MS_BEFORE_FULL_DRAW + 10);
    this.invalidate();
  }

  private resize() {
    const { clientWidth, clientHeight } = this.container;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight);
    if (this.stood) this.standAt(this.stood); // keeps everything in the picture
    this.invalidate();
  }

  /** Requests a new frame. */
  invalidate() {
    if (this.queued) return;
    this.queued = true;
    requestAnimationFrame(() => {
      this.queued = false;
      this.render();
      this.onFrame();
    });
  }

  render() {
    const begin = performance.now();
    const moving = begin - this.lastMove < REST_MS_BEFORE_FULL_DRAW;
    const { clientWidth: width, clientHeight: height } = this.container;
    const sides = this.split ? 2 : 1;
    this.renderer.setScissorTest(false);
    this.renderer.clear();
    this.renderer.setScissorTest(true);
    this.camera.aspect = this.aspect();
    this.setDepthRange();
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.drawn = 0;
    for (let side = 0; side < sides; ++side) {
      const left = Math.round((side * width) / sides);
      const share = Math.round(((side + 1) * width) / sides) - left;
      this.renderer.setViewport(left, 0, share, height);
      this.renderer.setScissor(left, 0, share, height);
      for (const layer of this.layers) layer.object.visible = layer.shown[side];
      this.drawn += this.planPoints((moving ? Math.min(this.movingBudget, this.budget) : this.budget) / sides);
      this.renderer.render(this.scene, this.camera);
    }
    if (moving) {
      this.finish();
      this.adapt(performance.now() - begin);
    }
    this.lastFrame_ms = performance.now() - begin;
  }

  /**
   * Waits until everything is drawn. Browsers treat gl.finish() as a flush, but reading a pixel
   * back waits for the GPU.
   */
  finish() {
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  /**
   * Sets near and far planes around the scene, so that the depth resolution suffices at any camera
   * position.
   */
  private setDepthRange() {
    const [low, high] = this.header.bounds.map((v) => new THREE.Vector3(...v));
    const center = low.clone().add(high).multiplyScalar(0.5);
    const distance = this.camera.position.distanceTo(center);
    this.camera.far = distance + 4 * this.size();
    this.camera.near = Math.max(distance - 2 * this.size(), this.size() / 2000);
  }

  private planPoints(budget: number): number {
    const frustum = new THREE.Frustum().setFromProjectionMatrix(this.toClip());
    const shown = this.clouds.filter((cloud) => cloud.group.visible);
    const inSight = shown.reduce((sum, cloud) => sum + cloud.inSight(frustum), 0);
    const share = inSight > budget ? budget / inSight : 1;
    return shown.reduce((sum, cloud) => sum + cloud.plan(frustum, share), 0);
  }

  private toClip(): THREE.Matrix4 {
    return new THREE.Matrix4().multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse);
  }

  private adapt(frame_ms: number) {
    const factor = Math.min(Math.max(TARGET_FRAME_MS / Math.max(frame_ms, 1), 0.5), 1.25);
    this.movingBudget = Math.min(Math.max(this.movingBudget * factor, 50_000), this.budget);
  }

  /** Projects a point of the scene into the picture (of `side`), in pixels from the top left. */
  project(point: Vec3, side = 0): [number, number] {
    const { clientWidth, clientHeight } = this.container;
    const width = this.split ? clientWidth / 2 : clientWidth;
    const p = new THREE.Vector3(...point).applyMatrix4(this.toClip());
    return [side * width + (0.5 + 0.5 * p.x) * width, (0.5 - 0.5 * p.y) * clientHeight];
  }

  /** The visible point under a pixel, or null. */
  pick(x: number, y: number): PickedPoint | null {
    const { clientWidth, clientHeight } = this.container;
    const width = this.split ? clientWidth / 2 : clientWidth;
    const side = this.split && x > width ? 1 : 0;
    let best: PickedPoint | null = null;
    for (const layer of this.layers) layer.object.visible = layer.shown[side];
    for (const cloud of this.clouds) {
      if (!cloud.group.visible) continue;
      const found = cloud.pick(this.toClip(), width, clientHeight, x - side * width, y, PICK_RADIUS_PX, (p) => this.isShown(p));
      const nearer = (p: PickedPoint) => p.position.distanceTo(this.camera.position);
      if (found && (!best || nearer(found) < nearer(best))) best = found;
    }
    return best;
  }

  /** Whether a point passes the filters of the shader (cut, time, outliers only). */
  private isShown(point: PickedPoint): boolean {
    const { uCutMin, uCutMax, uTime, uOutliersOnly, uOutlier } = this.style;
    if (!new THREE.Box3(uCutMin.value, uCutMax.value).containsPoint(point.position)) return false;
    for (const { field, value } of point.values) {
      if (field.name === "time" && value !== null && (value < uTime.value.x || value > uTime.value.y)) return false;
      if (field.name === "distance" && uOutliersOnly.value > 0.5 && value !== null && value <= uOutlier.value) return false;
    }
    return true;
  }
}
