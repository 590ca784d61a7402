#include "app/platform/progress.h"

#include <unistd.h>

#include <cstdio>

namespace foci {
namespace {

constexpr std::chrono::milliseconds kBarPeriod{100};
constexpr std::chrono::seconds kLinePeriod{3};
constexpr std::size_t kBarWidth = 30;

}  // namespace

Progress::Progress(std::string what, std::string unit, std::size_t total)
    : what_(std::move(what)),
      unit_(std::move(unit)),
      total_(total),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_(Clock::now()),
      shown_(start_) {}

void Progress::advance(std::size_t done) {
  const auto now = Clock::now();
  const bool last = done == total_;
  if (!last && now - shown_ < (terminal_ ? Clock::duration(kBarPeriod) : kLinePeriod)) return;
  shown_ = now;
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  const double left_s = elapsed_s * static_cast<double>(total_ - done) / static_cast<double>(done);
  if (terminal_) {
    const std::size_t filled = kBarWidth * done / total_;
    const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
    std::fprintf(stderr, "\r%s [%s] %zu/%zu %s, %.0f s left \x1b[K%s", what_.c_str(), bar.c_str(),
                 done, total_, unit_.c_str(), left_s, last ? "\n" : "");
  } else {
    std::fprintf(stderr, "%s: %zu of %zu %s, %.0f s\n", what_.c_str(), done, total_, unit_.c_str(),
                 elapsed_s);
  }
}

}  // namespace foci
