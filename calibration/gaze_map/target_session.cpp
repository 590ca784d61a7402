#include "calibration/gaze_map/target_session.h"

#include <cassert>
#include <random>
#include <utility>

namespace foci {
namespace {

// Times and radii chosen by hand, in the range of commercial trackers.
constexpr double kShrink_s = 0.7;    // the shrinking dot draws the eye to its centre
constexpr double kSettle_s = 0.3;    // for the saccade to the target and its correction
constexpr double kStable_s = 0.35;   // gaze must rest this long
constexpr double kStable_deg = 1.2;  // within this radius; the noise of a webcam stays inside
constexpr double kCollect_s = 0.8;   // samples are kept
constexpr double kBlink_s = 0.5;     // a longer gap is no blink
constexpr double kPatience_s = 6.0;  // then the session takes an unsteady gaze, too
constexpr double kEdge = 0.1;        // of the screen, from its edge to the outermost targets

}  // namespace

std::vector<glm::dvec2> targetLayout(int count) {
  assert(count == 4 || count == 5 || count == 9 || count == 13 || count == 16);
  if (count == 4) return {{0.3, 0.25}, {0.75, 0.3}, {0.7, 0.75}, {0.25, 0.7}};
  std::vector<glm::dvec2> places;
  const auto grid = [&](int side, double low, double high) {
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        const double step = (high - low) / (side - 1);
        places.push_back({low + step * i, low + step * j});
      }
    }
  };
  grid(count == 5 ? 2 : count == 16 ? 4 : 3, kEdge, 1.0 - kEdge);
  if (count == 5) places.push_back({0.5, 0.5});
  if (count == 13) grid(2, 0.3, 0.7);
  return places;
}

std::vector<glm::dvec2> shuffled(std::vector<glm::dvec2> targets, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  // std::shuffle differs between standard libraries.
  for (std::size_t i = targets.size(); i > 1; --i) std::swap(targets[i - 1], targets[random() % i]);
  return targets;
}

TargetSession::TargetSession(std::vector<glm::dvec2> targets_deg, bool manual)
    : targets_(std::move(targets_deg)), manual_(manual) {}

bool TargetSession::stable() const {
  if (recent_.size() < 5 || recent_.back().first - recent_.front().first < 0.8 * kStable_s) {
    return false;
  }
  glm::dvec2 mean{0.0};
  for (const auto& [time, gaze] : recent_) mean += gaze / static_cast<double>(recent_.size());
  for (const auto& [time, gaze] : recent_) {
    if (glm::length(gaze - mean) > kStable_deg) return false;
  }
  return true;
}

void TargetSession::next(double time_s) {
  ++target_;
  confirmed_ = false;
  collecting_since_s_.reset();
  shown_since_s_ = time_s;
  recent_.clear();
}

TargetSession::Step TargetSession::update(double time_s, const std::optional<glm::dvec2>& gaze) {
  Step step{.target = target_};
  if (done()) return step;
  if (!shown_since_s_) shown_since_s_ = seen_last_s_ = time_s;
  if (gaze) {
    // After waiting for the eye, start this target anew.
    if (time_s - seen_last_s_ > kBlink_s && !collecting_since_s_) shown_since_s_ = time_s;
    seen_last_s_ = time_s;
    recent_.emplace_back(time_s, *gaze);
  }
  while (!recent_.empty() && recent_.front().first < time_s - kStable_s) recent_.pop_front();
  step.gaze_missing = time_s - seen_last_s_ > kBlink_s;
  const double shown_s = time_s - *shown_since_s_;
  step.shrink = std::min(shown_s / kShrink_s, 1.0);

  if (!collecting_since_s_ && !step.gaze_missing && shown_s >= kShrink_s + kSettle_s) {
    const bool ready = confirmed_ || (!manual_ && (stable() || shown_s > kPatience_s));
    if (ready) collecting_since_s_ = time_s;
  }
  if (!collecting_since_s_) return step;
  step.collecting = true;
  pairs_.push_back({.gaze = gaze, .target = targets_[target_], .time_s = time_s, .weight = 1.0});
  if (time_s - *collecting_since_s_ >= kCollect_s) next(time_s);
  step.target = target_;
  return step;
}

}  // namespace foci
