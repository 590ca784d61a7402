// What the trained detector knows of a sample: motion at several time scales, relative to the
// noise.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "gaze/events/gaze_speed.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Lengths of the windows. The shortest resolves a saccade's edge, the longest holds a fixation.
inline constexpr std::array<double, 6> kScale_s = {0.008, 0.016, 0.032, 0.064, 0.128, 0.256};

/// models/README.md lists them with unit and formula.
inline constexpr std::size_t kGazeFeatures = 74;
using GazeFeatureVector = std::array<float, kGazeFeatures>;

/// How far the features of a sample look ahead at most.
inline constexpr double kMaxAhead_s = kScale_s.back();

/// Standard deviations of the velocity along each axis by noise alone, deg/s, for each scale.
using ScaleNoise = std::array<double, kScale_s.size()>;

/// Computes features while samples arrive. Time per sample does not grow. Every window
/// ends at a sample and reaches back from it, so that it never changes once its sample is known.
class GazeFeatures {
 public:
  /// @param rate_Hz       nominal sampling rate, > 0
  /// @param noise_span_s  the noise is that of so long a time before the newest sample
  GazeFeatures(double rate_Hz, double noise_span_s);

  /// @param in_head  the direction before any turn of the head, for the size of its rounding
  void push(const TimedSight& sight, const std::optional<glm::dvec3>& in_head);

  std::size_t pushed() const { return dropped_ + rows_.size(); }

  /// Forgets what `of` does not need from this sample on. Without it, memory grows.
  void forgetBefore(std::size_t sample);

  /// @param sample   counted from 0; not forgotten
  /// @param ahead_s  samples that are later by more than this are not used
  GazeFeatureVector of(std::size_t sample, double ahead_s) const;

  /// Standard deviation of a sample's error along each axis; 0 before it is known.
  double noise_deg() const;

 private:
  /// The samples of a window that ends at a sample.
  struct Window {
    double count = 0.0;
    glm::dvec3 mean{0.0};            ///< direction
    glm::dvec3 velocity_deg_s{0.0};  ///< least squares
    double spread_deg = 0.0;         ///< standard deviation from the mean, both axes
    double middle_s = 0.0;           ///< mean of the times
  };
  struct Row {
    double time_s = 0.0;
    std::optional<glm::dvec3> direction{};
    double lost_s = -1e9;     ///< time of the newest sample without gaze, up to this one
    double present_s = -1e9;  ///< time of the newest sample with gaze, up to this one
    double losses = 0.0;      ///< samples without gaze since the first
    std::array<Window, kScale_s.size()> windows{};
  };
  struct Peak {
    double speed_deg_s = 0.0, time_s = 0.0;
    glm::dvec3 velocity_deg_s{0.0};
  };

  void measureWindows();
  void noteChanges();
  void measureNoise();
  double rounding_deg() const;
  const Row& row(std::size_t sample) const {
    assert(sample >= dropped_ && sample < pushed());
    return rows_[sample - dropped_];
  }
  std::size_t lastUpTo(std::size_t from, double time_s) const;
  std::size_t lastBefore(std::size_t from, double time_s) const;
  void addPeaks(std::size_t sample, std::size_t newest, std::size_t scale, float*& out) const;
  void addProgress(std::size_t sample, std::size_t newest, double reach_s, float*& out) const;
  void addLosses(std::size_t sample, std::size_t newest, float*& out) const;

  double rate_Hz_, noise_span_s_;
  std::deque<Row> rows_{};
  std::size_t dropped_ = 0;
  std::array<std::vector<float>, kScale_s.size()> changes_deg_s_{};  ///< below 0 if unknown
  std::vector<float> steps_deg_{}, sorted_{};
  std::size_t changes_from_ = 0, changes_count_ = 0;  // rings of `span_` values
  std::size_t span_ = 1;
  std::optional<glm::dvec3> last_in_head_{};
  double measured_s_ = 0.0;
  ScaleNoise noise_deg_s_{};
};

}  // namespace foci
