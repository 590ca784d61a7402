#include "render/methods/time_budget.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace foci {
namespace {

constexpr float kNews = 0.2f;        // share of the last time in what is expected
constexpr float kMaxGrowth = 2.0f;   // beyond it a time is the machine's own doing: it counts less
constexpr float kFitsWell = 0.8f;    // of the budget
constexpr float kFade = 0.9998f;     // a frame: half as long in a minute at 60 frames a second
constexpr float kFadeMoved = 0.98f;  // half as long in half a second

}  // namespace

TimeBudget::TimeBudget(std::span<const float> likely) : last_(likely.size()) {
  for (const float each : likely) ways_.push_back({.likely = each});
}

float TimeBudget::expected_ms(std::size_t way) const {
  if (ways_[way].ms > 0.0f) return ways_[way].ms;
  // As the known way that it is most alike.
  float expected_ms = std::numeric_limits<float>::infinity(), apart = expected_ms;
  for (const Way& known : ways_) {
    const float ratio = ways_[way].likely / known.likely;
    if (known.ms <= 0.0f || std::abs(std::log(ratio)) >= apart) continue;
    apart = std::abs(std::log(ratio));
    expected_ms = ratio * known.ms;
  }
  return expected_ms;
}

bool TimeBudget::fits(std::size_t way, float budget_ms) const {
  return expected_ms(way) <= (way == last_ ? 1.0f : kFitsWell) * budget_ms;
}

void TimeBudget::took(std::size_t way, float ms, bool moved) {
  for (Way& other : ways_) other.ms *= moved ? kFadeMoved : kFade;
  float& known_ms = ways_[way].ms;
  known_ms = known_ms > 0.0f
                 ? (1.0f - kNews) * known_ms + kNews * std::min(ms, kMaxGrowth * known_ms)
                 : ms;
  last_ = way;
}

}  // namespace foci
