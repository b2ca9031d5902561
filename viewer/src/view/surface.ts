// SPDX-License-Identifier: BSD-3-Clause
// The mesh: flat shaded, solid, transparent or as a wire frame, cut by the same box as the points.
import * as THREE from "three";
import type { MeshHeader } from "./scene";

export const SURFACE_LOOKS = ["see-through", "solid", "inside", "wire", "hidden"] as const;
export type SurfaceLook = (typeof SURFACE_LOOKS)[number];

export class Surface {
  readonly object: THREE.Mesh;
  private material: THREE.MeshLambertMaterial;

  constructor(
    readonly header: MeshHeader,
    bytes: ArrayBuffer,
    planes: THREE.Plane[],
  ) {
    const geometry = new THREE.BufferGeometry();
    const vertices = new Float32Array(bytes, 0, 3 * header.vertices);
    const triangles = new Uint32Array(bytes, 12 * header.vertices, 3 * header.triangles);
    geometry.setAttribute("position", new THREE.BufferAttribute(vertices, 3));
    geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
    this.material = new THREE.MeshLambertMaterial({
      color: "#9aa7b5",
      flatShading: true,
      side: THREE.DoubleSide,
      clippingPlanes: planes,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    });
    this.object = new THREE.Mesh(geometry, this.material);
  }

  setLook(look: SurfaceLook) {
    const material = this.material;
    material.visible = look !== "hidden";
    material.wireframe = look === "wire";
    material.transparent = look === "see-through" || look === "wire";
    material.opacity = look === "see-through" ? 0.16 : look === "wire" ? 0.35 : 1;
    material.depthWrite = look === "solid" || look === "inside";
    // "inside": seen from outside, near walls are not drawn and far walls show their inner side
    material.side = look === "inside" ? THREE.BackSide : THREE.DoubleSide;
    this.object.renderOrder = material.transparent ? 2 : 0;
    material.needsUpdate = true;
  }
}
