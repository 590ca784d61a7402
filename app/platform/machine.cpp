#include "app/platform/machine.h"

#include <malloc.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "base/memory_budget.h"
#include "render/splat/sweep.h"

namespace foci {
namespace fs = std::filesystem;
namespace {

std::string firstLineOf(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

/// A line of /proc in kB, "VmHWM:  20 kB"; 0 if it is not there.
double linuxMemory_GB(const fs::path& file, const std::string& name) {
  std::ifstream in(file);
  double kB = 0.0;
  for (std::string word; in >> word;) {
    if (word == name) in >> kB;
  }
  return kB * 1024e-9;
}

}  // namespace

double freeMemory_GB() {
  return std::min(linuxMemory_GB("/proc/meminfo", "MemAvailable:"),
                  1e-9 * static_cast<double>(memoryOfMachine()));
}

double peakMemory_GB() { return linuxMemory_GB("/proc/self/status", "VmHWM:"); }

void forgetPeakMemory() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << 5;  // proc(5)
}

Machine describeMachine() {
  Machine machine{.cpu = "unknown",
                  .cores = std::thread::hardware_concurrency(),
                  .simd = "unknown",
                  .system = "unknown"};
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    if (line.starts_with("model name")) {
      machine.cpu = line.substr(std::min(line.size(), line.find(": ") + 2));
      break;
    }
  }
  machine.simd = simdTarget();
  utsname system{};
  if (uname(&system) == 0) {
    machine.system = std::string(system.sysname) + " " + system.release + " " + system.machine;
  }
  return machine;
}

fs::path programFile() {
  std::error_code unknown;
  return fs::read_symlink("/proc/self/exe", unknown);
}

bool cameWithPackage() {
  const std::string program = programFile().string();
  std::ifstream files("/var/lib/dpkg/info/foci.list");
  for (std::string file; std::getline(files, file);) {
    if (file == program) return true;
  }
  return false;
}

std::optional<std::vector<std::string>> installedPackages() {
  std::ifstream status("/var/lib/dpkg/status");
  if (!status) return std::nullopt;
  std::vector<std::string> installed;
  std::string name;
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("Package: ")) name = line.substr(9);
    if (line == "Status: install ok installed") installed.push_back(name);
  }
  return installed;
}

std::vector<Camera> cameras() {
  std::error_code none;
  std::vector<fs::path> nodes;
  for (const auto& entry : fs::directory_iterator("/sys/class/video4linux", none)) {
    // A camera has further nodes for metadata: only index 0 delivers images.
    if (firstLineOf(entry.path() / "index") == "0") nodes.push_back(entry.path());
  }
  std::ranges::sort(nodes);
  std::vector<Camera> all;
  for (const fs::path& node : nodes) {
    const std::string device = "/dev/" + node.filename().string();
    all.push_back({.device = device,
                   .name = firstLineOf(node / "name"),
                   .allowed = access(device.c_str(), R_OK | W_OK) == 0});
  }
  return all;
}

struct OneCore::Cores {
  cpu_set_t set;
};

OneCore::OneCore() {
  auto before = std::make_unique<Cores>();
  if (sched_getaffinity(0, sizeof before->set, &before->set) != 0) return;
  cpu_set_t one;
  CPU_ZERO(&one);
  for (int core = 0; core < CPU_SETSIZE; ++core) {
    if (!CPU_ISSET(core, &before->set)) continue;
    CPU_SET(core, &one);
    break;
  }
  if (sched_setaffinity(0, sizeof one, &one) == 0) before_ = std::move(before);
}

OneCore::~OneCore() {
  if (before_) sched_setaffinity(0, sizeof before_->set, &before_->set);
}

void yieldToOtherThreads() {
  constexpr int kNice = 10;  // setpriority(2)
  const sched_param usual{};
  (void)sched_setscheduler(0, SCHED_BATCH, &usual);
  (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
}

}  // namespace foci
