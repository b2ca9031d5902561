// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/view_page.hpp"

#include <fmt/format.h>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/report/image.hpp"
#include "lidarena/report/svg.hpp"
#include "lidarena/report/top_view.hpp"
#include "lidarena/report/web_bundle.hpp"

namespace lidarena::report {
namespace {

constexpr std::size_t kPicturePoints = 400'000;

void need_viewer() {
  if (has_viewer()) return;
  throw Error(
      "this build has no interactive view: install Node.js and npm, run npm ci --prefix viewer, "
      "and "
      "configure again with -DLIDARENA_WITH_VIEWER=ON");
}

/// The page up to the data blocks; the view starts while the browser still parses the blocks.
std::string head(const PackedScene& scene, const std::string& picture, const char* blocks) {
  const std::string title = escaped(scene.header.at("title").get<std::string>());
  const bool timed = !scene.header.at("time").is_null();
  return fmt::format(
      "<!doctype html><html lang='en' data-blocks='{0}'><head><meta charset='utf-8'>"
      "<meta name='viewport' content='width=device-width,initial-scale=1'>"
      "<link rel='icon' href='data:,'><title>{1}</title><style>{2}</style></head><body>"
      "<div id='view' class='lidarena-view page{3}'><div class='fallback'><h1>{1}</h1>"
      "<p class='message'><noscript>The interactive view needs JavaScript.</noscript></p>{4}</div>"
      "<div class='stage'></div><div class='progress'></div></div>"
      "<script type='application/json' id='scene'>{5}</script>\n<script>{6}</script>\n",
      blocks, title, web_bundle("view.css"), timed ? " timed" : "", picture,
      script_json(scene.header), web_bundle("view.js"));
}

std::string tail() {
  return fmt::format("<script type='text/plain' id='licenses'>{}</script></body></html>\n",
                     escaped(web_bundle("licenses.txt")));
}

void append_sampled(dataset::Cloud& picture, const Scene& scene, const SceneCloud& cloud,
                    std::size_t stride) {
  for (std::size_t i = 0; i < cloud.points.size(); i += stride) {
    picture.points.push_back(cloud.points[i] + scene.origin.cast<float>());
    picture.distance.push_back(cloud.distance.empty() ? 0.0F : cloud.distance[i]);
  }
}

}  // namespace

bool has_viewer() { return !web_bundle("view.js").empty(); }

std::string script_json(const Json& json) {
  std::string text;
  for (const char c : json.dump()) text += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return text;
}

std::string scene_picture(const Scene& scene) {
  dataset::Cloud map;
  for (const SceneCloud& cloud : scene.clouds) {
    if (cloud.visible) append_sampled(map, scene, cloud, cloud.points.size() / kPicturePoints + 1);
  }
  if (map.points.empty()) {
    for (const SceneMesh& mesh : scene.meshes) {
      for (const Eigen::Vector3d& vertex : mesh.mesh.vertices) {
        map.points.push_back(vertex.cast<float>());
        map.distance.push_back(0.0F);
      }
    }
  }
  TopView view;
  view.title = scene.title + ", from above";
  view.map = &map;
  for (const ScenePath& path : scene.paths) {
    if (path.role == PathRole::kTruth) view.truth = &path.trajectory;
    if (path.role == PathRole::kTruth || !view.estimate.empty()) continue;
    for (const StampedPose& pose : path.trajectory.poses()) {
      view.estimate.push_back(pose.world_from_body.translation());
    }
  }
  return top_view_svg(view);
}

void write_view_page(const std::filesystem::path& file, const PackedScene& scene,
                     const std::string& picture) {
  need_viewer();
  dataset::PartFile out(file);
  out.write(head(scene, picture, "page"));
  for (std::size_t i = 0; i < scene.blocks.size(); ++i) {
    out.write(fmt::format("<script type='text/plain' id='block-{}'>", i));
    out.write(base64(scene.blocks[i]));
    out.write("</script>\n");
  }
  out.write(tail());
  out.commit();
}

std::string served_view_page(const PackedScene& scene, const std::string& picture) {
  need_viewer();
  return head(scene, picture, "server") + tail();
}

}  // namespace lidarena::report
