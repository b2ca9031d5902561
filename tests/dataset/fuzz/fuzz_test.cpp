// SPDX-License-Identifier: BSD-3-Clause
// Seeded mutations of valid input for every reader: a short version of fuzzing, for every build.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <cstring>

#include "lidarena/base/random.hpp"
#include "tests/dataset/fuzz/fuzz_targets.hpp"

namespace lidarena::dataset::fuzz {
namespace {

/// Duration of the test of each reader, s; set by LIDARENA_FUZZ_SECONDS.
double seconds_per_reader() {
  const char* wanted = std::getenv("LIDARENA_FUZZ_SECONDS");
  return wanted == nullptr ? 0.2 : std::atof(wanted);
}

class Mutations {
 public:
  explicit Mutations(const std::vector<std::string>& corpus) : corpus_(corpus), random_(11) {}

  std::string next() {
    std::string bytes = corpus_[below(corpus_.size())];
    for (std::size_t n = 1 + below(4); n > 0; --n) mutate(bytes);
    return bytes;
  }

 private:
  std::size_t below(std::size_t count) {
    if (count == 0) return 0;
    const auto value = static_cast<std::size_t>(random_.uniform(0.0, static_cast<double>(count)));
    return std::min(value, count - 1);
  }

  void mutate(std::string& bytes) {
    const std::size_t at = below(bytes.size() + 1);
    const std::size_t length = std::min(below(16), bytes.size() - at);
    switch (below(7)) {
      case 0:
        if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 1:
        if (at < bytes.size()) bytes[at] = static_cast<char>(below(256));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.erase(at, length);
        break;
      case 4:
        bytes.insert(at, std::string(bytes.substr(at, length)));
        break;
      case 5: {  // overwrite with a number at the limits of its type
        constexpr std::array<std::uint64_t, 6> kLimits{0,          1,           0x7fffffff,
                                                       0xffffffff, 0x80000000U, ~std::uint64_t{0}};
        const std::uint64_t value = kLimits[below(kLimits.size())];
        const std::size_t size = std::min<std::size_t>(below(2) == 0 ? 4 : 8, bytes.size() - at);
        std::memcpy(bytes.data() + at, &value, size);
        break;
      }
      default: {  // insert a piece of another input
        const std::string& other = corpus_[below(corpus_.size())];
        bytes.insert(at, other.substr(below(other.size()), below(64)));
      }
    }
  }

  const std::vector<std::string>& corpus_;
  SequentialRandom random_;
};

class Readers : public testing::TestWithParam<const char*> {};

TEST_P(Readers, RefuseBrokenInputOrReadItButNeverFail) {
  const Target& tested_target = target(GetParam());
  for (const std::string& valid : tested_target.corpus) ASSERT_NO_THROW(tested_target.read(valid));
  Mutations mutations(tested_target.corpus);
  const auto end =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds_per_reader());
  int count = 0;
  for (; std::chrono::steady_clock::now() < end; ++count) {
    const std::string broken = mutations.next();
    ASSERT_NO_THROW(tested_target.read(broken)) << "mutation " << count;
  }
  RecordProperty("mutations", count);
  EXPECT_GT(count, 0);
}

#ifdef LIDARENA_TEST_SQLITE
constexpr std::size_t kTargets = 11;
INSTANTIATE_TEST_SUITE_P(Sqlite, Readers, testing::Values("db3"),
                         [](const auto& param) { return std::string(param.param); });
#else
constexpr std::size_t kTargets = 10;
#endif

INSTANTIATE_TEST_SUITE_P(All, Readers,
                         testing::Values("mcap", "bag", "pcd", "ply", "bin", "trajectory", "pcap",
                                         "manifest", "yaml", "messages"),
                         [](const auto& param) { return std::string(param.param); });

TEST(Targets, AreAllTried) { EXPECT_EQ(targets().size(), kTargets); }

}  // namespace
}  // namespace lidarena::dataset::fuzz
