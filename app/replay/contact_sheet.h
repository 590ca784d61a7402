// The contact sheet of a replay's report, chosen while frames go by.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "app/graphics/image.h"
#include "app/session/frame_record.h"

namespace foci {

struct SheetImage {
  double time_s = 0.0;
  GazeState state = GazeState::lost;
  double focus_D = 0.0;
  std::optional<double> surface_distance_m;
  std::string jpeg;
};

/// Divides the replay into equal stretches and takes a frame of each: the one at which a fixation
/// has lasted longest, so that the focus has settled. A stretch without fixation gives its first
/// frame.
class ContactSheet {
 public:
  explicit ContactSheet(std::size_t frames);

  /// @param points_px  of the gaze, one for each view in the image
  /// @param image      without marker
  void offer(std::size_t frame, const FrameRecord& record, const std::vector<glm::dvec2>& points_px,
             const Image& image);

  /// @param image_px  size of the offered images
  std::vector<SheetImage> images(const glm::ivec2& image_px) const;

 private:
  struct Chosen {
    FrameRecord record;
    Image small;
    std::vector<glm::dvec2> points_px;  // of gaze, in the image at full size
  };
  std::size_t frames_, count_;
  std::size_t fixating_ = 0, best_ = 0;  // frames that a fixation lasts: now, at the chosen frame
  std::size_t chosen_at_ = 0,
              chosen_before_ = 0;  // last chosen frame, and that of the stretch before
  std::vector<Chosen> chosen_;
};

}  // namespace foci
