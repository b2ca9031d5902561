// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/time.hpp"

namespace lidarena {

/// Classes of returns that are not of a surface in their direction, as values of
/// PointTruth::triangle. Their position is where the return seems to come from, their normal points
/// to the sensor.
inline constexpr std::uint32_t kAir = 0xFFFF'FFFE;    ///< fog, dust or a drop of rain
inline constexpr std::uint32_t kGhost = 0xFFFF'FFFD;  ///< a mirror image, or a reflector's halo

/// Whether a return is of a mesh of so many triangles, not of a mover, the air or a ghost.
constexpr bool is_of_world(std::uint32_t triangle, std::size_t triangles) {
  return triangle < triangles;
}

/// What a return is of.
enum class PointClass : std::uint8_t { kUnknown, kWorld, kMover, kAir, kGhost };

/// The class of a return with this PointTruth::triangle, in a world of so many triangles.
constexpr PointClass class_of(std::uint32_t triangle, std::size_t triangles) {
  if (is_of_world(triangle, triangles)) return PointClass::kWorld;
  if (triangle == kAir) return PointClass::kAir;
  return triangle == kGhost ? PointClass::kGhost : PointClass::kMover;
}

/// Ground truth of one simulated return: the surface point that was hit; 32 bytes. For evaluation
/// only: stored apart from the measurements (topic /truth/SENSOR/hits), never passed to an
/// estimator.
struct PointTruth {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< m, world frame, on the surface
  float range = 0.0F;  ///< m, true value, by the sensor's definition of range
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, world frame, towards the sensor
  std::uint32_t triangle =
      0;  ///< index in the world mesh; or of a mover, see LivingWorld; or a class
};
static_assert(sizeof(PointTruth) == 32);

/// Ground truth of one scan: as many points as the scan has, in the same order.
struct ScanTruth {
  std::string sensor_id;
  Time stamp{0};  ///< of the scan
  std::vector<PointTruth> points;
};

/// Ground truth scan by scan; next() is empty at the end.
class ScanTruthSource {
 public:
  virtual ~ScanTruthSource() = default;
  virtual std::optional<ScanTruth> next() = 0;
};

/// Receives the ground truth of each scan when the scan is simulated.
class ScanTruthSink {
 public:
  virtual ~ScanTruthSink() = default;
  virtual void write(const ScanTruth& truth) = 0;
};

}  // namespace lidarena
