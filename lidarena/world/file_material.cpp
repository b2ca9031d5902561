// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/file_material.hpp"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace lidarena::world {
namespace {

constexpr double kWhiteIntensity = 255.0;  // of a white diffuse surface at normal incidence
constexpr double kDielectricGloss = 0.04;  // at normal incidence, of glTF
constexpr double kTextureMean = 0.5;       // of a color that a texture multiplies

double luminance(const aiColor4D& c) {
  const double y = 0.2126 * static_cast<double>(c.r) + 0.7152 * static_cast<double>(c.g) +
                   0.0722 * static_cast<double>(c.b);
  return std::clamp(y, 0.0, 1.0);
}

double number(const aiMaterial& material, const char* key, unsigned type, unsigned index,
              double otherwise) {
  ai_real value = 0;
  return material.Get(key, type, index, value) == aiReturn_SUCCESS ? static_cast<double>(value)
                                                                   : otherwise;
}

double color(const aiMaterial& material, const char* key, unsigned type, unsigned index,
             double otherwise) {
  aiColor4D value;
  return material.Get(key, type, index, value) == aiReturn_SUCCESS ? luminance(value) : otherwise;
}

bool is_blended(const aiMaterial& material) {
  aiString mode;
  return material.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == aiReturn_SUCCESS &&
         std::string(mode.C_Str()) == "BLEND";
}

RenderedSurface from_gltf(const aiMaterial& material, double metallic) {
  const bool has_texture = material.GetTextureCount(aiTextureType_BASE_COLOR) > 0 ||
                           material.GetTextureCount(aiTextureType_DIFFUSE) > 0;
  const double base =
      color(material, AI_MATKEY_BASE_COLOR, 1.0) * (has_texture ? kTextureMean : 1.0);
  const double alpha = is_blended(material) ? number(material, AI_MATKEY_OPACITY, 1.0) : 1.0;
  return {.diffuse = base * (1.0 - metallic),
          .glossy = kDielectricGloss * (1.0 - metallic) + base * metallic,
          .roughness = number(material, AI_MATKEY_ROUGHNESS_FACTOR, 1.0),
          .opacity = alpha * (1.0 - number(material, AI_MATKEY_TRANSMISSION_FACTOR, 0.0))};
}

RenderedSurface from_phong(const aiMaterial& material) {
  const bool has_texture = material.GetTextureCount(aiTextureType_DIFFUSE) > 0;
  const double exponent = number(material, AI_MATKEY_SHININESS, 0.0);
  return {
      .diffuse = color(material, AI_MATKEY_COLOR_DIFFUSE, 1.0) * (has_texture ? kTextureMean : 1.0),
      .glossy = exponent > 0.0 ? color(material, AI_MATKEY_COLOR_SPECULAR, 0.0) : 0.0,
      .roughness = std::min(1.0, std::sqrt(2.0 / (exponent + 2.0))),
      .opacity = number(material, AI_MATKEY_OPACITY, 1.0)};
}

/// Whether the importer made the material, for surfaces that have none.
bool is_missing(const aiMaterial& material, const std::string& name, bool has_metallic) {
  if (!has_metallic) return name == AI_DEFAULT_MATERIAL_NAME;
  return name.empty() && number(material, AI_MATKEY_METALLIC_FACTOR, 1.0) == 1.0 &&
         number(material, AI_MATKEY_ROUGHNESS_FACTOR, 1.0) == 1.0 &&
         color(material, AI_MATKEY_BASE_COLOR, 1.0) == 1.0;
}

}  // namespace

Material optical_material(const std::string& name, const RenderedSurface& surface) {
  const auto share = [](double x) { return std::clamp(x, 0.0, 1.0); };
  const double opacity = share(surface.opacity);
  const double reflectivity = share(share(surface.diffuse) * opacity + share(surface.glossy));
  const double mirrored = share(surface.glossy) * std::pow(1.0 - share(surface.roughness), 2);
  const double specular = reflectivity > 0.0 ? share(mirrored / reflectivity) : 0.0;
  return {name, reflectivity, specular, 1.0 - opacity};
}

Material file_material(const aiMaterial& material) {
  aiString text;
  material.Get(AI_MATKEY_NAME, text);
  const std::string name = text.C_Str();
  ai_real metallic = 1;
  const bool has_metallic = material.Get(AI_MATKEY_METALLIC_FACTOR, metallic) == aiReturn_SUCCESS;
  if (is_missing(material, name, has_metallic)) return {};
  return optical_material(
      name.empty() ? "unnamed" : name,
      has_metallic ? from_gltf(material, static_cast<double>(metallic)) : from_phong(material));
}

Material laser_retro_material(double laser_retro) {
  const double share = std::max(0.0, laser_retro) / kWhiteIntensity;
  return {laser_retro > 0.0 ? "laser_retro" : "", std::min(1.0, share), 0.0, 0.0,
          std::max(0.0, share - 1.0)};
}

}  // namespace lidarena::world
