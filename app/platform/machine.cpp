#include "app/platform/machine.h"

#include <sys/utsname.h>

#include <fstream>
#include <thread>

#include "render/splat/sweep.h"

namespace foci {

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

}  // namespace foci
