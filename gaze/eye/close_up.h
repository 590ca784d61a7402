// The infrared close-up of an eye: pupil and glint, frame by frame, and blinks.
#pragma once

#include <glm/glm.hpp>
#include <optional>

namespace cv {
class Mat;
}

namespace foci {

struct CloseUpPupil {
  glm::dvec2 centre_px{0.0};  ///< of the ellipse; the image's top-left corner is (0, 0)
  glm::dvec2 radii_px{0.0};   ///< half axes, the longer first
  double angle_rad = 0.0;     ///< from the x axis to the longer one, clockwise on the image
  /// Share of the outline, in directions from the centre, that lies on the ellipse: about 1 in an
  /// open eye, falling while the lid comes down.
  double confidence = 0.0;
  std::optional<glm::dvec2> glint_px{};  ///< the light's reflection on or next to the pupil
};

/// The pupil is the darkest round region: thresholds from the darkest grey upwards give seeds; from
/// the best one rays look for the steepest rise to sub-pixel precision, and an ellipse is fitted to
/// what agrees (after Li, Winfield and Parkhurst 2005, "Starburst").
/// @param grey  8 bits, one channel, at least 32 x 32
/// @return nothing in a closed eye
std::optional<CloseUpPupil> findCloseUpPupil(const cv::Mat& grey);

/// Counts blinks: the pupil is gone, or covered by more than half, for 50 ms to a second.
class BlinkCounter {
 public:
  /// @param confidence  of the pupil, 0 where there is none
  void push(double time_s, double confidence);

  int blinks() const { return blinks_; }  ///< that have ended
  bool closed() const { return closed_s_.has_value(); }

 private:
  std::optional<double> closed_s_{};
  int blinks_ = 0;
};

}  // namespace foci
