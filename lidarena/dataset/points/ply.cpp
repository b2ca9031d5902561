// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/points/ply.hpp"

#include <fmt/format.h>

#include "lidarena/base/error.hpp"
#include "lidarena/base/ply_reader.hpp"
#include "lidarena/dataset/points/point_file_text.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::dataset {
namespace {

std::vector<Field> vertex_fields(const PlyElement& vertex, const std::string& place) {
  std::vector<Field> fields;
  for (const PlyProperty& property : vertex.properties) {
    if (property.count_type) {
      throw InputError(place, fmt::format("vertices have a list property '{}'", property.name),
                       "write scalar properties only");
    }
    fields.push_back({lower_case(property.name), property.type, 1});
  }
  return fields;
}

}  // namespace

PointTable read_ply_table(const std::filesystem::path& file) {
  return parse_ply_table(read_bytes(file), file.string());
}

PointTable parse_ply_table(std::string_view bytes, const std::string& name) {
  PlyReader reader(bytes, name);
  for (const PlyElement& element : reader.elements()) {
    if (element.name != "vertex") {
      reader.skip(element);
      continue;
    }
    const std::vector<Field> fields = vertex_fields(element, name);
    return {name, reader.packed(element), element.count, row_columns(fields)};
  }
  throw InputError(name, "has no element 'vertex'", "a cloud needs vertices");
}

}  // namespace lidarena::dataset
