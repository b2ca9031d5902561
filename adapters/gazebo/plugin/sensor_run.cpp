// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/gazebo/plugin/sensor_run.hpp"

#include <time.h>

#include <sstream>
#include <utility>

#include "lidarena/base/error.hpp"

namespace lidarena::gazebo_plugin {
namespace {

double cpu_seconds(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

SensorRun::SensorRun(const PluginConfig& config, const sensor::SensorConfig& sensor,
                     std::vector<std::unique_ptr<Output>> outputs, Console console)
    : config_(config),
      sensor_config_(sensor),
      outputs_(std::move(outputs)),
      console_(std::move(console)) {
  if (config_.threads > 0) thread_.emplace();
}

void SensorRun::start(Time now) {
  start_ = now;
  start_wall_ = std::chrono::steady_clock::now();
  start_cpu_ = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
  sensor_.emplace(sensor_config_, sensor_config_.name, config_.seed, config_.noise, now);
}

void SensorRun::step(const StampedPose& body, const std::shared_ptr<world::MovingWorld>& world,
                     const std::vector<Pose>& moved) {
  if (has_failed_) finish();
  if (is_finished_ || last_ == body.stamp) return;
  if (!start_) start(body.stamp);
  last_ = body.stamp;
  if (thread_) {
    thread_->add([this, body, world, moved] { measure(body, *world, moved); });
  } else {
    measure(body, *world, moved);
  }
  const bool ends =
      config_.record_seconds > 0.0 && body.stamp - *start_ >= from_seconds(config_.record_seconds);
  if (ends || has_failed_) finish();
}

void SensorRun::measure(const StampedPose& body, world::MovingWorld& world,
                        const std::vector<Pose>& moved) {
  if (has_failed_) return;
  const double begin = cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
  world.move(moved);
  events_.clear();
  sensor_->step(world, body, events_);
  cast_seconds_ += cpu_seconds(CLOCK_THREAD_CPUTIME_ID) - begin;
  write(body);
  output_seconds_ += cpu_seconds(CLOCK_THREAD_CPUTIME_ID) - begin;
}

void SensorRun::write(const StampedPose& body) {
  try {
    for (const auto& output : outputs_) {
      output->write_truth(body);
      for (const Event& event : events_) output->write(event);
    }
  } catch (const Error& error) {
    has_failed_ = true;
    console_.error(error.what());
  }
}

void SensorRun::finish() {
  if (is_finished_) return;
  is_finished_ = true;
  if (thread_) thread_->drain();
  if (!has_failed_) {  // what is not completed stays recognizable as such
    try {
      for (const auto& output : outputs_) output->finish();
    } catch (const Error& error) {
      console_.error(error.what());
    }
  }
  if (sensor_) print_cost();
}

void SensorRun::print_cost() const {
  const double seconds = to_seconds(*last_ - *start_);
  const double wall =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start_wall_).count();
  std::ostringstream text;
  text << sensor_config_.name << " cast " << sensor_->rays() << " rays in " << seconds
       << " simulated seconds. CPU: " << 1e9 * cast_seconds_ / static_cast<double>(sensor_->rays())
       << " ns per ray; per simulated second " << cast_seconds_ / seconds << " s to cast, "
       << (output_seconds_ - cast_seconds_) / seconds << " s to write and publish, whole process "
       << (cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - start_cpu_) / seconds << " s. Real-time factor "
       << seconds / wall;
  console_.message(text.str());
}

}  // namespace lidarena::gazebo_plugin
