// SPDX-License-Identifier: BSD-3-Clause
// usage: write_mcap_sample FOLDER   writes the dataset that mcap_official/read_all.mjs knows.
#include <cstdio>
#include <exception>

#include "lidarena/dataset/dataset.hpp"
#include "tests/dataset/sample_events.hpp"

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fputs("usage: write_mcap_sample FOLDER\n", stderr);
    return 2;
  }
  constexpr int kScans = 20;
  constexpr int kPoints = 5000;  // several chunks
  lidarena::DatasetWriter out(argv[1], lidarena::sample::rig());
  int next_truth = 0;
  for (const lidarena::Event& event : lidarena::sample::events(kScans, kPoints)) {
    if (std::holds_alternative<lidarena::ImuSample>(event.data)) {
      out.write_truth(lidarena::sample::truth(next_truth++));
    }
    out.write(event);
  }
  out.close();
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
