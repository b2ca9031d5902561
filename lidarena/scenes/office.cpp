// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/office.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lidarena/base/random.hpp"
#include "lidarena/scenes/mesh_builder.hpp"

namespace lidarena::scenes {
namespace {

using Eigen::Vector3d;

constexpr double kWall = 0.12;                         // m, thickness of walls
constexpr double kGlassPane = 0.01;                    // m
constexpr double kLeaf = 0.04;                         // m, thickness of a door
constexpr double kDoorWidth = 0.9, kDoorHeight = 2.1;  // m
constexpr double kSill = 0.85, kHead = 2.2;            // m, of windows and glass fronts
constexpr double kFlightHeight = 1.3;                  // m, of the route
constexpr double kPointStep = 2.5;                     // m, between its points
constexpr double kTread = 0.28, kRiser = 0.175;        // m, of the stairs

/// What is made of one material.
struct Part {
  const world::Material& material;
  world::TriangleMesh mesh;

  void add(const char* object, const world::TriangleMesh& piece,
           const Pose& placement = Pose::Identity()) {
    mesh.append(shape::painted(piece, material.of(object)), placement);
  }
};

struct Parts {
  Part plaster{world::materials::kPlaster, {}}, glass{world::materials::kGlass, {}},
      wood{world::materials::kWood, {}}, screen{world::materials::kDarkScreen, {}},
      fabric{world::materials::kFabric, {}};
};

/// Offices along one corridor, in a frame whose x is along the corridor and whose y points from the
/// corridor's wall into the offices.
class OfficeRow {
 public:
  OfficeRow(const OfficeConfig& config, const Pose& world_from_row, SequentialRandom& random,
            Parts& parts)
      : config_(config), pose_(world_from_row), random_(random), parts_(parts) {}

  void build() {
    for (int i = 0; i < config_.offices; ++i) {
      const double x = i * config_.office_width_m;
      front(x);
      door(x);
      facade(x);
      furnish(x);
    }
    for (int i = 0; i <= config_.offices; ++i) {
      const double x = i * config_.office_width_m;
      box(parts_.plaster, "wall", {x - 0.5 * kWall, 0, 0},
          {x + 0.5 * kWall, config_.office_depth_m, config_.height_m});
    }
  }

 private:
  void box(Part& part, const char* object, const Vector3d& low, const Vector3d& high) {
    part.add(object, shape::box(low, high), pose_);
  }
  double door_begin(double x) const { return x + config_.office_width_m - 0.3 - kDoorWidth; }

  /// The wall to the corridor: a glass front from wall to door, the door's opening, a lintel.
  void front(double x) {
    const double end = x + config_.office_width_m, door = door_begin(x);
    box(parts_.plaster, "wall", {door + kDoorWidth, -0.5 * kWall, 0}, {end, 0.5 * kWall, kHead});
    box(parts_.plaster, "wall", {door - 0.1, -0.5 * kWall, 0}, {door, 0.5 * kWall, kHead});
    box(parts_.plaster, "wall", {door, -0.5 * kWall, kDoorHeight},
        {door + kDoorWidth, 0.5 * kWall, kHead});
    box(parts_.plaster, "wall", {x, -0.5 * kWall, kHead}, {end, 0.5 * kWall, config_.height_m});
    box(parts_.wood, "baseboard", {x, -0.5 * kWall, 0}, {door - 0.1, 0.5 * kWall, 0.1});
    box(parts_.glass, "window", {x, -0.5 * kGlassPane, 0.1}, {door - 0.1, 0.5 * kGlassPane, kHead});
  }

  /// A leaf that turns into the office about the side towards the wall.
  void door(double x) {
    const bool is_open = random_.uniform() < config_.open_doors;
    const double angle = is_open ? random_.uniform(0.6, 1.5) : 0.0;
    const world::TriangleMesh leaf =
        shape::box({-kDoorWidth, -0.5 * kLeaf, 0.01}, {0, 0.5 * kLeaf, kDoorHeight});
    parts_.wood.add("door",
                    shape::translated(shape::rotated(leaf, -angle, Vector3d::UnitZ()),
                                      {door_begin(x) + kDoorWidth, 0.0, 0.0}),
                    pose_);
  }

  void facade(double x) {
    const double end = x + config_.office_width_m, y = config_.office_depth_m;
    box(parts_.plaster, "wall", {x, y, 0}, {end, y + 2.0 * kWall, kSill});
    box(parts_.plaster, "wall", {x, y, kHead}, {end, y + 2.0 * kWall, config_.height_m});
    box(parts_.glass, "window", {x, y + kWall, kSill}, {end, y + kWall + kGlassPane, kHead});
    for (const double post : {x + config_.office_width_m / 3.0, x + config_.office_width_m / 1.5})
      box(parts_.wood, "window", {post - 0.03, y + 0.05, kSill}, {post + 0.03, y + 0.15, kHead});
  }

  void furnish(double x) {
    const double off = random_.uniform(-0.1, 0.1), depth = config_.office_depth_m;
    const Vector3d desk(x + 0.5 + off, depth - 1.2, 0.0);
    box(parts_.wood, "desk", desk + Vector3d(0, 0, 0.71), desk + Vector3d(1.6, 0.8, 0.74));
    for (const double leg_x : {0.05, 1.5}) {
      for (const double leg_y : {0.05, 0.7})
        box(parts_.wood, "desk", desk + Vector3d(leg_x, leg_y, 0),
            desk + Vector3d(leg_x + 0.05, leg_y + 0.05, 0.71));
    }
    box(parts_.screen, "screen", desk + Vector3d(0.5, 0.6, 0.85), desk + Vector3d(1.1, 0.63, 1.2));
    box(parts_.screen, "screen", desk + Vector3d(0.77, 0.6, 0.74),
        desk + Vector3d(0.83, 0.64, 0.86));
    const Vector3d seat = desk + Vector3d(0.8 + random_.uniform(-0.4, 0.4), -0.45, 0.45);
    parts_.fabric.add(
        "chair", shape::translated(shape::rounded_box({0.5, 0.5, 0.08}, 0.03, 3), seat), pose_);
    box(parts_.fabric, "chair", seat + Vector3d(-0.22, -0.25, 0.1),
        seat + Vector3d(0.22, -0.2, 0.6));
    box(parts_.wood, "chair", seat + Vector3d(-0.03, -0.03, -0.45),
        seat + Vector3d(0.03, 0.03, 0.0));
    for (int shelf = 0; shelf < 5; ++shelf) {
      const double z = 0.1 + 0.42 * shelf;
      const double from = x + 0.5 * kWall, y = 0.7;
      box(parts_.wood, "bookshelf", {from, y, z}, {from + 0.35, y + 1.2, z + 0.02});
      if (shelf < 4) {
        const double filled = random_.uniform(0.2, 1.15);
        box(parts_.fabric, "books", {from + 0.02, y + 0.03, z + 0.02},
            {from + 0.26, y + filled, z + 0.32});
      }
    }
  }

  const OfficeConfig& config_;
  Pose pose_;
  SequentialRandom& random_;
  Parts& parts_;
};

/// The story's core lies on [0, length] x [0, core]; the corridors run around it.
struct Story {
  explicit Story(const OfficeConfig& config)
      : length(config.offices * config.office_width_m),
        core(config.core_m),
        corridor(config.corridor_m),
        depth(config.office_depth_m),
        height(config.height_m) {}
  double length, core, corridor, depth, height;
};

/// Floor, ceiling, the walls at the ends, and those of the cells beside the rows of offices.
void build_frame(const Story& s, Parts& parts) {
  const double x0 = -s.corridor, x1 = s.length + s.corridor;
  const double y0 = -s.corridor - s.depth - 2.0 * kWall,
               y1 = s.core + s.corridor + s.depth + 2.0 * kWall;
  const auto wall = [&](double ax, double ay, double bx, double by) {
    parts.plaster.add("wall", shape::box({ax, ay, 0}, {bx, by, s.height}));
  };
  parts.plaster.add("floor", shape::box({x0 - kWall, y0, -0.2}, {x1 + kWall, y1, 0}));
  parts.plaster.add("ceiling",
                    shape::box({x0 - kWall, y0, s.height}, {x1 + kWall, y1, s.height + 0.2}));
  wall(x0 - kWall, y0, x0, y1);
  wall(x1, y0, x1 + kWall, y1);
  for (const double x : {x0, s.length}) {  // the four corner cells; that of the stairs is open
    wall(x, s.core + s.corridor, x + s.corridor, s.core + s.corridor + kWall);
    if (x != x0) wall(x, -s.corridor - kWall, x + s.corridor, -s.corridor);
    wall(x, y0, x + s.corridor, y0 + 2.0 * kWall);
  }
}

/// The core: plaster with glass fronts, each between two posts.
void build_core(const OfficeConfig& config, const Story& s, Parts& parts) {
  const double bay = config.office_width_m;
  for (const double y : {0.0, s.core - kWall}) {
    parts.plaster.add("wall", shape::box({0, y, kHead}, {s.length, y + kWall, s.height}));
    parts.plaster.add("wall", shape::box({0, y, 0}, {s.length, y + kWall, 0.4}));
    for (int i = 0; i <= config.offices; ++i) {
      const double x = std::min(i * bay, s.length - 0.3);
      parts.plaster.add("wall", shape::box({x, y, 0.4}, {x + 0.3, y + kWall, kHead}));
    }
    const double middle = y + 0.5 * kWall;
    parts.glass.add("window", shape::box({0, middle - 0.5 * kGlassPane, 0.4},
                                         {s.length, middle + 0.5 * kGlassPane, kHead}));
  }
  for (const double x : {0.0, s.length - kWall})
    parts.plaster.add("wall", shape::box({x, 0, 0}, {x + kWall, s.core, s.height}));
}

/// Steps that rise from the corridor at the corner of the story, up to the ceiling.
void build_stairs(const Story& s, Parts& parts) {
  const double begin = -s.corridor - 0.4;
  for (int i = 0; begin - (i + 1) * kTread > -s.corridor - s.depth && (i + 1) * kRiser < s.height;
       ++i) {
    const double y = begin - i * kTread;
    parts.wood.add("stairs", shape::box({-s.corridor, y - kTread, std::max(0.0, (i - 1) * kRiser)},
                                        {-s.corridor + 1.2, y, (i + 1) * kRiser}));
  }
  const double last = -s.corridor - s.depth + 0.3;
  parts.wood.add("stairs", shape::bar({{-s.corridor + 1.2, begin, 0.9},
                                       {-s.corridor + 1.2, last, s.height - 0.1}},
                                      0.025, 8));
}

std::vector<Vector3d> route_around(const Story& s) {
  const double half = 0.5 * s.corridor;
  const std::vector<Vector3d> corners{{-half, -half, kFlightHeight},
                                      {s.length + half, -half, kFlightHeight},
                                      {s.length + half, s.core + half, kFlightHeight},
                                      {-half, s.core + half, kFlightHeight},
                                      {-half, -half, kFlightHeight}};
  std::vector<Vector3d> route{corners.front()};
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const Vector3d step = corners[i] - corners[i - 1];
    const int count = static_cast<int>(std::ceil(step.norm() / kPointStep));
    for (int k = 1; k < count; ++k)
      route.emplace_back(corners[i - 1] + (static_cast<double>(k) / count) * step);
    route.push_back(corners[i]);
  }
  return route;
}

}  // namespace

world::WorldModel make_office(const OfficeConfig& config, std::uint64_t seed) {
  SequentialRandom random(seed, stream_of("office"));
  const Story story(config);
  Parts parts;
  build_frame(story, parts);
  build_core(config, story, parts);
  build_stairs(story, parts);
  const Pose north = make_pose(Eigen::Quaterniond::Identity(), {0, story.core + story.corridor, 0});
  const Pose south =
      make_pose(Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitZ())),
                {story.length, -story.corridor, 0});
  for (const Pose& pose : {north, south}) OfficeRow(config, pose, random, parts).build();
  world::WorldModel model{"office", std::move(parts.plaster.mesh), {route_around(story)}};
  for (const Part* part : {&parts.glass, &parts.wood, &parts.screen, &parts.fabric})
    model.mesh.append(part->mesh);
  return model;
}

}  // namespace lidarena::scenes
