// SPDX-License-Identifier: BSD-3-Clause
// Shaders that color, filter and cut the points on the GPU.
import * as THREE from "three";
import { OUTLIER, rampOf, rampTexels } from "./colors";
import type { FieldHeader } from "./scene";

/** Uniforms shared by all clouds; a change takes effect in the next frame. */
export interface PointStyle {
  uColorBy: { value: number }; // index into COLOR_BY
  uRange: { value: THREE.Vector2 };
  uRamp: { value: THREE.DataTexture };
  uTime: { value: THREE.Vector2 }; // interval shown: from, to; s
  uCutMin: { value: THREE.Vector3 };
  uCutMax: { value: THREE.Vector3 };
  uOutliersOnly: { value: number };
  uOutlier: { value: number };
  uPixels: { value: number };
  uSolid: { value: THREE.Color };
}

export const COLOR_BY = ["solid", "height", "distance", "intensity", "time"] as const;
export type ColorBy = (typeof COLOR_BY)[number];

export function makeStyle(outlier_m: number): PointStyle {
  return {
    uColorBy: { value: 0 },
    uRange: { value: new THREE.Vector2(0, 1) },
    uRamp: { value: new THREE.DataTexture(new Uint8Array(1024), 256, 1) },
    uTime: { value: new THREE.Vector2(-Infinity, Infinity) },
    uCutMin: { value: new THREE.Vector3(-1e9, -1e9, -1e9) },
    uCutMax: { value: new THREE.Vector3(1e9, 1e9, 1e9) },
    uOutliersOnly: { value: 0 },
    uOutlier: { value: outlier_m },
    uPixels: { value: 2 },
    uSolid: { value: new THREE.Color("#334155") },
  };
}

export function setColorBy(style: PointStyle, by: ColorBy, range: [number, number]) {
  style.uColorBy.value = COLOR_BY.indexOf(by);
  style.uRange.value.set(...range);
  style.uRamp.value.dispose();
  style.uRamp.value = new THREE.DataTexture(rampTexels(rampOf(by)), 256, 1);
  style.uRamp.value.minFilter = style.uRamp.value.magFilter = THREE.LinearFilter;
  style.uRamp.value.needsUpdate = true;
}

const VERTEX = /* glsl */ `
  uniform int uColorBy;
  uniform vec2 uRange, uTime, uFieldDistance, uFieldIntensity, uFieldTime;
  uniform vec3 uCutMin, uCutMax, uSolid, uOutlierColor;
  uniform float uOutliersOnly, uOutlier, uPixels;
  uniform sampler2D uRamp;
  attribute float a_distance, a_intensity, a_time;
  varying vec3 vColor;

  // 1.0 stands for "no value"
  float decoded(float stored, vec2 field) { return mix(field.x, field.y, stored * 65535.0 / 65534.0); }
  bool missing(float stored) { return stored > 0.999992; }

  void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    bool hidden = any(lessThan(world.xyz, uCutMin)) || any(greaterThan(world.xyz, uCutMax));
    float distance_m = 0.0;
    bool outlier = false;
    #ifdef HAS_DISTANCE
      distance_m = decoded(a_distance, uFieldDistance);
      outlier = missing(a_distance) || distance_m > uOutlier;
      hidden = hidden || (uOutliersOnly > 0.5 && !outlier);
    #endif
    #ifdef HAS_TIME
      float seconds = decoded(a_time, uFieldTime);
      hidden = hidden || seconds < uTime.x || seconds > uTime.y;
    #endif

    float value = world.z;
    bool known = true;
    #ifdef HAS_DISTANCE
      if (uColorBy == 2) value = distance_m;
    #else
      known = known && uColorBy != 2;
    #endif
    #ifdef HAS_INTENSITY
      if (uColorBy == 3) value = decoded(a_intensity, uFieldIntensity);
    #else
      known = known && uColorBy != 3;
    #endif
    #ifdef HAS_TIME
      if (uColorBy == 4) value = seconds;
    #else
      known = known && uColorBy != 4;
    #endif
    float s = clamp((value - uRange.x) / max(uRange.y - uRange.x, 1e-9), 0.0, 1.0);
    vColor = uColorBy == 0 || !known ? uSolid : texture2D(uRamp, vec2(s * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb;
    if (uColorBy == 2 && outlier) vColor = uOutlierColor;
    gl_Position = hidden ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * viewMatrix * world;
    gl_PointSize = uPixels;
  }`;

const FRAGMENT = /* glsl */ `
  varying vec3 vColor;
  void main() { gl_FragColor = vec4(vColor, 1.0); }`;

export function pointMaterial(fields: FieldHeader[], style: PointStyle): THREE.ShaderMaterial {
  const defines: Record<string, string> = {};
  const range = (name: string) => {
    const field = fields.find((f) => f.name === name);
    if (field) defines[`HAS_${name.toUpperCase()}`] = "1";
    return { value: new THREE.Vector2(field?.min ?? 0, field?.max ?? 1) };
  };
  return new THREE.ShaderMaterial({
    uniforms: {
      ...style,
      uFieldDistance: range("distance"),
      uFieldIntensity: range("intensity"),
      uFieldTime: range("time"),
      uOutlierColor: { value: new THREE.Vector3(...OUTLIER).divideScalar(255) },
    } as unknown as Record<string, THREE.IUniform>,
    defines,
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    toneMapped: false,
  });
}
