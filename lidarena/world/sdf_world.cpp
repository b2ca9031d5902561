// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/sdf_world.hpp"

#include "lidarena/base/error.hpp"

#if LIDARENA_HAVE_SDF

#include <fmt/format.h>

#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <sdf/sdf.hh>
#include <sstream>

#include "lidarena/world/mesh_io.hpp"
#include "lidarena/world/model_folders.hpp"
#include "lidarena/world/primitives.hpp"
#include "lidarena/world/sdf_state.hpp"
#include "lidarena/world/sdf_text.hpp"
#include "lidarena/world/standard_models.hpp"

namespace lidarena::world {

namespace fs = std::filesystem;

namespace {

Eigen::Vector3d to_eigen(const ignition::math::Vector3d& v) { return {v.X(), v.Y(), v.Z()}; }

Pose to_eigen(const ignition::math::Pose3d& pose) {
  const auto& q = pose.Rot();
  return make_pose(Eigen::Quaterniond(q.W(), q.X(), q.Y(), q.Z()), to_eigen(pose.Pos()));
}

/// The value of a visual or a collision; 0 if it has none.
template <class Shape>
double laser_retro_of(const Shape& shape) {
  const sdf::ElementPtr element = shape.Element();
  return element && element->HasElement("laser_retro") ? element->Get<double>("laser_retro") : 0.0;
}

using FindFile = std::function<std::string(const std::string&)>;

/// Workaround for sdformat 12, which looks up an <include> inside an included file by its
/// process-wide configuration instead of the one that was passed (its issue 881). During the
/// lifetime of this object the process-wide configuration finds files by `find`, too; a mutex
/// serializes concurrent loads.
class GlobalFindFile {
 public:
  explicit GlobalFindFile(FindFile find)
      : lock_(mutex()), before_(sdf::ParserConfig::GlobalConfig().FindFileCallback()) {
    sdf::ParserConfig::GlobalConfig().SetFindCallback(std::move(find));
  }
  ~GlobalFindFile() { sdf::ParserConfig::GlobalConfig().SetFindCallback(before_); }
  GlobalFindFile(const GlobalFindFile&) = delete;
  GlobalFindFile& operator=(const GlobalFindFile&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex mutex;
    return mutex;
  }
  std::lock_guard<std::mutex> lock_;
  FindFile before_;
};

/// Collects a world's shapes into one mesh. Missing models and meshes are collected, too, so that
/// one message can list all of them.
class SdfLoader {
 public:
  SdfLoader(const fs::path& file, const SdfOptions& options, LogSink& log)
      : file_(file), options_(options), log_(log), folders_(file, options.model_paths) {}

  TriangleMesh load() {
    const sdf::Root root = parse();
    if (!options_.allow_missing) report_missing();  // of models, before meshes are loaded
    if (const sdf::Model* model = root.Model()) add_model(*model, pose_of(*model), "");
    for (std::uint64_t i = 0; i < root.WorldCount(); ++i) add_world(*root.WorldByIndex(i));
    report_missing();
    if (mesh_.empty()) {
      const bool is_visual = options_.shapes == ShapeKind::kVisual;
      throw InputError(file_.string(),
                       is_visual ? "has no visual shapes" : "has no collision shapes",
                       is_visual ? "try shapes: collision" : "try shapes: visual");
    }
    return std::move(mesh_);
  }

 private:
  sdf::Root parse();
  void check_errors(const sdf::Errors& errors);
  void add_world(const sdf::World& world);
  void add_model(const sdf::Model& model, const Pose& world_from_model, const std::string& scope);
  Pose pose_of(const sdf::Model& model) const;
  void add_link(const sdf::Link& link, const Pose& world_from_link, const std::string& name);
  template <class Shape>
  void add_shape(const Shape& shape, const Pose& world_from_link, const std::string& name);
  void add_mesh(const sdf::Mesh& shape, const Pose& world_from_shape, const std::string& name);
  const std::vector<MeshPart>& parts_of(const fs::path& mesh_file);
  void add(TriangleMesh surface, const Pose& placement,
           const Eigen::Vector3d& scale = Eigen::Vector3d::Ones());
  Pose resolved(const sdf::SemanticPose& pose, const std::string& name) const;
  void add_polyline(const sdf::ElementPtr& polyline, const Pose& world_from_shape);
  void add_missing(const std::string& what) { ++missing_[what]; }
  void report_missing();

  fs::path file_;
  const SdfOptions& options_;
  LogSink& log_;
  ModelFolders folders_;
  TriangleMesh mesh_;
  std::map<fs::path, std::vector<MeshPart>> mesh_files_;  ///< each read once
  std::map<std::string, int> missing_;                    ///< what is missing, and how many times
  std::vector<std::string> unsupported_;                  ///< shapes of kinds that are not read
  SavedState state_;
  double laser_retro_ = 0.0;  ///< of the current shape; 0: not given
};

void SdfLoader::add(TriangleMesh surface, const Pose& placement, const Eigen::Vector3d& scale) {
  if (laser_retro_ > 0.0) surface.paint(laser_retro_material(laser_retro_));
  mesh_.append(surface, placement, scale);
}

sdf::Root SdfLoader::parse() {
  std::ifstream in(file_);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in || !fs::is_regular_file(file_)) {
    throw InputError(file_.string(), "cannot be opened", "check the path and the permissions");
  }
  state_ = saved_state(text.str());
  if (state_.has_scales)
    log_.warn(file_.string() + ": its <state> scales models, which is not applied");
  if (const auto left_out = unsupported_elements(text.str()); !left_out.empty()) {
    log_.warn(fmt::format("{}: left out: {}; these are not supported, put models in their place",
                          file_.string(), fmt::join(left_out, ", ")));
  }
  const GroundPlaneFile ground_plane;
  const FindFile find = [&](const std::string& uri) -> std::string {
    const auto path = folders_.find(uri, fs::absolute(file_).parent_path());
    if (path) return path->string();
    const StandardModel standard = standard_model(uri);
    if (standard == StandardModel::kGroundPlane) return ground_plane.path().string();
    if (standard == StandardModel::kNone) add_missing(uri);
    return {};
  };
  sdf::ParserConfig config;
  config.SetFindCallback(find);
  const GlobalFindFile for_nested_includes(find);
  sdf::Console::Instance()->SetQuiet(true);  // its messages are also returned as errors
  sdf::Root root;
  check_errors(root.LoadSdfString(without_non_geometric_elements(text.str()), config));
  if (root.WorldCount() == 0 && root.Model() == nullptr) {
    throw InputError(file_.string(), "contains neither an SDF world nor an SDF model");
  }
  return root;
}

/// Throws (or warns, if `allow_missing`) on errors of sdformat. It omits a model with errors from
/// the world, so most errors mean that something is missing from the world.
void SdfLoader::check_errors(const sdf::Errors& errors) {
  for (const sdf::Error& error : errors) {
    switch (error.Code()) {
      case sdf::ErrorCode::LINK_INERTIA_INVALID:  // irrelevant to shapes
      case sdf::ErrorCode::VERSION_DEPRECATED:
      case sdf::ErrorCode::ELEMENT_DEPRECATED:
      case sdf::ErrorCode::ATTRIBUTE_DEPRECATED:
      case sdf::ErrorCode::URI_LOOKUP:  // already recorded by the find callback
        continue;
      default:
        break;
    }
    if (error.Message() == "Failed to load a world.") continue;  // implied by the other errors
    const std::string place = error.LineNumber()
                                  ? fmt::format("{}:{}", file_.string(), *error.LineNumber())
                                  : file_.string();
    if (!options_.allow_missing) throw InputError(place, error.Message());
    log_.warn(place + ": " + error.Message());
  }
}

Pose SdfLoader::resolved(const sdf::SemanticPose& pose, const std::string& name) const {
  ignition::math::Pose3d resolved;
  const sdf::Errors errors = pose.Resolve(resolved);
  if (errors.empty()) return to_eigen(resolved);
  throw InputError(file_.string(),
                   "the pose of " + name + " cannot be resolved: " + errors.front().Message());
}

void SdfLoader::add_world(const sdf::World& world) {
  for (std::uint64_t i = 0; i < world.ModelCount(); ++i) {
    const sdf::Model& model = *world.ModelByIndex(i);
    log_.progress("loading models", static_cast<double>(i),
                  static_cast<double>(world.ModelCount()));
    add_model(model, resolved(model.SemanticPose(), model.Name()), "");
  }
}

/// Pose of the model that is the root of a file: it places the frame named by placement_frame.
Pose SdfLoader::pose_of(const sdf::Model& model) const {
  const Pose placed = to_eigen(model.RawPose());
  const std::string& frame = model.PlacementFrameName();
  if (frame.empty()) return placed;
  const sdf::Link* link = model.LinkByName(frame);
  const sdf::Frame* other = model.FrameByName(frame);
  if (link != nullptr) return placed * resolved(link->SemanticPose(), frame).inverse();
  if (other != nullptr) return placed * resolved(other->SemanticPose(), frame).inverse();
  throw InputError(file_.string(), "has no link or frame '" + frame + "', its placement_frame");
}

/// `scope` is the name of the model that this one is nested in, with "::", as in a saved state.
void SdfLoader::add_model(const sdf::Model& model, const Pose& world_from_model,
                          const std::string& scope) {
  const std::string scoped = scope + model.Name();
  const auto saved = state_.models.find(scoped);
  const Pose& world_from_this = saved == state_.models.end() ? world_from_model : saved->second;
  for (std::uint64_t i = 0; i < model.LinkCount(); ++i) {
    const sdf::Link& link = *model.LinkByIndex(i);
    const std::string name = model.Name() + "/" + link.Name();
    const auto saved_link = state_.links.find(scoped + "::" + link.Name());
    const Pose placed = saved_link == state_.links.end()
                            ? world_from_this * resolved(link.SemanticPose(), name)
                            : saved_link->second;
    add_link(link, placed, name);
  }
  for (std::uint64_t i = 0; i < model.ModelCount(); ++i) {
    const sdf::Model& nested = *model.ModelByIndex(i);
    add_model(nested, world_from_this * resolved(nested.SemanticPose(), nested.Name()),
              scoped + "::");
  }
}

void SdfLoader::add_link(const sdf::Link& link, const Pose& world_from_link,
                         const std::string& name) {
  if (options_.shapes == ShapeKind::kVisual) {
    for (std::uint64_t i = 0; i < link.VisualCount(); ++i) {
      add_shape(*link.VisualByIndex(i), world_from_link, name);
    }
  } else {
    for (std::uint64_t i = 0; i < link.CollisionCount(); ++i) {
      add_shape(*link.CollisionByIndex(i), world_from_link, name);
    }
  }
}

template <class Shape>
void SdfLoader::add_shape(const Shape& shape, const Pose& world_from_link,
                          const std::string& link_name) {
  const std::string name = link_name + "/" + shape.Name();
  const Pose placement = world_from_link * resolved(shape.SemanticPose(), name);
  const sdf::Geometry* geometry = shape.Geom();
  if (geometry == nullptr) return;
  laser_retro_ = options_.materials == MaterialSource::kFile ? laser_retro_of(shape) : 0.0;
  if (const auto* box = geometry->BoxShape()) {
    add(box_shape(to_eigen(box->Size())), placement);
  } else if (const auto* cylinder = geometry->CylinderShape()) {
    add(cylinder_shape(cylinder->Radius(), cylinder->Length()), placement);
  } else if (const auto* sphere = geometry->SphereShape()) {
    add(sphere_shape(sphere->Radius()), placement);
  } else if (const auto* ellipsoid = geometry->EllipsoidShape()) {
    add(ellipsoid_shape(to_eigen(ellipsoid->Radii())), placement);
  } else if (const auto* capsule = geometry->CapsuleShape()) {
    add(capsule_shape(capsule->Radius(), capsule->Length()), placement);
  } else if (const auto* plane = geometry->PlaneShape()) {
    add(plane_shape(to_eigen(plane->Normal()), {plane->Size().X(), plane->Size().Y()}), placement);
  } else if (const auto* mesh = geometry->MeshShape()) {
    add_mesh(*mesh, placement, name);
  } else if (geometry->Element() && geometry->Element()->GetFirstElement()) {
    const sdf::ElementPtr kind = geometry->Element()->GetFirstElement();
    const bool is_alone = !kind->GetNextElement();  // several polylines are holes in each other
    if (kind->GetName() == "polyline" && is_alone) return add_polyline(kind, placement);
    if (kind->GetName() != "empty")
      unsupported_.push_back("the <" + kind->GetName() + "> of " + name);
  }
}

void SdfLoader::add_polyline(const sdf::ElementPtr& polyline, const Pose& world_from_shape) {
  std::vector<Eigen::Vector2d> outline;
  for (auto point = polyline->GetElement("point"); point; point = point->GetNextElement("point")) {
    const auto p = point->Get<ignition::math::Vector2d>();
    outline.emplace_back(p.X(), p.Y());
  }
  add(prism_shape(outline, polyline->Get<double>("height")), world_from_shape);
}

const std::vector<MeshPart>& SdfLoader::parts_of(const fs::path& mesh_file) {
  const auto known = mesh_files_.find(mesh_file);
  if (known != mesh_files_.end()) return known->second;
  std::vector<MeshPart> parts;
  try {
    parts = load_mesh_parts(mesh_file, UpAxis::kZ, options_.materials);
  } catch (const InputError& error) {
    if (!options_.allow_missing) throw;
    log_.warn(error.what());
  }
  return mesh_files_.emplace(mesh_file, std::move(parts)).first->second;
}

void SdfLoader::add_mesh(const sdf::Mesh& shape, const Pose& world_from_shape,
                         const std::string& name) {
  const fs::path defined_in(shape.FilePath());
  const fs::path base =
      defined_in.is_absolute() ? defined_in.parent_path() : fs::absolute(file_).parent_path();
  const auto mesh_file = folders_.find(shape.Uri(), base);
  if (!mesh_file) return add_missing(shape.Uri() + " of " + name);
  TriangleMesh chosen;
  for (const MeshPart& part : parts_of(*mesh_file)) {
    const bool is_wanted =
        shape.Submesh().empty() || shape.Submesh() == part.node || shape.Submesh() == part.name;
    if (is_wanted) chosen.append(part.surface);
  }
  if (!shape.Submesh().empty() && chosen.empty()) {
    return add_missing("the submesh '" + shape.Submesh() + "' in " + shape.Uri() + " of " + name);
  }
  const Eigen::Vector3d scale = to_eigen(shape.Scale());
  Pose placement = world_from_shape;
  if (shape.CenterSubmesh() && !shape.Submesh().empty()) {
    placement.translate(-scale.cwiseProduct(chosen.bounds().center()));
  }
  add(chosen, placement, scale);
}

void SdfLoader::report_missing() {
  if (!unsupported_.empty()) {
    const std::string list = fmt::format("{}", fmt::join(unsupported_, ", "));
    if (!options_.allow_missing) {
      throw InputError(file_.string(), "has shapes of kinds that are not read: " + list,
                       "put a mesh of the same surface in their place (Blender, or the "
                       "simulator's export), or load the world without them: --allow-missing");
    }
    log_.warn(file_.string() + ": loaded without shapes of kinds that are not read: " + list);
    unsupported_.clear();
  }
  if (missing_.empty()) return;
  std::string list;
  for (const auto& [what, times] : missing_) {
    list += (list.empty() ? "" : ", ") + what;
    if (times > 1) list += fmt::format(" ({} times)", times);
  }
  if (!options_.allow_missing) {
    throw InputError(file_.string(), "cannot find " + list,
                     "searched " + folders_.listed() +
                         "; add a folder to GAZEBO_MODEL_PATH (or model_paths of a world's YAML), "
                         "or load the world without them: --allow-missing (in a YAML: "
                         "allow_missing: true)");
  }
  log_.warn(file_.string() + ": loaded without missing parts: " + list);
}

}  // namespace

TriangleMesh load_sdf(const fs::path& file, const SdfOptions& options, LogSink& log) {
  return SdfLoader(file, options, log).load();
}

}  // namespace lidarena::world

#else

namespace lidarena::world {

TriangleMesh load_sdf(const std::filesystem::path& file, const SdfOptions&, LogSink&) {
  throw InputError(file.string(), "this build cannot read SDF worlds",
                   "build with LIDARENA_WITH_SDF=ON where sdformat 12 is installed");
}

}  // namespace lidarena::world

#endif
