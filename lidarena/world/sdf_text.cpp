// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/sdf_text.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

namespace lidarena::world {

namespace {

constexpr std::array<std::string_view, 16> kNonGeometric{"actor",    "atmosphere",
                                                         "audio",    "audio_source",
                                                         "gui",      "inertial",
                                                         "light",    "magnetic_field",
                                                         "material", "physics",
                                                         "plugin",   "scene",
                                                         "sensor",   "spherical_coordinates",
                                                         "state",    "wind"};

struct Tag {
  std::string_view name;  ///< empty for comments and CDATA sections
  std::size_t begin, end;
  bool opens, closes;
};

/// The next tag, comment, CDATA section or declaration at or after `from`.
std::optional<Tag> next_tag(std::string_view text, std::size_t from) {
  const std::size_t begin = text.find('<', from);
  if (begin == std::string_view::npos) return std::nullopt;
  for (const auto& [opening, closing] :
       {std::pair<std::string_view, std::string_view>{"<!--", "-->"}, {"<![CDATA[", "]]>"}}) {
    if (text.substr(begin, opening.size()) != opening) continue;
    const std::size_t end = text.find(closing, begin);
    if (end == std::string_view::npos) return std::nullopt;
    return Tag{{}, begin, end + closing.size(), false, false};
  }
  char quote = '\0';
  std::size_t end = begin + 1;
  for (; end < text.size() && (text[end] != '>' || quote != '\0'); ++end) {
    if (quote != '\0') {
      if (text[end] == quote) quote = '\0';
    } else if (text[end] == '"' || text[end] == '\'') {
      quote = text[end];
    }
  }
  if (end == text.size()) return std::nullopt;
  const bool is_end_tag = text[begin + 1] == '/';
  const std::size_t name_begin = begin + (is_end_tag ? 2 : 1);
  const std::size_t name_end = text.find_first_of(" \t\r\n/>", name_begin);
  return Tag{text.substr(name_begin, name_end - name_begin), begin, end + 1, !is_end_tag,
             is_end_tag || text[end - 1] == '/'};
}

/// Position after the end of the element whose start tag is `opening`; empty when it is not closed.
std::optional<std::size_t> end_of_element(std::string_view text, const Tag& opening) {
  int depth = 0;
  for (std::optional<Tag> tag = opening; tag; tag = next_tag(text, tag->end)) {
    if (tag->name != opening.name) continue;
    depth += (tag->opens ? 1 : 0) - (tag->closes ? 1 : 0);
    if (depth == 0) return tag->end;
  }
  return std::nullopt;
}

}  // namespace

std::string without_non_geometric_elements(std::string sdf_text) {
  std::size_t at = 0;
  while (const auto tag = next_tag(sdf_text, at)) {
    at = tag->end;
    if (!tag->opens || std::ranges::find(kNonGeometric, tag->name) == kNonGeometric.end()) continue;
    const auto end = end_of_element(sdf_text, *tag);
    if (!end) continue;
    for (std::size_t i = tag->begin; i < *end; ++i) {
      if (sdf_text[i] != '\n') sdf_text[i] = ' ';
    }
    at = *end;
  }
  return sdf_text;
}

std::string_view Element::attribute(std::string_view attribute_name) const {
  for (std::size_t at = tag.find(attribute_name); at != std::string_view::npos;
       at = tag.find(attribute_name, at + 1)) {
    const std::size_t equals = tag.find_first_not_of(" \t\r\n", at + attribute_name.size());
    const bool is_name =
        at > 0 && std::string_view(" \t\r\n").find(tag[at - 1]) != std::string_view::npos;
    if (!is_name || equals == std::string_view::npos || tag[equals] != '=') continue;
    const std::size_t quote = tag.find_first_of("\"'", equals);
    if (quote == std::string_view::npos) return {};
    const std::size_t end = tag.find(tag[quote], quote + 1);
    return tag.substr(quote + 1, end - quote - 1);
  }
  return {};
}

std::optional<Element> next_element(std::string_view text, std::size_t from) {
  for (auto tag = next_tag(text, from); tag; tag = next_tag(text, tag->end)) {
    const bool is_declaration = tag->name.starts_with('?') || tag->name.starts_with('!');
    if (!tag->opens || tag->name.empty() || is_declaration) continue;
    Element element{tag->name, text.substr(tag->begin, tag->end - tag->begin), tag->end, tag->end,
                    tag->end};
    if (tag->closes) return element;
    const auto end = end_of_element(text, *tag);
    if (!end) continue;
    element.end = *end;
    element.content_end = text.rfind("</", *end - 1);
    return element;
  }
  return std::nullopt;
}

std::vector<Element> all_elements(std::string_view text, std::string_view name) {
  std::vector<Element> found;
  std::size_t at = 0;
  while (const auto element = next_element(text, at)) {
    at = element->name == name ? element->end : element->content_begin;
    if (element->name == name) found.push_back(*element);
  }
  return found;
}

std::optional<std::string_view> child_text(std::string_view content, std::string_view name) {
  std::size_t at = 0;
  while (const auto element = next_element(content, at)) {
    at = element->end;
    if (element->name == name)
      return content.substr(element->content_begin, element->content_end - element->content_begin);
  }
  return std::nullopt;
}

}  // namespace lidarena::world
