// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <sstream>
#include <string>

#include "tests/world/shapes.hpp"

/// A box of 1 x 2 x 3 m with a corner at the origin, as the file content in each format.
namespace lidarena::world::testing {

inline TriangleMesh tall_box() { return box_mesh({0, 0, 0}, {1, 2, 3}); }

/// Converts z-up to y-up coordinates.
inline Eigen::Vector3d y_up(const Eigen::Vector3d& v) { return {v.x(), v.z(), -v.y()}; }

/// The six faces as quadrilaterals, so that triangulation is tested, too.
inline std::string box_obj() {
  std::ostringstream out;
  for (const auto& v : tall_box().vertices) out << "v " << v.transpose() << "\n";
  out << "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n";
  return out.str();
}

inline std::string box_stl() {
  std::ostringstream out;
  const TriangleMesh box = tall_box();
  out << "solid box\n";
  for (std::size_t i = 0; i < box.triangles.size(); ++i) {
    out << "facet normal " << box.cross(i).normalized().transpose() << "\nouter loop\n";
    for (const auto corner : box.triangles[i]) {
      out << "vertex " << box.vertices[corner].transpose() << "\n";
    }
    out << "endloop\nendfacet\n";
  }
  out << "endsolid box\n";
  return out.str();
}

/// ASCII, with properties and an element that are irrelevant to the surface.
inline std::string box_ply() {
  std::ostringstream out;
  out << "ply\r\nformat ascii 1.0\r\ncomment a box\r\nelement vertex 8\r\nproperty float x\r\n"
         "property uchar red\r\nproperty float y\r\nproperty float z\r\nelement edge 1\r\n"
         "property int vertex1\r\nproperty int vertex2\r\nelement face 6\r\n"
         "property list uchar int vertex_index\r\nproperty list uchar float texcoord\r\n"
         "end_header\r\n";
  for (const auto& v : tall_box().vertices) {
    out << v.x() << " 255 " << v.y() << " " << v.z() << "\r\n";
  }
  out << "0 1\r\n4 0 4 6 2 0\r\n4 1 3 7 5 2 0.5 0.5\r\n4 0 1 5 4 0\r\n4 2 6 7 3 0\r\n"
         "4 0 2 3 1 0\r\n4 4 5 7 6 0\r\n";
  return out.str();
}

/// The box with coordinates in units of `unit` meters; `nodes` is the content of the scene.
inline std::string dae_text(const std::string& up_axis, double unit, const std::string& nodes) {
  std::ostringstream out;
  out << R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="unit" meter=")"
      << unit << R"("/><up_axis>)" << up_axis << R"(</up_axis></asset>
<library_geometries><geometry id="box" name="box"><mesh>
<source id="positions"><float_array id="numbers" count="24">)";
  const TriangleMesh box = tall_box();
  for (const Eigen::Vector3d& v : box.vertices) {
    out << " " << (up_axis == "Y_UP" ? y_up(v) : v).transpose() / unit;
  }
  out << R"(</float_array><technique_common><accessor source="#numbers" count="8" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source>
<vertices id="vertices"><input semantic="POSITION" source="#positions"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#vertices" offset="0"/><p>)";
  for (const Triangle& t : box.triangles) out << " " << t[0] << " " << t[1] << " " << t[2];
  out << R"(</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="scene">)"
      << nodes << R"(</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene></COLLADA>)";
  return out.str();
}

inline std::string box_dae(const std::string& up_axis, double unit) {
  return dae_text(up_axis, unit,
                  R"(<node id="n" name="node"><instance_geometry url="#box"/></node>)");
}

/// The box, and 10 m further along x a second one, twice as large, in a nested node.
inline std::string two_boxes_dae() {
  return dae_text("Z_UP", 1.0,
                  R"(<node id="a" name="first"><instance_geometry url="#box"/></node>
<node id="outer" name="outer"><translate>10 0 0</translate>
<node id="b" name="second"><scale>2 2 2</scale><instance_geometry url="#box"/></node></node>)");
}

inline std::string base64(const std::string& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      word = word << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

/// glTF 2.0 with an embedded buffer; the format is y up.
inline std::string box_gltf() {
  const TriangleMesh box = tall_box();
  std::string bytes;
  for (const Eigen::Vector3d& v : box.vertices) {
    const Eigen::Vector3f f = y_up(v).cast<float>();
    bytes.append(reinterpret_cast<const char*>(f.data()), sizeof(float) * 3);
  }
  for (const Triangle& t : box.triangles) {
    bytes.append(reinterpret_cast<const char*>(t.data()), sizeof(Triangle));
  }
  std::ostringstream out;
  out << R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0, "name": "box"}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
"accessors": [
{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0, 0, -2], "max": [1, 3, 0]},
{"bufferView": 1, "componentType": 5125, "count": 36, "type": "SCALAR"}],
"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 96},
{"buffer": 0, "byteOffset": 96, "byteLength": 144}],
"buffers": [{"byteLength": 240, "uri": "data:application/octet-stream;base64,)"
      << base64(bytes) << R"("}]})";
  return out.str();
}

}  // namespace lidarena::world::testing
