// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/web_page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/report/web_bundle.hpp"

namespace lidarena::report {
namespace {

std::string base64(std::string_view bytes) {
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  for (std::size_t i = 0, out = 0; i < bytes.size(); i += 3, out += 4) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = (group << 8U) | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k <= n; ++k) {
      text[out + k] = kAlphabet[(group >> (18U - 6U * k)) & 63U];
    }
  }
  return text;
}

/// An element with JSON, in which no text can end the element.
std::string json_element(const std::string& id, const Json& json) {
  std::string text;
  for (const char c : json.dump()) text += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return fmt::format("<script type='application/json' id='{}'>{}</script>\n", id, text);
}

/// The page up to the blocks; the script starts while the browser still parses these.
std::string head(const WebPage& page, const char* blocks) {
  if (!has_viewer()) {
    throw Error(
        "this build has no interactive view: install Node.js and npm, run npm ci --prefix viewer, "
        "and configure again with -DLIDARENA_WITH_VIEWER=ON");
  }
  std::string text = fmt::format(
      "<!doctype html><html lang='en' data-blocks='{}'><head><meta charset='utf-8'>"
      "<meta name='viewport' content='width=device-width,initial-scale=1'>"
      "<link rel='icon' href='data:,'><title>{}</title><style>{}</style></head><body>"
      "<noscript>This page needs JavaScript.</noscript>\n",
      blocks, escaped(page.title), web_bundle(page.script + ".css"));
  if (!page.data.is_null()) text += json_element("data", page.data);
  for (std::size_t i = 0; i < page.scenes.size(); ++i) {
    text += json_element(fmt::format("scene-{}", i), page.scenes[i].header);
  }
  return text + fmt::format("<script>{}</script>\n", web_bundle(page.script + ".js"));
}

std::string tail() {
  return fmt::format("<script type='text/plain' id='licenses'>{}</script></body></html>\n",
                     escaped(web_bundle("licenses.txt")));
}

}  // namespace

bool has_viewer() { return !web_bundle("view.js").empty(); }

void write_page(const std::filesystem::path& file, const WebPage& page) {
  const std::string begin = head(page, "page");
  dataset::PartFile out(file);
  out.write(begin);
  for (std::size_t s = 0; s < page.scenes.size(); ++s) {
    const std::vector<std::string>& blocks = page.scenes[s].blocks;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      out.write(fmt::format("<script type='text/plain' id='block-{}-{}'>", s, i));
      out.write(base64(blocks[i]));
      out.write("</script>\n");
    }
  }
  out.write(tail());
  out.commit();
}

std::string served_page(const WebPage& page) { return head(page, "server") + tail(); }

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    out += c == '&'    ? "&amp;"
           : c == '<'  ? "&lt;"
           : c == '>'  ? "&gt;"
           : c == '"'  ? "&quot;"
           : c == '\'' ? "&#39;"
                       : std::string(1, c);
  }
  return out;
}

}  // namespace lidarena::report
