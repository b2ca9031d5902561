// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <utility>

#include "lidarena/base/config.hpp"
#include "lidarena/world/material.hpp"

struct aiMaterial;

namespace lidarena::world {

/// Whether the materials of a mesh file, other than PLY, or of an SDF world are used.
enum class MaterialSource {
  kDefault,  ///< no: every surface is Material{}
  kFile      ///< yes, as file_material() and laser_retro_material() read them
};
constexpr auto enum_names(MaterialSource) {
  return std::array{std::pair{"default", MaterialSource::kDefault},
                    std::pair{"file", MaterialSource::kFile}};
}

/// What a renderer's material means for a LiDAR; colors as luminance 0..1 (Rec. 709).
struct RenderedSurface {
  double diffuse = 0.5;
  double glossy = 0.0;     ///< reflected at normal incidence, beside the diffuse part
  double roughness = 1.0;  ///< 0: a mirror, 1: matt
  double opacity = 1.0;
};

/// Rules: what is not opaque passes, transmission = 1 - opacity; reflectivity = diffuse * opacity +
/// glossy; of the glossy part (1 - roughness)^2 is mirrored. Visible colors stand for the near
/// infrared, where dyes and plants are often brighter.
Material optical_material(const std::string& name, const RenderedSurface& surface);

/// The material of a surface of a mesh file:
///   glTF      diffuse = color (1 - metallic), glossy = 0.04 (1 - metallic) + color * metallic,
///             roughness, opacity = alpha if the mode is BLEND, times 1 - KHR transmission;
///   MTL, DAE  diffuse = Kd, glossy = Ks if Ns is given, opacity = d, and
///             roughness = sqrt(2 / (Ns + 2)) (Walter et al., "Microfacet models for refraction
///             through rough surfaces", EGSR 2007).
/// A color with a texture counts as half. A surface without a material is Material{}.
Material file_material(const aiMaterial& material);

/// The material of SDF's <laser_retro>, an intensity as a LiDAR reports it here: 255 is white, more
/// is a retroreflector. Empty name: 0, which is SDF's value for "not given".
Material laser_retro_material(double laser_retro);

}  // namespace lidarena::world
