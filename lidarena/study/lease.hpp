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

/// When a lease counts as alive.
struct LeaseTimes {
  std::chrono::milliseconds heartbeat{5'000};  ///< the owner touches its leases this often
  std::chrono::milliseconds stale{60'000};     ///< an untouched lease may be taken over
};

/// Who holds a lease, written into its file.
struct LeaseOwner {
  std::string token;    ///< of this lease alone; a name for folders
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

/// A lease as others see it.
struct LeaseSeen {
  std::string unit;
  LeaseOwner owner;       ///< without a token if the file is torn
  double silent_s = 0.0;  ///< since its owner last touched it, by the file system's clock
  bool dead = false;      ///< its owner has ended, or is silent for too long
};

/// Leases of this process on units of work: files in a shared folder, of which only atomic creation
/// (link) and replacement (rename) are used, so that any POSIX or NFS file system will do. At most
/// one process holds a unit. The lease of a process that has died is taken over: at once if that is
/// known (a process of this machine, an earlier start of the same Slurm job), else when nobody has
/// touched it for LeaseTimes::stale. A process that was only suspended may then believe that it
/// holds a unit which another one has: it must ask holds() before it publishes anything.
class Leases {
 public:
  /// Creates the folder. `scratch`: where this process works, written into its leases.
  explicit Leases(std::filesystem::path folder, std::string scratch = {}, LeaseTimes times = {});
  /// Releases all.
  ~Leases();
  Leases(const Leases&) = delete;
  Leases& operator=(const Leases&) = delete;

  struct Taken {
    std::string token;                     ///< of the lease
    std::optional<LeaseOwner> taken_from;  ///< the dead owner, if there was one
  };
  /// Leases the unit; empty if another process holds it. Throws Error if the folder cannot be
  /// written.
  std::optional<Taken> take(const std::string& unit);
  /// Whether this process still holds the unit.
  bool holds(const std::string& unit) const;
  void release(const std::string& unit);
  /// The lease of any process on the unit, if there is one.
  std::optional<LeaseSeen> look(const std::string& unit) const;

 private:
  bool take_over(const std::string& unit, const LeaseSeen& dead, const LeaseOwner& owner);
  void keep_alive();

  std::filesystem::path folder_;
  LeaseTimes times_;
  LeaseOwner self_;
  int count_ = 0;
  mutable std::mutex mutex_;
  std::map<std::string, std::string> tokens_;  ///< of the units held
  std::condition_variable end_;
  bool ending_ = false;
  std::thread heart_;
};

/// All leases in a folder, e.g. for the status of a study; none if it does not exist.
std::vector<LeaseSeen> all_leases(const std::filesystem::path& folder, LeaseTimes times = {});

}  // namespace lidarena::study
