#include "app/platform/gnuplot.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <system_error>
#include <thread>

#include "base/text.h"

namespace foci {
namespace {

constexpr std::chrono::seconds kMaxTime(8);  // a chart takes less than one

/// A file in memory: it needs no folder for temporary files.
class MemoryFile {
 public:
  MemoryFile() : file_(::memfd_create("gnuplot", MFD_CLOEXEC)) {}
  ~MemoryFile() { ::close(file_); }
  MemoryFile& operator=(MemoryFile&&) = delete;  // nor copied

  int get() const { return file_; }

  /// @return false if not everything could be written
  bool write(const std::string& text) const {
    for (std::size_t at = 0; at < text.size();) {
      const ssize_t some =
          ::pwrite(file_, text.data() + at, text.size() - at, static_cast<off_t>(at));
      if (some <= 0) return false;
      at += static_cast<std::size_t>(some);
    }
    return true;
  }

  std::string read() const {
    std::string text;
    std::array<char, 65536> block;
    for (ssize_t some = 0; (some = ::pread(file_, block.data(), block.size(),
                                           static_cast<off_t>(text.size()))) > 0;) {
      text.append(block.data(), static_cast<std::size_t>(some));
    }
    return text;
  }

 private:
  int file_;
};

/// Waits for a process.
/// @return why it failed; empty: it ended well
std::string problemOf(pid_t child) {
  const auto end = std::chrono::steady_clock::now() + kMaxTime;
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      return "gnuplot did not end within 8 s";
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (WIFSIGNALED(status)) return "gnuplot was ended by a signal";
  return status == 0 ? "" : "gnuplot failed with exit code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

std::string gnuplotString(const std::string& text) {
  return "('" + replaced(visible(text), "'", "'.\"'\".'") + "')";
}

GnuplotChart runGnuplot(const std::string& script) {
  const MemoryFile in, out;
  if (in.get() < 0 || out.get() < 0 || !in.write(script)) {
    return {.problem = "no memory for gnuplot's files"};
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in.get(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out.get(), STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  std::string name = "gnuplot", option = "-d";  // without the user's own settings
  char* arguments[] = {name.data(), option.data(), nullptr};
  pid_t child = 0;
  const int spawned = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (spawned == ENOENT) {
    return {.problem = "gnuplot is not installed (apt install gnuplot-nox)"};
  }
  if (spawned != 0) {
    return {.problem = "gnuplot cannot run: " + std::generic_category().message(spawned)};
  }
  GnuplotChart chart{.problem = problemOf(child)};
  if (!chart.problem.empty()) return chart;
  std::string text = out.read();
  if (text.empty()) return {.problem = "gnuplot drew nothing"};
  chart.image = std::move(text);
  return chart;
}

}  // namespace foci
