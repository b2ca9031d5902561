// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/contacts.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

namespace lidarena::odometry {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kReturnSigma = 0.02;                          // m, of the data sheets
constexpr double kMaxTranslation = 0.05;                       // m
constexpr double kMaxRotation = 1.0 / 180 * std::numbers::pi;  // rad
constexpr double kMinShare = 2e-3;     // of all contacts; what fewer tell is by wrong planes
constexpr double kCertainShare = 0.1;  // what so many tell is not by errors of normals

/// Derivative of the distance from the plane by position and rotation.
Vector6 derivative_of(const Contact& contact) {
  Vector6 j;
  j << contact.normal.cast<double>(), contact.arm.cross(contact.normal).cast<double>();
  return j;
}

/// What the contacts tell of a direction: the sum of squares of those derivatives along it that are
/// larger than the errors of the normals make them.
double told_of(const Vector6& direction, std::span<const Contact> contacts) {
  const Eigen::Vector3d shift = direction.head<3>();
  const Eigen::Vector3d turn = direction.tail<3>();
  double sum = 0.0;
  for (const Contact& contact : contacts) {
    // A point moves by this much: that is what an error of its normal is multiplied with.
    const double moved = (shift + turn.cross(contact.arm.cast<double>())).norm();
    const double along = direction.dot(derivative_of(contact));
    if (std::abs(along) > contact.normal_error * moved) sum += along * along;
  }
  return sum;
}

double largest(const Eigen::Matrix3d& variances) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(variances, Eigen::EigenvaluesOnly)
      .eigenvalues()[2];
}

}  // namespace

std::vector<Contact> contacts_of(std::span<const Eigen::Vector3f> points,
                                 const Eigen::Vector3f& sensor, const map::LocalPlanes& map,
                                 double max_distance) {
  std::vector<Contact> contacts;
  contacts.reserve(points.size());
  for (const Eigen::Vector3f& point : points) {
    for (const map::PlaneMap* cells : {&map.coarse(), &map.fine()}) {
      const map::MapPlane* plane = cells->plane_at(point, sensor);
      if (plane == nullptr || std::abs(plane->normal.dot(point - plane->center)) >= max_distance)
        continue;
      contacts.push_back({point - sensor, plane->normal, plane->normal_error});
      break;
    }
  }
  return contacts;
}

bool leaves_a_direction_open(std::span<const Contact> contacts, double returns_per_contact) {
  Matrix6 sum = Matrix6::Zero();
  for (const Contact& contact : contacts) {
    const Vector6 j = derivative_of(contact);
    sum += j * j.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6> directions(sum);
  const auto count = static_cast<double>(contacts.size());
  Matrix6 covariance = Matrix6::Zero();
  for (int i = 0; i < 6; ++i) {
    const Vector6 direction = directions.eigenvectors().col(i);
    double told = directions.eigenvalues()[i];
    if (told < kCertainShare * count) told = told_of(direction, contacts);
    const double variance = told > kMinShare * count
                                ? kReturnSigma * kReturnSigma / (returns_per_contact * told)
                                : 1.0;  // m^2, rad^2: unknown
    covariance += variance * direction * direction.transpose();
  }
  return largest(covariance.topLeftCorner<3, 3>()) > kMaxTranslation * kMaxTranslation ||
         largest(covariance.bottomRightCorner<3, 3>()) > kMaxRotation * kMaxRotation;
}

}  // namespace lidarena::odometry
