// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace lidarena::world {

/// Optical properties of a surface for a LiDAR's light (near infrared, about 905 nm), and the kind
/// of object that it belongs to.
struct Material {
  std::string name = "diffuse";
  double reflectivity = 0.5;  ///< share of the light that is reflected, 0..1
  double specular = 0.0;      ///< share of the reflected light that is mirrored, 0..1
  /// Share of the light that passes the surface, 0..1; a pane that is a box has two surfaces.
  double transmission = 0.0;
  /// Light that a retroreflector returns to its source, relative to a white diffuse surface: pi
  /// times the coefficient R_A of retroreflection (cd/lx/m^2) of its data sheet; 0 for others.
  double retro = 0.0;
  std::string object = {};  ///< e.g. "floor", see semantic_class(); empty: not known
  bool operator==(const Material&) const = default;

  /// The same on another kind of object.
  Material of(std::string kind) const {
    Material material = *this;
    material.object = std::move(kind);
    return material;
  }
};

/// Light returned towards its source, relative to a white diffuse surface at normal incidence. The
/// diffuse part follows Lambert's law, cos(incidence). The mirrored part leaves in a narrow lobe
/// (Phong 1975, normalized: (m + 2) / 2 cos^m of the angle between the source and the mirror
/// direction, which is twice the incidence). A mirror thus returns light near normal incidence
/// only; there the value exceeds 1. A retroreflector's part falls as its projected area does.
inline double backscatter(const Material& material, double cos_incidence) {
  constexpr double kGloss = 200.0;  // exponent m: a lobe about 6 deg wide, as of polished surfaces
  const double cosine = std::clamp(cos_incidence, 0.0, 1.0);
  double gain = 1.0 - material.specular;
  const double to_mirror = 2.0 * cosine * cosine - 1.0;  // cos(2 incidence)
  if (material.specular > 0.0 && to_mirror > 0.0) {
    gain += material.specular * 0.5 * (kGloss + 2.0) * std::pow(to_mirror, kGloss);
  }
  return (material.reflectivity * gain + material.retro) * cosine;
}

/// Share of the light that a surface mirrors: r + (1 - r) (1 - cos(incidence))^5 with r =
/// reflectivity * specular (Schlick 1994, after Fresnel). A smooth surface is a mirror at grazing
/// incidence. One whose specular is below 5 % is rough: it has a sheen and shows no images.
inline double mirrored_share(const Material& material, double cos_incidence) {
  constexpr double kSmooth = 0.05;
  if (material.specular < kSmooth) return 0.0;
  const double normal = material.reflectivity * material.specular;
  return normal + (1.0 - normal) * std::pow(1.0 - std::clamp(cos_incidence, 0.0, 1.0), 5.0);
}

/// Typical values; measured ones vary with product, color and wear.
namespace materials {
inline const Material kDefault;
inline const Material kPlaster{"plaster", 0.8, 0.0};
inline const Material kWood{"wood", 0.5, 0.02};
inline const Material kFabric{"fabric", 0.4, 0.0};
inline const Material kPaper{"paper", 0.7, 0.0};
inline const Material kLeaf{"leaf", 0.5, 0.02};
inline const Material kCeramic{"ceramic", 0.75, 0.1};
inline const Material kMetal{"metal", 0.6, 0.4};
inline const Material kDarkScreen{"dark screen", 0.06, 0.5};
inline const Material kGlass{"glass", 0.08, 0.95, 0.9};
inline const Material kMirror{"mirror", 0.9, 0.999};
inline const Material kRock{"rock", 0.25, 0.0};
inline const Material kWetFloor{"wet floor", 0.2, 0.1};     ///< water mirrors 2 % from above
inline const Material kSign{"sign", 0.5, 0.0, 0.0, 800.0};  ///< sheeting, R_A 250 cd/lx/m^2
}  // namespace materials

}  // namespace lidarena::world
