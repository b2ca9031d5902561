// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/config_json.hpp"
#include "lidarena/evaluation/map/completeness.hpp"
#include "lidarena/evaluation/map/ghosting.hpp"
#include "lidarena/evaluation/map/identity_error.hpp"
#include "lidarena/evaluation/map/mesh_gauge.hpp"
#include "lidarena/evaluation/map/signed_distance.hpp"
#include "lidarena/evaluation/map/vertex_distance.hpp"
#include "lidarena/evaluation/map/voxel_error.hpp"

/// Map metrics as JSON, with the conventions of metrics_json.hpp. Null where nothing was measured.
namespace lidarena::evaluation {

Json to_json(const VoxelError& error);
Json to_json(const SignedDistance& distance);
Json to_json(const Ghosting& ghosting);
Json to_json(const IdentityError& error);
Json to_json(const Completeness& completeness);
/// Has the reason under "refused" where the distance was not computed.
Json to_json(const VertexDistance& distance);
/// Diagnostics of the gauge "robust".
Json to_json(const MeshAlignment& alignment);

}  // namespace lidarena::evaluation
