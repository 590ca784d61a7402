#include "app/platform/interrupt.h"

#include <csignal>
#include <stdexcept>

namespace foci {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void onSignal(int signal) {
  interrupted = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void noteInterrupts() {
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
}

bool isInterrupted() { return interrupted != 0; }

void throwIfInterrupted() {
  if (interrupted) throw std::runtime_error("interrupted; nothing was written");
}

}  // namespace foci
