// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "lidarena/base/config_json.hpp"

namespace lidarena::study {

/// When a claim counts as alive.
struct ClaimTimes {
  std::chrono::milliseconds heartbeat{5'000};  ///< the owner touches its claims this often
  std::chrono::milliseconds stale{60'000};     ///< an untouched claim may be taken over
};

/// Who holds a claim, written into its file.
struct ClaimOwner {
  std::string token;    ///< of this claim alone; a name for folders
  std::string host;     ///< name of the machine
  std::string machine;  ///< the running system and its process numbers; equal = same processes
  int process = 0;
  std::string job;      ///< number of its Slurm job; empty outside of Slurm
  int restart = 0;      ///< how many times Slurm has started that job again
  std::string scratch;  ///< folder on its own machine in which it works
  double since = 0.0;   ///< seconds since 1970, by its own clock

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("token", self.token, "", "");
    v("host", self.host, "", "");
    v("machine", self.machine, "", "");
    v("process", self.process, "", "");
    v("job", self.job, "", "");
    v("restart", self.restart, "", "");
    v("scratch", self.scratch, "", "");
    v("since", self.since, "s", "");
  }
};

/// A claim as others see it.
struct ClaimSeen {
  std::string unit;
  ClaimOwner owner;       ///< without a token if the file is torn
  double silent_s = 0.0;  ///< since its owner last touched it, by the file system's clock
  bool dead = false;      ///< its owner has ended, or is silent for too long
};

/// Claims of this process on units of work: files in a shared folder, of which only atomic creation
/// (link) and replacement (rename) are used, so that any POSIX or NFS file system will do. At most
/// one process holds a unit. The claim of a process that has died is taken over: at once if that is
/// known (a process of this machine, an earlier start of the same Slurm job), else when nobody has
/// touched it for ClaimTimes::stale. A process that was only suspended may then believe that it
/// holds a unit which another one has: it must ask holds() before it publishes anything.
class Claims {
 public:
  /// Creates the folder. `scratch`: where this process works, written into its claims.
  explicit Claims(std::filesystem::path folder, std::string scratch = {}, ClaimTimes times = {});
  /// Releases all.
  ~Claims();
  Claims(const Claims&) = delete;
  Claims& operator=(const Claims&) = delete;

  struct Taken {
    std::string token;                     ///< of the claim
    std::optional<ClaimOwner> taken_from;  ///< the dead owner, if there was one
  };
  /// Claims the unit; empty if another process holds it. Throws Error if the folder cannot be
  /// written.
  std::optional<Taken> take(const std::string& unit);
  /// Whether this process still holds the unit.
  bool holds(const std::string& unit) const;
  void release(const std::string& unit);
  /// The claim of any process on the unit, if there is one.
  std::optional<ClaimSeen> look(const std::string& unit) const;

 private:
  bool take_over(const std::string& unit, const ClaimSeen& dead, const ClaimOwner& owner);
  void keep_alive();

  std::filesystem::path folder_;
  ClaimTimes times_;
  ClaimOwner self_;
  int count_ = 0;
  mutable std::mutex mutex_;
  std::map<std::string, std::string> tokens_;  ///< of the units held
  std::condition_variable end_;
  bool ending_ = false;
  std::thread heart_;
};

/// All claims in a folder, e.g. for the status of a study; none if it does not exist.
std::vector<ClaimSeen> all_claims(const std::filesystem::path& folder, ClaimTimes times = {});

}  // namespace lidarena::study
