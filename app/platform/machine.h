// The machine that a result was computed on.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace foci {

struct Machine {
  std::string cpu;     ///< "unknown" if the system does not state it
  unsigned cores = 0;  ///< that this process may use
  std::string simd;    ///< instruction set that the code uses, e.g. "AVX3"
  std::string system;  ///< kernel and release
};

Machine describeMachine();

/// Memory that this process may still take.
double freeMemory_GB();

/// Largest memory that the process held since `forgetPeakMemory`; 0 if the system does not state
/// it.
double peakMemory_GB();
void forgetPeakMemory();

/// The file of this program; empty if the system does not state it.
std::filesystem::path programFile();

/// Whether this program came with the Debian package `foci`. Debian then has installed all that it
/// needs, and nothing that only a build needs is missing.
bool cameWithPackage();

/// The packages that Debian lists as installed; none on a system without that list.
std::optional<std::vector<std::string>> installedPackages();

struct Camera {
  std::string device;    ///< "/dev/video0"
  std::string name;      ///< its own; empty if the system does not state it
  bool allowed = false;  ///< for this user
};

/// The cameras that the system lists, also those in use by another program.
std::vector<Camera> cameras();

/// While it lives, the calling thread may run on one core only.
class OneCore {
 public:
  OneCore();
  ~OneCore();
  OneCore& operator=(OneCore&&) = delete;  // nor copied

 private:
  struct Cores;
  std::unique_ptr<Cores> before_;  // null: nothing was changed
};

/// From now on the calling thread takes about a tenth of a core beside a thread that does not
/// yield, if the system allows that.
void yieldToOtherThreads();

}  // namespace foci
