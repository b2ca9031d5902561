// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lidarena::world {

/// The SDF text without elements that have no surface: <scene>, <physics>, <gui>, <plugin>,
/// <material>, <state> and others are overwritten by blanks; line breaks are kept. Strict SDF
/// readers reject a whole world for a color out of range in one of these; Gazebo Classic does not.
/// An element that is not closed is kept, so that the parser reports it.
std::string without_non_geometric_elements(std::string sdf_text);

/// An element of an XML text, by the positions of its parts.
struct Element {
  std::string_view name;
  std::string_view tag;  ///< its start tag, from < to >
  std::size_t end = 0;   ///< behind its end tag
  std::size_t content_begin = 0;
  std::size_t content_end = 0;

  /// Value of an attribute; empty if there is none.
  std::string_view attribute(std::string_view attribute_name) const;
};

/// The first element that begins at or after `from`; empty when there is none that is closed.
std::optional<Element> next_element(std::string_view text, std::size_t from);
/// All elements of this name that are not within another of the same name, at any depth.
std::vector<Element> all_elements(std::string_view text, std::string_view name);
/// Content of the first direct child of this name in the content of an element.
std::optional<std::string_view> child_text(std::string_view content, std::string_view name);

}  // namespace lidarena::world
