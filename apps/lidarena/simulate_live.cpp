// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/simulate_live.hpp"

#include <memory>

#include "apps/lidarena/live.hpp"
#include "apps/lidarena/paced_writer.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena {

void add_live_simulation(CLI::App& verb, LiveSimulation& live) {
  verb.add_flag("--live", live.asked,
                "Publish the measurements on live topics while they are simulated, as play does; "
                "the dataset is written as with --no-data");
  verb.add_option("--rate", live.rate, "With --live: speed, times that of the sensors")
      ->check(CLI::PositiveNumber);
  verb.add_option("--wait", live.wait_s,
                  "With --live: seconds before the first message, in which subscribers find the "
                  "topics")
      ->check(CLI::NonNegativeNumber);
  verb.add_flag("--sensors-only", live.sensors_only,
                "With --live: leave out the truth: /truth/... and /tf");
  verb.add_option("--domain", live.domain,
                  "With --live: DDS domain; default: ROS_DOMAIN_ID, else 0")
      ->check(CLI::Range(0, 232));
  verb.add_flag("--network", live.network, "With --live: reach other machines, too");
}

PublishedFlight simulate_live(const LiveSimulation& live, study::SimulateRequest request,
                              const std::filesystem::path& out, const Parallel& parallel,
                              LogSink& log) {
  if (request.truth || request.scored_truth)
    throw InputError("--live", "publishes no truth of points", "leave out --truth");
  if (request.write.format != dataset::DatasetFormat::kMcap)
    throw InputError("--live", "writes no measurements", "leave out --format");
  const auto stopped = end_on_interrupt();
  const auto writer =
      std::make_shared<PacedWriter>(dds::LiveOptions{live.domain, live.network},
                                    Pace{live.rate, live.wait_s, live.sensors_only}, stopped);
  request.live = writer;
  request.stopped = stopped;
  PublishedFlight flight;
  flight.summary = study::simulate_dataset(request, out, parallel, log);
  writer->close();
  flight.messages = writer->summary();
  flight.text = writer->summary_text();
  return flight;
}

}  // namespace lidarena
