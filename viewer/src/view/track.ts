// SPDX-License-Identifier: BSD-3-Clause
// A trajectory: a line up to the chosen instant and a marker of the body's axes there.
import * as THREE from "three";
import { rampColor, rampOf } from "./colors";
import type { PathHeader } from "./scene";

const AXIS_COLORS = ["#d62027", "#2f9e44", "#1c64d1"];

export class Track {
  readonly object = new THREE.Group();
  private line: THREE.Line;
  private material: THREE.LineBasicMaterial;
  private marker = new THREE.Group();
  private positions: Float32Array;
  private times: Float32Array;
  private orientations: Float32Array;
  readonly errors: Float32Array | null;
  private readonly color: string;

  constructor(
    readonly header: PathHeader,
    bytes: ArrayBuffer,
    color: string,
    markerLength: number,
    planes: THREE.Plane[],
  ) {
    this.color = color;
    const n = header.poses;
    const column = (begin: number, width: number) => new Float32Array(bytes, 4 * n * begin, n * width);
    this.positions = column(0, 3);
    this.times = column(3, 1);
    this.orientations = column(4, 4);
    this.errors = header.has_error ? column(8, 1) : null;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(this.positions, 3));
    this.material = new THREE.LineBasicMaterial({ color, clippingPlanes: planes, depthTest: false, transparent: true });
    this.line = new THREE.Line(geometry, this.material);
    this.line.frustumCulled = false;
    this.line.renderOrder = 5; // drawn over everything, because a map would hide a path inside it
    this.object.add(this.line, this.marker);
    AXIS_COLORS.forEach((axisColor, axis) => this.marker.add(axisLine(axis, markerLength, axisColor)));
  }

  /** Draws the path from `from` to `to` and puts the marker at its last pose. */
  setTime(from: number, to: number) {
    const begin = upperBound(this.times, from - 1e-9);
    const end = upperBound(this.times, to + 1e-6);
    this.line.geometry.setDrawRange(begin, Math.max(end - begin, 0));
    this.marker.visible = end > 0 && end < this.times.length;
    if (!this.marker.visible) return;
    const i = end - 1;
    this.marker.position.fromArray(this.positions, 3 * i);
    this.marker.quaternion.fromArray(this.orientations, 4 * i);
  }

  /** Colors the line by its error, 0 ... `full` meters; null restores the single color. */
  setErrorColors(full: number | null) {
    const byError = full !== null && this.errors !== null;
    if (byError) {
      const colors = new Float32Array(3 * this.header.poses);
      const color = new THREE.Color();
      this.errors!.forEach((error, i) => {
        const [r, g, b] = rampColor(rampOf("distance"), error / full!);
        color.setRGB(r / 255, g / 255, b / 255).toArray(colors, 3 * i);
      });
      this.line.geometry.setAttribute("color", new THREE.BufferAttribute(colors, 3));
    }
    this.material.vertexColors = byError;
    this.material.color.set(byError ? "#ffffff" : this.color);
    this.material.needsUpdate = true;
  }
}

function axisLine(axis: number, length: number, color: string): THREE.Line {
  const end = new THREE.Vector3().setComponent(axis, length);
  const geometry = new THREE.BufferGeometry().setFromPoints([new THREE.Vector3(), end]);
  return new THREE.Line(geometry, new THREE.LineBasicMaterial({ color, depthTest: false }));
}

/** Index of the first value above `x` in an ascending list. */
function upperBound(values: Float32Array, x: number): number {
  let low = 0;
  let high = values.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] > x) high = middle;
    else low = middle + 1;
  }
  return low;
}
