#include "base/quiet_stderr.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <mutex>

namespace foci {
namespace {

std::mutex quiet_mutex;
int alive = 0;
int kept_stderr = -1;  // a copy of standard error while it leads nowhere

}  // namespace

QuietStderr::QuietStderr() {
  const std::lock_guard lock(quiet_mutex);
  if (alive++ > 0) return;
  std::fflush(stderr);
  kept_stderr = ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (kept_stderr >= 0 && nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
  if (nowhere >= 0) ::close(nowhere);
}

QuietStderr::~QuietStderr() {
  const std::lock_guard lock(quiet_mutex);
  if (--alive > 0 || kept_stderr < 0) return;
  std::fflush(stderr);
  ::dup2(kept_stderr, STDERR_FILENO);
  ::close(kept_stderr);
  kept_stderr = -1;
}

}  // namespace foci
