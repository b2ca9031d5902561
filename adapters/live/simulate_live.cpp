// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/live/simulate_live.hpp"

#include <memory>

#include "adapters/live/interrupt.hpp"
#include "adapters/live/paced_writer.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena::live {

PublishedFlight simulate_live(const LiveSimulation& live, stages::SimulateRequest request,
                              const std::filesystem::path& out, const Parallel& parallel,
                              LogSink& log) {
  if (request.truth)
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
  flight.summary = stages::simulate_dataset(request, out, parallel, log);
  writer->close();
  flight.messages = writer->summary();
  flight.text = writer->summary_text();
  return flight;
}

}  // namespace lidarena::live
