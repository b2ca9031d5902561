// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/scalar_type.hpp"

namespace lidarena {

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::kFloat32;  ///< of each value
  std::optional<ScalarType> count_type;    ///< of the length of a list; empty for a scalar
};

/// A table of a PLY file: `count` rows with these properties.
struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
};

/// Reads the Polygon File Format (G. Turk, "The PLY Polygon File Format", 1994): ASCII, little and
/// big endian. The elements are read in the order of the header, each either as a whole (packed(),
/// skip()) or row by row (begin_row(), then next() or next_index() for each value, then end_row()).
/// All methods throw InputError that names the file and the line or byte.
class PlyReader {
 public:
  /// Parses the header. `bytes` must outlive this object; `name` is the file's name in messages.
  PlyReader(std::string_view bytes, const std::string& name);

  const std::vector<PlyElement>& elements() const { return elements_; }
  /// The texts of comment lines, without the keyword.
  const std::vector<std::string>& comments() const { return comments_; }

  void begin_row();
  double next(ScalarType type);
  /// A count or an index.
  std::uint32_t next_index(ScalarType type);
  void end_row();

  void skip(const PlyElement& element);
  /// All rows of an element without lists: little-endian values without padding.
  std::string packed(const PlyElement& element);

  /// An upper limit for the number of values that are left.
  std::size_t bytes_left() const { return rest_.size(); }

 private:
  enum class Format { kAscii, kLittleEndian, kBigEndian };

  std::string_view line();
  std::string_view word();
  std::string_view take(std::size_t count, std::size_t size);
  /// "file:line", or "file: byte N" of binary data.
  std::string place() const;
  void parse_header();
  bool parse_header_line(std::string_view line);

  std::string_view rest_;
  std::size_t size_;
  std::string name_;
  std::size_t line_number_ = 0;
  std::vector<std::string_view> words_;  ///< of the current row of an ASCII file
  std::size_t next_word_ = 0;
  Format format_ = Format::kAscii;
  std::vector<PlyElement> elements_;
  std::vector<std::string> comments_;
};

}  // namespace lidarena
