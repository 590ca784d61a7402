#include "app/replay/surface_agreement.h"

#include "base/text.h"

namespace foci {
namespace {

constexpr std::size_t kMinFrames = 10;
// Shares of the frames, chosen by hand.
constexpr double kMostWithout = 0.5, kOftenApart = 0.2, kOftenDiverge = 0.5;

std::string percentOf(std::size_t part, std::size_t all) {
  return decimal(100.0 * static_cast<double>(part) / static_cast<double>(all), 0) + " %";
}

bool exceeds(std::size_t part, std::size_t all, double share) {
  return all >= kMinFrames && static_cast<double>(part) > share * static_cast<double>(all);
}

}  // namespace

void SurfaceAgreement::add(const FrameRecord& record) {
  if (!isStable(record.eye.state)) return;
  ++fixated_;
  without_surface_ += !record.eye.surface_distance_m;
  const auto disagrees = vergenceDisagrees(record.eye);
  compared_ += disagrees.has_value();
  disagree_ += disagrees.value_or(false);
  // Eyes may err, but not look apart on average.
  diverge_ += disagrees && record.eye.vergence->value_D < -record.eye.vergence->error_D;
}

std::vector<std::string> SurfaceAgreement::doubts() const {
  std::vector<std::string> doubts;
  if (exceeds(without_surface_, fixated_, kMostWithout)) {
    doubts.push_back("gaze meets no surface in " + percentOf(without_surface_, fixated_) +
                     " of the fixated frames: is the recording where the scene is (scene.scale_m, "
                     "gaze.scene_rotation, gaze.scene_scale, gaze.scene_offset_m)?");
  }
  if (exceeds(diverge_, compared_, kOftenDiverge)) {
    doubts.push_back("the lines of sight of both eyes diverge in " +
                     percentOf(diverge_, compared_) +
                     " of the fixated frames: are the columns of the left and the right eye "
                     "exchanged (gaze.left_direction, gaze.right_direction, gaze.left_angles, "
                     "gaze.right_angles)?");
  } else if (exceeds(disagree_, compared_, kOftenApart)) {
    doubts.push_back("the lines of sight of both eyes do not meet on the surface in " +
                     percentOf(disagree_, compared_) +
                     " of the fixated frames (vergence_disagrees in frames.tsv): is the recording "
                     "where the scene is (scene.scale_m, gaze.scene_offset_m), and are both eyes "
                     "calibrated?");
  }
  return doubts;
}

}  // namespace foci
