#include "app/platform/staging_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <ctime>
#include <fstream>
#include <random>
#include <stdexcept>
#include <utility>

#include "base/file.h"
#include "base/input_error.h"

namespace foci {
namespace fs = std::filesystem;
namespace {

constexpr const char* kPrefix = ".foci-";
constexpr std::size_t kTokenDigits = 16;
constexpr std::time_t kDead_s = 60;  // several heartbeats

std::string randomToken() {
  std::random_device random;
  std::string token;
  while (token.size() < kTokenDigits) token += "0123456789abcdef"[random() % 16];
  return token;
}

bool isStaging(const std::string& name) {
  return name.size() == std::char_traits<char>::length(kPrefix) + kTokenDigits &&
         name.starts_with(kPrefix);
}

/// Differs between machines, and between starts of one machine. Containers of a machine share it.
std::string machineStart() {
  std::string id;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> id;
  return id;
}

/// "process 123 on lab3 since 2026-11-27 12:03:10 UTC"
std::string ownName() {
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host = {"an unknown host"};
  const std::time_t now_s = std::time(nullptr);
  std::array<char, 32> time{};
  std::tm utc{};
  if (::gmtime_r(&now_s, &utc) != nullptr) {
    std::strftime(time.data(), time.size(), "%F %T UTC", &utc);
  }
  return "process " + std::to_string(::getpid()) + " on " + host.data() + " since " + time.data();
}

struct Other {
  std::string name;
  bool lives = false;
};

/// Who writes in another staging folder.
/// @param now_s  on the clock of the file system
Other ownerOf(const fs::path& staging, std::time_t now_s) {
  Other other{.name = "an unknown process"};
  const fs::path lock = staging / "lock";
  struct stat status {};
  const int file = ::open(lock.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) {  // not there yet or any more, or another user's
    const bool found = ::stat(lock.c_str(), &status) == 0 || ::stat(staging.c_str(), &status) == 0;
    other.lives = found && now_s - status.st_mtim.tv_sec < kDead_s;
    return other;
  }
  const bool is_free = ::flock(file, LOCK_SH | LOCK_NB) == 0;
  const bool is_held = !is_free && errno == EWOULDBLOCK;
  std::ifstream in(lock);
  std::string start;
  std::getline(in, start);
  std::getline(in, other.name);
  const bool is_recent = ::fstat(file, &status) == 0 && now_s - status.st_mtim.tv_sec < kDead_s;
  other.lives = is_held || (is_recent && !(is_free && start == machineStart()));
  ::close(file);
  return other;
}

}  // namespace

FolderLock::FolderLock(const fs::path& folder)
    : file_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (file_ >= 0) ::flock(file_, LOCK_EX);
}

FolderLock::FolderLock(FolderLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}

FolderLock::~FolderLock() {
  if (file_ >= 0) ::close(file_);
}

StagingFolder::StagingFolder(fs::path folder)
    : folder_(std::move(folder)), staging_(folder_ / (kPrefix + randomToken())) {
  const fs::path unlocked = staging_ / "unlocked";
  std::error_code error;
  fs::create_directory(staging_, error);
  for (const char* part : {"claims", "new", "old"}) {
    if (!error) fs::create_directory(staging_ / part, error);
  }
  try {
    if (error) throw std::runtime_error(cannotWrite(folder_));
    writeText(unlocked, machineStart() + '\n' + ownName() + '\n');
    lock_ = ::open(unlocked.c_str(), O_RDWR | O_CLOEXEC);
    if (lock_ < 0) throw std::runtime_error(cannotWrite(folder_));
    ::flock(lock_, LOCK_EX | LOCK_NB);
    fs::rename(unlocked, staging_ / "lock");  // it appears locked
  } catch (const std::runtime_error&) {
    if (lock_ >= 0) ::close(lock_);
    fs::remove_all(staging_, error);
    throw std::runtime_error(cannotWrite(folder_));
  }
}

StagingFolder::~StagingFolder() {
  // A thread that still writes may add a file while the others are removed.
  constexpr int kTries = 100;
  std::error_code error;
  for (int i = 0; i < kTries && fs::exists(fs::symlink_status(staging_, error)); ++i) {
    fs::remove_all(staging_, error);
  }
  ::close(lock_);
}

void StagingFolder::touch() const noexcept { ::futimens(lock_, nullptr); }

void StagingFolder::claim(const std::string& name) {
  const FolderLock lock(folder_);  // of two runs that claim at once, one sees the other
  const fs::path claim = fs::path("claims") / name;
  make(claim, folder_ / name);
  if (!all_) requireAlone(claim, folder_ / name);  // a run of many images looks around once
}

void StagingFolder::claimAll() {
  const FolderLock lock(folder_);
  make("all", folder_);
  requireAlone("all", folder_);
  all_ = true;
}

void StagingFolder::make(const fs::path& claim, const fs::path& place) const {
  const int file = ::open((staging_ / claim).c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) throw std::runtime_error(cannotWrite(place));
  ::close(file);
}

void StagingFolder::requireAlone(const fs::path& claim, const fs::path& place) const {
  touch();
  struct stat status {};
  const std::time_t now_s =
      ::fstat(lock_, &status) == 0 ? status.st_mtim.tv_sec : std::time(nullptr);
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_, error)) {
    if (entry.path() == staging_ || !isStaging(entry.path().filename().string())) continue;
    if (!fs::is_directory(entry.symlink_status(error))) continue;
    const Other other = ownerOf(entry.path(), now_s);
    if (!other.lives) {
      fs::remove_all(entry.path(), error);
    } else if (fs::exists(entry.path() / claim, error)) {
      throw InputError(place.string(), "foci writes there already (" + other.name +
                                           "): expected another place, or to wait for its end");
    }
  }
}

}  // namespace foci
