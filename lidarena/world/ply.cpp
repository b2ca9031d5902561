// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/ply.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>

#include "lidarena/base/error.hpp"

namespace lidarena {

namespace {

static_assert(std::endian::native == std::endian::little, "binary data is not byte-swapped");

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
enum class Format { kAscii, kLittleEndian, kBigEndian };

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count_type;  ///< of a list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Format format = Format::kAscii;
  std::vector<Element> elements;
  std::vector<Material> palette;  ///< from the comments that save_ply() writes
  std::size_t size = 0;           ///< bytes, up to and including the line end_header
};

std::optional<Type> type_named(const std::string& name) {
  static constexpr std::array<std::pair<std::string_view, Type>, 16> kNames{
      {{"char", Type::kInt8},
       {"int8", Type::kInt8},
       {"uchar", Type::kUint8},
       {"uint8", Type::kUint8},
       {"short", Type::kInt16},
       {"int16", Type::kInt16},
       {"ushort", Type::kUint16},
       {"uint16", Type::kUint16},
       {"int", Type::kInt32},
       {"int32", Type::kInt32},
       {"uint", Type::kUint32},
       {"uint32", Type::kUint32},
       {"float", Type::kFloat32},
       {"float32", Type::kFloat32},
       {"double", Type::kFloat64},
       {"float64", Type::kFloat64}}};
  for (const auto& [known, type] : kNames) {
    if (name == known) return type;
  }
  return std::nullopt;
}

std::optional<Property> parse_property(std::istringstream& words) {
  std::string word;
  Property property{};
  words >> word;
  if (word == "list") {
    words >> word;
    property.count_type = type_named(word);
    if (!property.count_type) return std::nullopt;
    words >> word;
  }
  const auto type = type_named(word);
  if (!type || !(words >> property.name)) return std::nullopt;
  property.type = *type;
  return property;
}

/// The material in a comment written by save_ply(): "material REFLECTIVITY SPECULAR NAME"; empty
/// for other comments.
std::optional<Material> parse_material(std::istringstream& words) {
  std::string keyword;
  Material material;
  words >> keyword >> material.reflectivity >> material.specular >> std::ws;
  const auto is_share = [](double x) { return x >= 0.0 && x <= 1.0; };
  if (keyword != "material" || !std::getline(words, material.name) ||
      !is_share(material.reflectivity) || !is_share(material.specular)) {
    return std::nullopt;
  }
  return material;
}

/// Parses one line of the header; returns false when it is invalid.
bool parse_header_line(const std::string& line, Header& header) {
  std::istringstream words(line);
  std::string keyword;
  words >> keyword;
  if (keyword == "comment") {
    if (const auto material = parse_material(words)) header.palette.push_back(*material);
    return true;
  }
  if (keyword == "obj_info") return true;
  if (keyword == "format") {
    std::string name;
    words >> name;
    if (name == "binary_little_endian") header.format = Format::kLittleEndian;
    if (name == "binary_big_endian") header.format = Format::kBigEndian;
    return name == "ascii" || header.format != Format::kAscii;
  }
  if (keyword == "element") {
    Element element;
    words >> element.name >> element.count;
    header.elements.push_back(element);
    return !words.fail();
  }
  if (keyword != "property" || header.elements.empty()) return false;
  const auto property = parse_property(words);
  if (property) header.elements.back().properties.push_back(*property);
  return property.has_value();
}

Header parse_header(const std::string& bytes, const std::string& name) {
  Header header;
  std::size_t begin = 0;
  for (int line_number = 1;; ++line_number) {
    const std::size_t end = bytes.find('\n', begin);
    if (end == std::string::npos)
      throw InputError(name, "is not a PLY file", "the line 'end_header' is missing");
    std::string line = bytes.substr(begin, end - begin);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    begin = end + 1;
    if (line_number == 1) {
      if (line != "ply") throw InputError(name, "is not a PLY file", "its first line is not 'ply'");
      continue;
    }
    if (line == "end_header") break;
    if (!parse_header_line(line, header)) {
      throw InputError(name + ":" + std::to_string(line_number),
                       "invalid line in the header of a PLY file: " + line);
    }
  }
  header.size = begin;
  return header;
}

/// Reads the values after the header, one at a time.
class Values {
 public:
  Values(const std::string& bytes, const Header& header, const std::string& name)
      : at_(bytes.data() + header.size),
        end_(bytes.data() + bytes.size()),
        format_(header.format),
        name_(name) {}

  double next(Type type) {
    if (format_ == Format::kAscii) return next_word();
    switch (type) {
      case Type::kInt8:
        return next_binary<std::int8_t>();
      case Type::kUint8:
        return next_binary<std::uint8_t>();
      case Type::kInt16:
        return next_binary<std::int16_t>();
      case Type::kUint16:
        return next_binary<std::uint16_t>();
      case Type::kInt32:
        return next_binary<std::int32_t>();
      case Type::kUint32:
        return next_binary<std::uint32_t>();
      case Type::kFloat32:
        return static_cast<double>(next_binary<float>());
      case Type::kFloat64:
        break;
    }
    return next_binary<double>();
  }

  /// Reads a value that is a count or an index.
  std::uint32_t next_index(Type type) {
    const double value = next(type);
    if (!(value >= 0.0 && value <= std::numeric_limits<std::uint32_t>::max()) ||
        value != std::floor(value)) {
      throw InputError(name_, "has " + std::to_string(value) + " in place of a count or an index");
    }
    return static_cast<std::uint32_t>(value);
  }

  std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - at_); }

 private:
  [[noreturn]] void fail_early() const {
    throw InputError(name_, "has fewer values than its header declares",
                     "the file may be truncated; copy it again");
  }

  template <class T>
  T next_binary() {
    if (bytes_left() < sizeof(T)) fail_early();
    std::array<char, sizeof(T)> bytes;
    std::copy_n(at_, sizeof(T), bytes.begin());
    at_ += sizeof(T);
    if (format_ == Format::kBigEndian) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
  }

  double next_word() {
    const auto is_space = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
    at_ = std::find_if_not(at_, end_, is_space);
    if (at_ == end_) fail_early();
    const char* const word_end = std::find_if(at_, end_, is_space);
    double value = 0.0;
    const auto [stop, error] = std::from_chars(at_, word_end, value);
    if (error != std::errc{} || stop != word_end) {
      throw InputError(name_, "'" + std::string(at_, word_end) + "' is not a number");
    }
    at_ = word_end;
    return value;
  }

  const char* at_;
  const char* end_;
  Format format_;
  const std::string& name_;
};

void read_vertices(const Element& element, Values& values, TriangleMesh& mesh) {
  mesh.vertices.reserve(std::min(element.count, values.bytes_left()));
  for (std::size_t i = 0; i < element.count; ++i) {
    Eigen::Vector3d vertex = Eigen::Vector3d::Zero();
    for (const Property& property : element.properties) {
      std::uint32_t count = property.count_type ? values.next_index(*property.count_type) : 1;
      for (; count > 0; --count) {
        const double value = values.next(property.type);
        if (property.name == "x") vertex.x() = value;
        if (property.name == "y") vertex.y() = value;
        if (property.name == "z") vertex.z() = value;
      }
    }
    mesh.vertices.push_back(vertex);
  }
}

/// Reads one row of an element; stores the corners and the material if it is a face.
void read_row(const Element& element, Values& values, std::vector<std::uint32_t>& corners,
              std::uint32_t& material) {
  for (const Property& property : element.properties) {
    const bool holds_corners = property.count_type && (property.name == "vertex_indices" ||
                                                       property.name == "vertex_index");
    const bool holds_material = !property.count_type && property.name == "material_index";
    std::uint32_t count = property.count_type ? values.next_index(*property.count_type) : 1;
    for (; count > 0; --count) {
      if (holds_corners) {
        corners.push_back(values.next_index(property.type));
      } else if (holds_material) {
        material = values.next_index(property.type);
      } else {
        values.next(property.type);
      }
    }
  }
}

/// Reads the rows of an element and keeps those of faces.
void read_faces(const Element& element, Values& values, TriangleMesh& mesh,
                const std::string& name) {
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < element.count; ++i) {
    corners.clear();
    std::uint32_t material = 0;
    read_row(element, values, corners, material);
    if (element.name != "face") continue;
    if (!mesh.palette.empty() && material >= mesh.palette.size()) {
      throw InputError(name, "a face has material index " + std::to_string(material) +
                                 ", number of materials: " + std::to_string(mesh.palette.size()));
    }
    for (std::size_t k = 2; k < corners.size(); ++k) {
      mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
      if (!mesh.palette.empty()) mesh.material_ids.push_back(static_cast<std::uint8_t>(material));
    }
  }
}

void check_indices(const TriangleMesh& mesh, const std::string& name) {
  for (const Triangle& triangle : mesh.triangles) {
    const std::uint32_t largest = *std::ranges::max_element(triangle);
    if (largest >= mesh.vertices.size()) {
      throw InputError(name, "a face has vertex index " + std::to_string(largest) +
                                 ", number of vertices: " + std::to_string(mesh.vertices.size()));
    }
  }
}

}  // namespace

TriangleMesh read_ply(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(name, "cannot be opened", "check the path and the permissions");
  std::ostringstream buffer;
  buffer << in.rdbuf();
  const std::string bytes = std::move(buffer).str();
  const Header header = parse_header(bytes, name);
  Values values(bytes, header, name);
  TriangleMesh mesh;
  mesh.palette = header.palette;
  if (mesh.palette.size() > 256) throw InputError(name, "has more than 256 materials");
  for (const Element& element : header.elements) {
    if (element.properties.empty()) continue;
    if (element.name == "vertex") {
      read_vertices(element, values, mesh);
    } else {
      read_faces(element, values, mesh, name);
    }
  }
  check_indices(mesh, name);
  return mesh;
}

void save_ply(const std::filesystem::path& file, const TriangleMesh& mesh) {
  std::filesystem::path part = file;
  part += ".part";
  std::ofstream out(part, std::ios::binary | std::ios::trunc);
  const bool has_materials = !mesh.material_ids.empty();
  out << "ply\nformat binary_little_endian 1.0\ncomment meters, z up\n";
  for (const Material& material : mesh.palette) {
    out << fmt::format("comment material {} {} {}\n", material.reflectivity, material.specular,
                       material.name);
  }
  out << "element vertex " << mesh.vertices.size()
      << "\nproperty double x\nproperty double y\nproperty double z\n"
      << "element face " << mesh.triangles.size() << "\nproperty list uchar uint vertex_indices\n"
      << (has_materials ? "property uchar material_index\n" : "") << "end_header\n";
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    out.write(reinterpret_cast<const char*>(vertex.data()), 3 * sizeof(double));
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto* corners = reinterpret_cast<const char*>(mesh.triangles[i].data());
    out.put(3).write(corners, sizeof(Triangle));
    if (has_materials) out.put(static_cast<char>(mesh.material_ids[i]));
  }
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(part, file, error);
  if (!out || error) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw Error(file.string() + ": cannot be written; check folder, permissions and free space");
  }
}

}  // namespace lidarena
