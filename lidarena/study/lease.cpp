// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/lease.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/json_file.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

/// Names the running system and its process numbers: the same on all processes that can see each
/// other's numbers, and another one after a restart of the machine.
std::string this_system() {
  std::string boot;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
  std::error_code ignored;
  return boot + " " + fs::read_symlink("/proc/self/ns/pid", ignored).string();
}

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string() : std::string(value);
}

LeaseOwner this_process() {
  LeaseOwner self;
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  self.host = name.data();
  self.machine = this_system();
  self.process = getpid();
  self.job = environment("SLURM_JOB_ID");
  self.restart = std::atoi(environment("SLURM_RESTART_COUNT").c_str());
  self.token = fmt::format("{}-{}-{:08x}", self.host, self.process, std::random_device{}());
  return self;
}

bool has_ended(const LeaseOwner& owner, const LeaseOwner& self) {
  if (owner.token.empty()) return false;
  if (owner.machine == self.machine && kill(owner.process, 0) != 0 && errno == ESRCH) return true;
  return !self.job.empty() && owner.job == self.job && owner.restart < self.restart;
}

double seconds_of(const timespec& time) {
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// When the file was last touched, by the file system's clock; empty if it does not exist. Opening
/// makes NFS ask the server.
std::optional<double> touched_at(const fs::path& file) {
  const int fd = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return std::nullopt;
  struct stat status {};
  const bool known = fstat(fd, &status) == 0;
  close(fd);
  return known ? std::optional(seconds_of(status.st_mtim)) : std::nullopt;
}

/// The time by the clock of the file system, which is not this machine's on NFS.
double file_system_time(const fs::path& folder) {
  const fs::path clock = folder / ".clock";
  const int fd = open(clock.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  const bool touched = fd >= 0 && futimens(fd, nullptr) == 0;
  if (fd >= 0) close(fd);
  const std::optional<double> time = touched ? touched_at(clock) : std::nullopt;
  using Seconds = std::chrono::duration<double>;
  return time.value_or(Seconds(std::chrono::system_clock::now().time_since_epoch()).count());
}

std::optional<LeaseSeen> look_at(const fs::path& folder, const std::string& unit,
                                 const LeaseTimes& times, const LeaseOwner& self) {
  const std::optional<double> touched = touched_at(folder / unit);
  if (!touched) return std::nullopt;
  LeaseSeen seen;
  seen.unit = unit;
  try {
    read_json(dataset::read_json(folder / unit), seen.owner, unit);
  } catch (const Error&) {
    seen.owner = {};  // torn, or just released
  }
  seen.silent_s = std::max(0.0, file_system_time(folder) - *touched);
  seen.dead = has_ended(seen.owner, self) ||
              seen.silent_s > std::chrono::duration<double>(times.stale).count();
  return seen;
}

/// A complete file of its own with the owner's record, deleted at the end.
class OwnFile {
 public:
  OwnFile(const fs::path& folder, const LeaseOwner& owner) : path_(folder / ("." + owner.token)) {
    dataset::write_json(path_, to_json(owner));
  }
  ~OwnFile() { unlink(path_.c_str()); }
  OwnFile(const OwnFile&) = delete;
  OwnFile& operator=(const OwnFile&) = delete;

  /// Creates `name` as a link to the file unless it exists. The answer of an NFS server may be
  /// lost, hence the count of links decides.
  bool link_as(const fs::path& name) const {
    struct stat before {};
    struct stat after {};
    stat(path_.c_str(), &before);
    const int result = link(path_.c_str(), name.c_str());
    const int error = errno;
    if (result == 0) return true;
    if (stat(path_.c_str(), &after) == 0 && after.st_nlink > before.st_nlink) return true;
    if (error == EEXIST || error == ENOENT) return false;
    throw Error(fmt::format("{}: cannot be created: {}; leases need a file system with hard links",
                            name.string(), std::strerror(error)));
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

Leases::Leases(fs::path folder, std::string scratch, LeaseTimes times)
    : folder_(std::move(folder)), times_(times), self_(this_process()) {
  fs::create_directories(folder_);
  self_.scratch = std::move(scratch);
  heart_ = std::thread([this] { keep_alive(); });
}

Leases::~Leases() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  end_.notify_all();
  heart_.join();
  while (!tokens_.empty()) release(tokens_.begin()->first);
}

/// Touches the leases from time to time; the thread ends with the object.
void Leases::keep_alive() {
  std::unique_lock lock(mutex_);
  while (!end_.wait_for(lock, times_.heartbeat, [this] { return ending_; })) {
    const std::map<std::string, std::string> held = tokens_;
    lock.unlock();  // a slow file system must not delay the others
    for (const auto& [unit, token] : held) {
      if (holds(unit)) utimensat(AT_FDCWD, (folder_ / unit).c_str(), nullptr, 0);
    }
    lock.lock();
  }
}

std::optional<LeaseSeen> Leases::look(const std::string& unit) const {
  return look_at(folder_, unit, times_, self_);
}

std::optional<Leases::Taken> Leases::take(const std::string& unit) {
  LeaseOwner owner = self_;
  owner.token = fmt::format("{}-{}", self_.token, ++count_);
  using Seconds = std::chrono::duration<double>;
  owner.since = Seconds(std::chrono::system_clock::now().time_since_epoch()).count();
  Taken taken{owner.token, {}};
  const std::optional<LeaseSeen> seen = look(unit);
  if (seen && !seen->dead) return std::nullopt;
  const bool is_mine =
      seen ? take_over(unit, *seen, owner) : OwnFile(folder_, owner).link_as(folder_ / unit);
  if (!is_mine) return std::nullopt;
  if (seen && !seen->owner.token.empty()) taken.taken_from = seen->owner;
  const std::lock_guard lock(mutex_);
  tokens_[unit] = owner.token;
  return taken;
}

/// Replaces a dead lease. Of several processes that see it dead, the one that creates the lock
/// named after it replaces it; whoever creates the lock later finds another lease.
bool Leases::take_over(const std::string& unit, const LeaseSeen& dead, const LeaseOwner& owner) {
  const fs::path lock = folder_ / (".after-" + unit + "-" + dead.owner.token);
  const OwnFile mine(folder_, owner);
  if (!mine.link_as(lock)) {
    // The lock of a process that died here, in a moment of a few milliseconds.
    const std::optional<double> touched = touched_at(lock);
    const std::chrono::duration<double> stale = times_.stale;
    if (touched && file_system_time(folder_) - *touched > stale.count()) unlink(lock.c_str());
    return false;
  }
  const std::optional<LeaseSeen> still = look(unit);
  bool is_mine = false;
  if (still && still->dead && still->owner.token == dead.owner.token) {
    LeaseOwner next = owner;
    const OwnFile lease(folder_, (next.token += "-next", next));
    dataset::write_json(lease.path(), to_json(owner));
    is_mine = rename(lease.path().c_str(), (folder_ / unit).c_str()) == 0;
  }
  unlink(lock.c_str());
  return is_mine;
}

bool Leases::holds(const std::string& unit) const {
  std::string token;
  {
    const std::lock_guard lock(mutex_);
    const auto found = tokens_.find(unit);
    if (found == tokens_.end()) return false;
    token = found->second;
  }
  const std::optional<LeaseSeen> seen = look(unit);
  return seen && seen->owner.token == token;
}

void Leases::release(const std::string& unit) {
  if (holds(unit)) unlink((folder_ / unit).c_str());
  const std::lock_guard lock(mutex_);
  tokens_.erase(unit);
}

std::vector<LeaseSeen> all_leases(const fs::path& folder, LeaseTimes times) {
  std::vector<LeaseSeen> leases;
  std::error_code none;
  const LeaseOwner self = this_process();
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const std::string unit = entry.path().filename();
    if (unit.starts_with(".")) continue;
    if (auto seen = look_at(folder, unit, times, self)) leases.push_back(*std::move(seen));
  }
  return leases;
}

}  // namespace lidarena::study
