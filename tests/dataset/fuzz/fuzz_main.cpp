// SPDX-License-Identifier: BSD-3-Clause
// One reader under libFuzzer: fuzz_NAME CORPUS_FOLDER [-max_total_time=60 ...]. An empty corpus
// folder is filled with the target's own corpus first.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/dataset/fuzz/fuzz_targets.hpp"

namespace {

const lidarena::dataset::fuzz::Target& tested_target() {
  static const lidarena::dataset::fuzz::Target& kTarget =
      lidarena::dataset::fuzz::target(LIDARENA_FUZZ_TARGET);
  return kTarget;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  namespace fs = std::filesystem;
  for (int i = 1; i < *argc; ++i) {
    const fs::path folder = (*argv)[i];
    if (!fs::is_directory(folder) || !fs::is_empty(folder)) continue;
    for (std::size_t k = 0; k < tested_target().corpus.size(); ++k) {
      std::ofstream(folder / ("sound_" + std::to_string(k)), std::ios::binary)
          << tested_target().corpus[k];
    }
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  tested_target().read({reinterpret_cast<const char*>(data), size});
  return 0;
}
