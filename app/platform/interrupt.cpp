#include "app/platform/interrupt.h"

#include <csignal>
#include <ctime>
#include <stdexcept>

namespace foci {
namespace {

/// `timeout` and job schedulers send a signal twice at once: to the process and to its group.
constexpr std::time_t kOneRequest_s = 2;

volatile std::sig_atomic_t interrupted = 0;
volatile std::time_t first_s = 0;

void onSignal(int signal) {
  const std::time_t now_s = std::time(nullptr);  // may be called by a signal handler (POSIX)
  if (interrupted == 0) {
    first_s = now_s;
    interrupted = 1;
  } else if (now_s - first_s >= kOneRequest_s) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

}  // namespace

void noteInterrupts() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, onSignal);
}

bool isInterrupted() { return interrupted != 0; }

void throwIfInterrupted() {
  if (interrupted) throw std::runtime_error("interrupted; nothing was written");
}

}  // namespace foci
