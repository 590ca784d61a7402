#include "app/replay/contact_sheet.h"

#include <algorithm>

#include "app/record/gaze_marker.h"

namespace foci {
namespace {

constexpr std::size_t kSheetImages = 12;
constexpr int kSheetWidth_px = 480;

}  // namespace

ContactSheet::ContactSheet(std::size_t frames)
    : frames_(frames), count_(std::min(frames, kSheetImages)) {}

void ContactSheet::offer(std::size_t frame, const FrameRecord& record,
                         const std::vector<glm::dvec2>& points_px, const Image& image) {
  fixating_ = record.eye.state == GazeState::fixation ? fixating_ + 1 : 0;
  const std::size_t stretch = frame * count_ / frames_;
  const bool is_new = stretch >= chosen_.size();
  // Frames of neighbouring stretches, close together, would show the same fixation.
  const bool apart = chosen_.size() < 2 || 2 * (frame - chosen_before_) * count_ >= frames_;
  if (!is_new && (fixating_ <= best_ || !apart)) return;
  if (is_new) chosen_before_ = chosen_at_;
  chosen_at_ = frame;
  if (is_new) chosen_.emplace_back();
  best_ = is_new ? 0 : fixating_;
  chosen_.back() = {record, thumbnail(image, std::min(kSheetWidth_px, image.size_px.x)), points_px};
}

std::vector<SheetImage> ContactSheet::images(const glm::ivec2& image_px) const {
  std::vector<SheetImage> sheet;
  for (const auto& [record, small, points_px] : chosen_) {
    Image image = small;
    const double scale = static_cast<double>(small.size_px.x) / image_px.x;
    for (const glm::dvec2& point_px : points_px) {
      drawMarker(image, scale * point_px, !isFixating(record));
    }
    sheet.push_back({.time_s = record.time_s,
                     .state = record.eye.state,
                     .focus_D = record.eye.focus_D,
                     .surface_distance_m = record.eye.surface_distance_m,
                     .jpeg = jpegOf(image)});
  }
  return sheet;
}

}  // namespace foci
