#include "tests/e2e/binary.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>

namespace foci::e2e {
namespace fs = std::filesystem;
namespace {

/// Runs in the child between fork and exec. @return false on failure
bool enter(const Fault& fault, const fs::path& folder, const fs::path& out, const fs::path& err) {
  if (chdir(folder.c_str()) != 0 || !freopen(out.c_str(), "w", stdout) ||
      !freopen(err.c_str(), "w", stderr)) {
    return false;
  }
  if (fault.max_file_bytes) {
    signal(SIGXFSZ, SIG_IGN);  // the write fails, and the process lives on
    const rlimit limit{*fault.max_file_bytes, *fault.max_file_bytes};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) return false;
  }
  alarm(fault.max_s);
  constexpr uid_t kNobody = 65534;
  if (fault.as_nobody && getuid() == 0 && setuid(kNobody) != 0) return false;
  setenv("XDG_CACHE_HOME", cacheWithoutScenes().c_str(), 1);
  for (const std::string& variable : fault.environment) {
    putenv(const_cast<char*>(variable.c_str()));
  }
  return true;
}

}  // namespace

Outcome runFociUnder(const Fault& fault, const std::vector<std::string>& arguments,
                     const fs::path& folder) {
  const TemporaryFolder streams;
  const fs::path out = streams.path() / "out", err = streams.path() / "err";
  std::vector<char*> argv = {const_cast<char*>(FOCI_BINARY)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);

  const pid_t child = fork();
  if (child == 0) {
    if (!enter(fault, folder, out, err)) _exit(126);
    execv(FOCI_BINARY, argv.data());
    _exit(127);
  }
  int status = 0;
  if (fault.killed_after_ms) {
    usleep(static_cast<useconds_t>(1000 * *fault.killed_after_ms));
    kill(child, SIGKILL);
  }
  bool seen = !fault.appears;
  while (!seen && waitpid(child, &status, WNOHANG) == 0) {
    seen = fs::exists(*fault.appears);
    if (!seen) usleep(1000);
  }
  if (seen) {
    for (const int signal : fault.signals) kill(child, signal);
    for (const fs::path& file : fault.vanish) fs::remove(file);
    waitpid(child, &status, 0);
  }
  return {.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
          .out = textOf(out),
          .err = textOf(err)};
}

Outcome runFoci(const std::vector<std::string>& arguments, const fs::path& folder,
                const std::vector<std::string>& environment) {
  return runFociUnder({.environment = environment}, arguments, folder);
}

Outcome terminateFoci(const std::vector<std::string>& arguments, const fs::path& folder,
                      const fs::path& appears, const std::vector<int>& signals) {
  return runFociUnder({.appears = appears, .signals = signals}, arguments, folder);
}

std::optional<fs::path> dataFolder() {
  const char* named = std::getenv("FOCI_DATA");
  const fs::path folder = named ? fs::path(named) : fs::path(FOCI_SOURCE_DIR) / "../shared/data";
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) return std::nullopt;
  return folder;
}

std::string squarePly(int n, double distance_m) {
  std::ostringstream ply;
  ply << "ply\nformat ascii 1.0\nelement vertex " << n * n
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
         "property uchar green\nproperty uchar blue\nend_header\n";
  for (int i = 0; i < n * n; ++i) {
    const double x = (i % n + 0.5) / n - 0.5, y = (i / n + 0.5) / n - 0.5;
    ply << 2.0 * x << ' ' << 2.0 * y << ' ' << -distance_m << ' ' << (i * 37) % 256 << " 128 "
        << (i % n * 255) / n << '\n';
  }
  return ply.str();
}

std::string reliefPly(const std::function<double(int x, int y)>& depth_m) {
  std::ostringstream ply;
  ply << "ply\nformat ascii 1.0\nelement vertex 3600\nproperty float x\nproperty float y\n"
         "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
         "end_header\n";
  for (int i = 0; i < 3600; ++i) {
    const int x = i % 60, y = i / 60;
    ply << (x + 0.5) / 60 - 0.5 << ' ' << (y + 0.5) / 60 - 0.5 << ' ' << -depth_m(x, y) << ' '
        << (x * 37) % 256 << " 90 " << (y * 53) % 256 << '\n';
  }
  return ply.str();
}

std::string smallStudy() {
  return "[scene]\nfile = \"scene.ply\"\n"
         "[eye]\nposition_m = [0, 0, 0]\nlook_at_m = [0, 0, -1]\n"
         "[screen]\nsize_px = [640, 480]\nsize_m = [0.4, 0.3]\ndistance_m = 0.5\n"
         "[gaze]\nsource = \"trace.tsv\"\n"
         "[output]\nsize_px = [96, 72]\nfps = 10\nseconds = [0, 0.6]\n";
}

std::string steadyTrace() {
  std::ostringstream trace;
  trace << "time_s\tx_px\ty_px\n";
  for (int i = 0; i < 100; ++i) trace << 0.01 * i << "\t320\t" << 240 + i % 2 << '\n';
  return trace.str();
}

std::vector<std::vector<std::string>> tableOf(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    auto& row = rows.emplace_back();
    for (std::string field; std::getline(fields, field, '\t');) row.push_back(field);
  }
  return rows;
}

}  // namespace foci::e2e
