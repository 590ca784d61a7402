// A monotonic clock that runs FOCI_CLOCK_SPEED times as fast, for programs that preload this
// library. Observers then play through a window in a fraction of the time. Sleeps and timeouts keep
// their real length; a program that waits until a point of time must not preload this library.
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

double speed() {
  const char* text = std::getenv("FOCI_CLOCK_SPEED");
  return text ? std::atof(text) : 1.0;
}

}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const long result = syscall(SYS_clock_gettime, clock, time);
  if (result != 0 || clock != CLOCK_MONOTONIC) return static_cast<int>(result);
  const std::int64_t now_ns = time->tv_sec * kSecond_ns + time->tv_nsec;
  static const std::int64_t start_ns = now_ns;
  static const double factor = speed();
  const auto since_ns = static_cast<std::int64_t>(factor * static_cast<double>(now_ns - start_ns));
  time->tv_sec = (start_ns + since_ns) / kSecond_ns;
  time->tv_nsec = (start_ns + since_ns) % kSecond_ns;
  return 0;
}
