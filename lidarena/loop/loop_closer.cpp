// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/loop/loop_closer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::loop {
namespace {

constexpr double kMinTranslationSigma = 0.1;    // m: sigma of the drift at path length zero
constexpr double kMinRotationSigma = 0.01;      // rad: likewise
constexpr double kLeverArm = 1.0;               // m of path length per radian of rotation
constexpr std::size_t kMaxWaitKeyframes = 20;   // keyframes that a loop waits for another
constexpr std::size_t kKeyframesPerSearch = 2;  // keyframes from one search to the next
constexpr double kMaxDescriptorDistance = 0.3;  // 0: equal places, 1: nothing in common
constexpr std::size_t kSourceKeyframes = 4;     // before the new one, matched with its own points
constexpr std::size_t kTargetKeyframes = 8;     // on each side of the old one
constexpr double kVoxelSize = 0.2;              // m, in which both clouds are averaged
constexpr std::size_t kMaxSourcePoints = 1000;
constexpr std::size_t kMinSourcePoints = 300;
constexpr std::size_t kMinTargetPoints = 1000;
constexpr double kMinConstraint = 0.005;     // of the least constrained direction
constexpr std::size_t kConsistentLoops = 2;  // loops that must agree
constexpr double kMinStep = 0.1;             // m of path length between keyframes, for drift
constexpr double kLoopKernelScale = 3.0;     // sigmas, of the Cauchy kernel of loops

estimation::PoseGraph::Covariance covariance_of(double translation_sigma, double rotation_sigma) {
  return estimation::diagonal_covariance(translation_sigma * translation_sigma,
                                         rotation_sigma * rotation_sigma);
}

/// Shuffles with a seed that depends only on the number of points, so that the first points are
/// from the whole cloud.
std::vector<Eigen::Vector3f> shuffled(std::vector<Eigen::Vector3f> points) {
  SequentialRandom random(points.size());
  for (std::size_t i = points.size(); i > 1; --i) {
    const auto other = static_cast<std::size_t>(random.uniform() * static_cast<double>(i));
    std::swap(points[i - 1], points[std::min(other, i - 1)]);
  }
  return points;
}

std::vector<Eigen::Vector3f> turned(std::span<const Eigen::Vector3f> points,
                                    const Eigen::Matrix3d& rotation) {
  std::vector<Eigen::Vector3f> moved(points.begin(), points.end());
  for (Eigen::Vector3f& p : moved) p = rotation.cast<float>() * p;
  return moved;
}

}  // namespace

const char* to_string(LoopVerdict verdict) {
  constexpr std::array kNames{"accepted", "waiting",        "too few points", "not converged",
                              "poor fit", "little overlap", "unconstrained",  "beyond drift"};
  return kNames[static_cast<std::size_t>(verdict)];
}

bool LoopCloser::add(Time stamp, const Pose& previous_from_this, const KeyframeCloud& cloud) {
  const std::size_t index = graph_.nodes.size();
  stamps_.push_back(stamp);
  steps_.push_back(previous_from_this.translation().norm() +
                   kLeverArm * so3::angle(previous_from_this.linear()));
  const double step = std::max(steps_.back(), kMinStep);
  estimation::append_to_chain(previous_from_this,
                              covariance_of(config_.translation_drift_m_per_m * step,
                                            config_.rotation_drift_rad_per_m * step),
                              graph_);
  if (config_.descriptor_candidates > 0) {
    descriptors_.emplace(index, describe(turned(around(index, kSourceKeyframes, 0, cloud),
                                                graph_.nodes.back().linear()),
                                         config_.descriptor_range_m));
  }
  if (pending_.empty() && index % kKeyframesPerSearch == 0)
    pending_ = candidates(path_lengths_to_last());
  return !pending_.empty() && try_next(cloud);
}

bool LoopCloser::try_next(const KeyframeCloud& cloud) {
  const Candidate candidate = pending_.front();
  pending_.erase(pending_.begin());
  records_.push_back(verify(candidate, cloud));
  if (records_.back().verdict != LoopVerdict::kAccepted) return false;
  pending_.clear();
  const std::vector<LoopRecord> loops = confirmed_loops();
  if (!loops.empty()) close(loops);
  return !loops.empty();
}

bool LoopCloser::may_close(std::size_t keyframe, const std::vector<double>& path_lengths) const {
  return !retired_.contains(keyframe) && path_lengths[keyframe] >= config_.min_path_length_m &&
         to_seconds(stamps_.back() - stamps_[keyframe]) > config_.min_time_gap_s;
}

std::vector<LoopCloser::Candidate> LoopCloser::candidates(
    const std::vector<double>& path_lengths) const {
  std::vector<Candidate> found;
  add_nearest(path_lengths, found);
  add_similar(path_lengths, found);
  return found;
}

void LoopCloser::add_nearest(const std::vector<double>& path_lengths,
                             std::vector<Candidate>& found) const {
  const Pose& here = graph_.nodes.back();
  double nearest = config_.search_radius_m;
  std::size_t best = graph_.nodes.size();
  for (std::size_t i = 0; i + 1 < graph_.nodes.size(); ++i) {
    const double distance = (graph_.nodes[i].translation() - here.translation()).norm();
    if (distance >= nearest || !may_close(i, path_lengths)) continue;
    nearest = distance;
    best = i;
  }
  if (best < graph_.nodes.size())
    found.push_back({best, last(), path_lengths[best], false, graph_.nodes[best].inverse() * here});
}

void LoopCloser::add_similar(const std::vector<double>& path_lengths,
                             std::vector<Candidate>& found) const {
  if (config_.descriptor_candidates == 0) return;
  const PlaceDescriptor& here = descriptors_.at(last());
  std::vector<std::pair<float, std::size_t>> by_rings;
  for (const auto& [i, descriptor] : descriptors_) {
    if (i != last() && may_close(i, path_lengths))
      by_rings.emplace_back((descriptor.ring_means - here.ring_means).norm(), i);
  }
  std::sort(by_rings.begin(), by_rings.end());
  by_rings.resize(
      std::min(by_rings.size(), 4 * static_cast<std::size_t>(config_.descriptor_candidates)));
  std::vector<std::pair<double, Candidate>> similar;
  for (const auto& [unused, i] : by_rings) {
    const Resemblance resemblance = compare(descriptors_.at(i), here);
    if (resemblance.distance > kMaxDescriptorDistance) continue;
    const Eigen::Matrix3d level = so3::exp({0.0, 0.0, resemblance.rotation_rad});
    const Eigen::Matrix3d rotation =
        graph_.nodes[i].linear().transpose() * level * graph_.nodes.back().linear();
    similar.push_back(
        {resemblance.distance,
         {i, last(), path_lengths[i], true, make_pose(rotation, Eigen::Vector3d::Zero().eval())}});
  }
  std::stable_sort(similar.begin(), similar.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  similar.resize(std::min(similar.size(), static_cast<std::size_t>(config_.descriptor_candidates)));
  for (const auto& [unused, candidate] : similar) found.push_back(candidate);
}

std::vector<Eigen::Vector3f> LoopCloser::around(std::size_t keyframe, std::size_t before,
                                                std::size_t after,
                                                const KeyframeCloud& cloud) const {
  std::vector<Eigen::Vector3f> points;
  const std::size_t begin = keyframe - std::min(keyframe, before);
  const std::size_t end = std::min(keyframe + after + 1, graph_.nodes.size());
  for (std::size_t i = begin; i < end; ++i) {
    const Eigen::Isometry3f moved =
        (graph_.nodes[keyframe].inverse() * graph_.nodes[i]).cast<float>();
    for (const Eigen::Vector3f& p : cloud(i)) points.push_back(moved * p);
  }
  return shuffled(map::voxel_means(points, kVoxelSize));
}

bool LoopCloser::is_beyond_drift(const LoopRecord& loop) const {
  const double apart =
      (graph_.nodes[loop.first].translation() - graph_.nodes[loop.second].translation()).norm();
  return apart - kIcpReach >
         kLoopGate * (kMinTranslationSigma + config_.translation_drift_m_per_m * loop.path_length);
}

LoopRecord LoopCloser::verify(const Candidate& candidate, const KeyframeCloud& cloud) const {
  LoopRecord loop;
  loop.first = candidate.keyframe;
  loop.second = candidate.seen_from;
  loop.by_appearance = candidate.by_appearance;
  loop.path_length = candidate.path_length;
  loop.first_from_second = candidate.guess;
  if (candidate.by_appearance && is_beyond_drift(loop)) {
    loop.verdict = LoopVerdict::kBeyondDrift;
    return loop;
  }
  auto source = around(loop.second, kSourceKeyframes, 0, cloud);
  // The target must not contain keyframes of the source, which would match themselves.
  const std::size_t after = std::min(
      kTargetKeyframes, loop.second - std::min(loop.second, loop.first + kSourceKeyframes + 1));
  auto target = around(loop.first, kTargetKeyframes, after, cloud);
  if (source.size() < kMinSourcePoints || target.size() < kMinTargetPoints) return loop;
  if (source.size() > kMaxSourcePoints) source.resize(kMaxSourcePoints);
  map::KdTree tree;
  tree.build(std::move(target));
  const IcpResult icp = align_clouds(source, tree, candidate.guess, parallel_);
  const Pose contradiction =
      (graph_.nodes[loop.first].inverse() * graph_.nodes[loop.second]).inverse() *
      icp.target_from_source;
  loop.first_from_second = icp.target_from_source;
  loop.fitness = icp.fitness;
  loop.overlap = icp.overlap;
  loop.constraint = icp.constraint;
  loop.translation_m = contradiction.translation().norm();
  loop.rotation_rad = so3::angle(contradiction.linear());
  loop.verdict = judge(icp, loop);
  return loop;
}

LoopVerdict LoopCloser::judge(const IcpResult& icp, const LoopRecord& loop) const {
  if (!icp.converged) return LoopVerdict::kNotConverged;
  if (!(icp.fitness < config_.max_fitness_m2)) return LoopVerdict::kPoorFit;
  if (icp.overlap < config_.min_overlap) return LoopVerdict::kLittleOverlap;
  if (icp.constraint < kMinConstraint) return LoopVerdict::kUnconstrained;
  const double translation_m =
      kMinTranslationSigma + config_.translation_drift_m_per_m * loop.path_length;
  const double rotation_rad =
      kMinRotationSigma + config_.rotation_drift_rad_per_m * loop.path_length;
  const bool beyond = loop.translation_m > kLoopGate * translation_m ||
                      loop.rotation_rad > kLoopGate * rotation_rad;
  return beyond ? LoopVerdict::kBeyondDrift : LoopVerdict::kAccepted;
}

std::vector<double> LoopCloser::path_lengths_to_last() const {
  const std::size_t count = graph_.nodes.size();
  std::vector<double> path_lengths(count, std::numeric_limits<double>::infinity());
  using Reached = std::pair<double, std::size_t>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> next;
  const auto reach = [&](std::size_t keyframe, double path_length) {
    if (path_length >= path_lengths[keyframe]) return;
    path_lengths[keyframe] = path_length;
    next.emplace(path_length, keyframe);
  };
  reach(count - 1, 0.0);
  while (!next.empty()) {
    const auto [path_length, i] = next.top();
    next.pop();
    if (path_length > path_lengths[i]) continue;
    if (i > 0) reach(i - 1, path_length + steps_[i]);
    if (i + 1 < count) reach(i + 1, path_length + steps_[i + 1]);
    const auto [tied, tied_end] = tied_.equal_range(i);
    for (auto other = tied; other != tied_end; ++other) reach(other->second, path_length);
  }
  return path_lengths;
}

bool LoopCloser::agree(const LoopRecord& a, const LoopRecord& b) const {
  // Where each loop places the newer keyframe of `b`.
  const std::vector<Pose>& x = graph_.nodes;
  const Pose by_b = x[b.first] * b.first_from_second;
  const Pose by_a = x[a.first] * a.first_from_second * x[a.second].inverse() * x[b.second];
  const Pose apart = by_a.inverse() * by_b;
  const double between = std::hypot(drift_steps(a.first, b.first), drift_steps(a.second, b.second));
  const double translation_m = std::hypot(std::numbers::sqrt2 * kLoopTranslationSigma,
                                          config_.translation_drift_m_per_m * between);
  const double rotation_rad = std::hypot(std::numbers::sqrt2 * kLoopRotationSigma,
                                         config_.rotation_drift_rad_per_m * between);
  return apart.translation().norm() < kLoopGate * translation_m &&
         so3::angle(apart.linear()) < kLoopGate * rotation_rad;
}

double LoopCloser::drift_steps(std::size_t a, std::size_t b) const {
  const auto [first, last] = std::minmax(a, b);
  double squares = 0.0;
  for (std::size_t i = first + 1; i <= last; ++i) squares += steps_[i] * steps_[i];
  return std::sqrt(squares);
}

std::vector<LoopRecord> LoopCloser::confirmed_loops() {
  LoopRecord& last = records_.back();
  std::erase_if(waiting_, [&](const LoopRecord& loop) {
    return loop.second + kMaxWaitKeyframes < last.second;
  });
  std::vector<LoopRecord> loops;
  for (const LoopRecord& loop : waiting_) {
    if (agree(loop, last)) loops.push_back(loop);
  }
  loops.push_back(last);
  if (loops.size() >= kConsistentLoops) return loops;
  last.verdict = LoopVerdict::kWaiting;
  waiting_.push_back(last);
  return {};
}

void LoopCloser::close(const std::vector<LoopRecord>& loops) {
  constexpr estimation::RobustLoss kLoss{estimation::RobustKernel::kCauchy, kLoopKernelScale};
  // A single loop that contradicts the poses is more likely wrong than they are.
  const bool corrects = std::ranges::all_of(loops, &LoopRecord::corrects);
  for (const LoopRecord& loop : loops) {
    if (corrects)
      graph_.betweens.push_back({loop.first, loop.second, loop.first_from_second,
                                 covariance_of(kLoopTranslationSigma, kLoopRotationSigma), kLoss});
    accepted_.push_back(loop);
    tied_.emplace(loop.first, loop.second);
    tied_.emplace(loop.second, loop.first);
    for (LoopRecord& record : records_) {
      if (record.first == loop.first && record.second == loop.second &&
          record.verdict == LoopVerdict::kWaiting)
        record.verdict = LoopVerdict::kAccepted;
    }
  }
  waiting_.clear();
  if (corrects) graph_.nodes = estimation::optimize(graph_).nodes;
}

std::uint64_t LoopCloser::memory_bytes() const {
  return pending_.capacity() * sizeof(Candidate) + stamps_.capacity() * sizeof(Time) +
         steps_.capacity() * sizeof(double) + descriptors_.size() * sizeof(PlaceDescriptor) +
         estimation::memory_bytes(graph_) +
         (records_.capacity() + waiting_.capacity() + accepted_.capacity()) * sizeof(LoopRecord);
}

}  // namespace lidarena::loop
