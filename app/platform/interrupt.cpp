#include "app/platform/interrupt.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>
#include <thread>

#include "app/platform/output_files.h"

namespace foci {
namespace {

/// `timeout` and job schedulers send a signal twice at once: to the process and to its group.
constexpr std::chrono::seconds kOneRequest(2);
constexpr int kHeartbeat_ms = 10'000;

std::atomic<bool> interrupted{false}, only_noted{false};
std::array<int, 2> signals{-1, -1};  // a pipe from the handler to the thread

void onSignal(int /*signal*/) {
  const int error = errno;
  interrupted = true;
  const char byte = 0;
  [[maybe_unused]] const ssize_t written = ::write(signals[1], &byte, 1);
  errno = error;
}

[[noreturn]] void endAtOnce() {
  removeUnfinishedOutputs();
  std::fputs(::isatty(STDERR_FILENO) != 0 ? "\n" : "", stderr);  // after a progress bar
  std::fputs("foci: interrupted; unfinished files were removed\n", stderr);
  ::_exit(1);
}

void watchSignals() {
  std::optional<std::chrono::steady_clock::time_point> first;
  for (;;) {
    pollfd waiting{.fd = signals[0], .events = POLLIN, .revents = 0};
    const int ready = ::poll(&waiting, 1, kHeartbeat_ms);
    if (ready == 0) touchUnfinishedOutputs();
    char byte = 0;
    if (ready <= 0 || ::read(signals[0], &byte, 1) != 1) continue;
    if (!first) first = std::chrono::steady_clock::now();
    if (!only_noted || std::chrono::steady_clock::now() - *first >= kOneRequest) endAtOnce();
  }
}

}  // namespace

void endCleanlyOnInterrupts() {
  if (signals[1] >= 0 || ::pipe2(signals.data(), O_CLOEXEC) != 0) return;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    if (::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = onSignal;
    action.sa_flags = SA_RESTART;
    ::sigaction(signal, &action, nullptr);
  }
  std::thread(watchSignals).detach();
}

void noteInterrupts() {
  only_noted = true;
  endCleanlyOnInterrupts();
}

bool isInterrupted() { return interrupted; }

}  // namespace foci
