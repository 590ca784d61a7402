#include "render/methods/quality_level.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"

namespace foci {
namespace {

// All chosen by hand. TimeBudget.OneSlowFrameDoesNotRuleALevelOut bounds the first two, and
// TimeBudget.TriesAgainSoonerWhereTheViewMoves the decays.

/// Weight of the newest time in the running mean.
constexpr float kNewest = 0.2f;
/// A time beyond this factor is the machine's doing, and is clipped.
constexpr float kMaxTimeGrowth = 2.0f;
/// Share of the budget that a level may be expected to use if it was not the last one.
constexpr float kFitsWell = 0.8f;
/// Decay of a level's time with each frame of another level: half in a minute at 60 frames a
/// second, and half in half a second where the view moves.
constexpr float kDecay = 0.9998f, kDecayMoved = 0.98f;

}  // namespace

std::optional<QualityLevel> qualityLevelNumbered(int n) {
  if (n < 1 || n > static_cast<int>(kQualityLevels)) return std::nullopt;
  return QualityLevel{static_cast<std::uint8_t>(n - 1)};
}

std::string textOf(QualityLevel level) {
  return std::string(kAutoMethod) + ':' + std::to_string(static_cast<int>(level) + 1);
}

std::optional<QualityLevel> qualityLevelFrom(std::string_view method) {
  const std::string before = std::string(kAutoMethod) + ':';
  if (!method.starts_with(before)) return std::nullopt;
  const auto n = parseInteger<int>(method.substr(before.size()));
  return n ? qualityLevelNumbered(*n) : std::nullopt;
}

TimeBudget::TimeBudget(std::span<const float> relative, bool hopeful) : hopeful_(hopeful) {
  for (const float each : relative) timings_.push_back({.relative = each});
}

float TimeBudget::expected_ms(QualityLevel level) const {
  const Timing& asked = of(level);
  if (asked.ms > 0.0f) return asked.ms;
  if (!last_ && hopeful_) return 0.0f;
  // Scale the time of the timed level that is most alike.
  float expected_ms = std::numeric_limits<float>::infinity(), apart = expected_ms;
  for (const Timing& known : timings_) {
    const float ratio = asked.relative / known.relative;
    if (known.ms <= 0.0f || std::abs(std::log(ratio)) >= apart) continue;
    apart = std::abs(std::log(ratio));
    expected_ms = ratio * known.ms;
  }
  return expected_ms;
}

bool TimeBudget::fits(QualityLevel level, float budget_ms) const {
  return expected_ms(level) <= (level == last_ ? 1.0f : kFitsWell) * budget_ms;
}

void TimeBudget::took(QualityLevel level, float ms, bool moved) {
  for (Timing& other : timings_) other.ms *= moved ? kDecayMoved : kDecay;
  float& known_ms = of(level).ms;
  known_ms = known_ms > 0.0f
                 ? (1.0f - kNewest) * known_ms + kNewest * std::min(ms, kMaxTimeGrowth * known_ms)
                 : ms;
  last_ = level;
}

}  // namespace foci
