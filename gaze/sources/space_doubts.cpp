// The limits are those of heads and eyes, chosen by hand. Eyes turn by 50 degrees at most. People
// who look around seldom turn them by more than 20 degrees (Stahl 1999).
#include <cmath>

#include "base/quantile.h"
#include "base/text.h"
#include "gaze/sources/trace_doubts.h"

namespace foci {
namespace {

constexpr std::size_t kMinSamples = 100;
constexpr double kMaxEye_deg = 50.0;
constexpr double kManyBehind = 0.02, kManyBeside = 0.2;  // shares of the gaze
constexpr double kAhead = 0.85, kNotAhead = 0.75;        // mean cosines from the forward axis
constexpr double kMinUp = 0.5;                           // cosine of the usual tilt of the head
constexpr double kMaxUsualSpeed_m_s = 2.0;               // of a head; people stand or stroll
constexpr double kMinHeight_m = -0.5;  // of a head above the floor, or about its first place
constexpr double kMaxSpan_m = 100.0;   // of tracked space
constexpr double kTurned = 0.94, kStill_m = 0.002;  // cosine of 20 deg; a head is not a point
constexpr double kMinIpd_m = 0.045, kMaxIpd_m = 0.08;
constexpr double kDivergence_deg = -3.0, kConvergence_deg = 25.0;  // between the eyes, usual

const glm::dvec3 kForward(0.0, 0.0, -1.0);

double median(std::vector<double> values) { return quantile(values, 0.5); }

}  // namespace

void SpaceDoubts::add(const GazeSample& sample) {
  if (!sample.head && !sample.direction) return;
  if (sample.direction) {
    const double cosine = glm::dot(*sample.direction, kForward);
    ++gazes_;
    behind_ += cosine <= 0.0;
    beside_ += cosine < std::cos(glm::radians(kMaxEye_deg));
  }
  kept_.add([&] { return sample; });
}

/// Gaze that no eye has. If it lies ahead of the head in the other frame, the frame is wrong.
void SpaceDoubts::stateGaze(bool in_world, Doubts& doubts) const {
  double ahead = 0.0, ahead_otherwise = 0.0, count = 0.0;
  for (const GazeSample& sample : kept_.kept()) {
    if (!sample.direction || !sample.head) continue;
    const glm::dquat& turn = sample.head->world_from_head;
    const glm::dvec3 otherwise = (in_world ? turn : glm::conjugate(turn)) * *sample.direction;
    ahead += glm::dot(*sample.direction, kForward);
    ahead_otherwise += glm::dot(otherwise, kForward);
    count += 1.0;
  }
  const double all = static_cast<double>(gazes_);
  const double behind = static_cast<double>(behind_) / all;
  const double beside = static_cast<double>(beside_) / all;
  doubts.add(count > 0.0 && ahead < kNotAhead * count && ahead_otherwise > kAhead * count,
             std::string("gaze is not ahead of the head, but would be in the other frame: is "
                         "gaze.frame = \"") +
                 (in_world ? "head" : "world") + "\" right?") ||
      doubts.add(behind > kManyBehind, percent(behind) +
                                           " of the gaze is behind the eyes: are gaze.axes and "
                                           "gaze.frame right, and the order of the columns?") ||
      doubts.add(beside > kManyBeside,
                 percent(beside) + " of the gaze is more than " + decimal(kMaxEye_deg, 0) +
                     " deg from straight ahead, farther than eyes turn: are gaze.frame, gaze.axes "
                     "and gaze.angle_units right?");
}

void SpaceDoubts::stateHead(bool y_is_up, Doubts& doubts) const {
  std::vector<double> up, height_m, speed_m_s;
  glm::dvec3 low_m(INFINITY), high_m(-INFINITY), forward(0.0);
  const GazeSample* before = nullptr;
  for (const GazeSample& sample : kept_.kept()) {
    if (!sample.head) continue;
    const HeadInWorld& head = *sample.head;
    up.push_back((head.world_from_head * glm::dvec3(0.0, 1.0, 0.0)).y);
    height_m.push_back(head.position_m.y);
    forward += head.world_from_head * kForward;
    low_m = glm::min(low_m, head.position_m);
    high_m = glm::max(high_m, head.position_m);
    if (before) {
      speed_m_s.push_back(glm::distance(head.position_m, before->head->position_m) /
                          (sample.time_s - before->time_s));
    }
    before = &sample;
  }
  if (up.size() < kMinSamples) return;
  doubts.add(
      y_is_up && median(up) < kMinUp,
      "the head is not upright: are gaze.axes and the order of the orientation's columns right "
      "(gaze.head_quaternion is x, y, z, w)?");
  const double usual_m = median(height_m);
  doubts.add(y_is_up && usual_m < kMinHeight_m,
             "the head is " + significant(-usual_m, 3) +
                 " m below the recording's origin, which is usually the floor: does y point "
                 "down (gaze.axes), and is gaze.head_scale_m right?");
  const double span_m = glm::length(high_m - low_m), usual_m_s = median(speed_m_s);
  doubts.add(usual_m_s > kMaxUsualSpeed_m_s || span_m > kMaxSpan_m,
             "the head moves at " + significant(usual_m_s, 2) + " m/s over " +
                 significant(span_m, 2) +
                 " m: is gaze.head_scale_m right (0.001 for mm, 0.01 for cm), and "
                 "gaze.time_scale_s?");
  const bool turns = glm::length(forward) < kTurned * static_cast<double>(up.size());
  doubts.add(turns && span_m > 0.0 && span_m < kStill_m,
             "the head turns but moves by " + significant(span_m, 2) +
                 " m only: is gaze.head_scale_m right?");
  doubts.add(
      turns && span_m == 0.0,
      "the head turns but its place does not change: expected gaze.head_position, unless the "
      "headset tracks no place");
}

void SpaceDoubts::stateEyes(Doubts& doubts) const {
  std::vector<double> apart_m, right_of_left_m, converged_deg;
  for (const GazeSample& sample : kept_.kept()) {
    const auto& [left, right] = sample.eyes;
    if (left.origin_m && right.origin_m) {
      apart_m.push_back(glm::distance(*left.origin_m, *right.origin_m));
      right_of_left_m.push_back(right.origin_m->x - left.origin_m->x);
    }
    if (left.direction && right.direction) {
      const auto turn = [](const glm::dvec3& d) { return std::atan2(d.x, -d.z); };
      converged_deg.push_back(glm::degrees(turn(*left.direction) - turn(*right.direction)));
    }
  }
  if (apart_m.size() >= kMinSamples) {
    const double usual_m = median(apart_m);
    doubts.add(usual_m < kMinIpd_m || usual_m > kMaxIpd_m,
               "the eyes are " + significant(usual_m, 3) +
                   " m apart, and people's 0.05 to 0.075 m: is gaze.origin_scale_m right "
                   "(0.001 for mm), and the scene's scale?") ||
        doubts.add(median(right_of_left_m) < 0.0,
                   "the left eye lies to the right of the right eye: are gaze.left_origin and "
                   "gaze.right_origin swapped, or gaze.axes wrong?");
  }
  if (converged_deg.size() < kMinSamples) return;
  const double usual_deg = median(converged_deg);
  doubts.add(usual_deg < kDivergence_deg || usual_deg > kConvergence_deg,
             std::string("the lines of sight ") +
                 (usual_deg < 0.0 ? "diverge by " : "converge by ") +
                 significant(std::abs(usual_deg), 2) +
                 " deg, as no eyes do: are the columns of the left and the right eye right, "
                 "and gaze.axes?");
}

void SpaceDoubts::state(bool in_world, bool y_is_up, Doubts& doubts) const {
  if (gazes_ >= kMinSamples) stateGaze(in_world, doubts);
  stateHead(y_is_up, doubts);
  stateEyes(doubts);
}

}  // namespace foci
