// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/gazebo/plugin/mesh_shapes.hpp"

#include <sstream>

namespace lidarena::gazebo_plugin {

using Eigen::Vector3d;

Pose facing(const Vector3d& normal) {
  return make_pose(Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), normal), Vector3d::Zero());
}

world::ShapePtr MeshShapes::get(const MeshPart& part) {
  std::ostringstream key;
  key << part.file << '|' << part.submesh << '|' << part.centered << '|' << part.scale.transpose();
  const auto [entry, is_new] = shapes_.try_emplace(key.str(), nullptr);
  if (!is_new) return entry->second;
  world::TriangleMesh scaled;
  scaled.append(load_(part), Pose::Identity(), part.scale);
  world::clean_mesh(scaled, part.file);
  entry->second = world::make_mesh(std::move(scaled));
  return entry->second;
}

}  // namespace lidarena::gazebo_plugin
