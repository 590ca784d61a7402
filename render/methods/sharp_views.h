// The sharp images of the views at which an eye rested last, which method `auto` can blur in
// milliseconds.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "render/methods/blur_pyramid.h"
#include "render/methods/method.h"

namespace foci {

/// Everything that a sharp image of a scene depends on.
struct UnblurredView {
  View view;
  glm::vec3 background{0.0f};
  float shading = 0.0f;
  DistanceAlong along = DistanceAlong::sight;
  bool operator==(const UnblurredView&) const = default;
};

inline UnblurredView unblurred(const View& view, const RenderSettings& settings) {
  return {view, settings.background, settings.shading, settings.defocus.along};
}

/// A sharp image, ready to be blurred, and the cost of rendering it.
struct SharpView {
  UnblurredView view;
  BlurPyramid pyramid;
  RenderStats stats;
};

/// The newest sharp images. A method shares them with its clones: one renders an image, and another
/// uses it at the same time.
class SharpViews {
 public:
  /// Null where the image is not there.
  std::shared_ptr<const SharpView> find(const UnblurredView& view) const {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::ranges::find_if(views_, [&](const auto& each) { return each->view == view; });
    return found == views_.end() ? nullptr : *found;
  }

  /// Replaces the oldest image where there is no room.
  void add(std::shared_ptr<const SharpView> view) {
    constexpr std::size_t kMax = 2;  // one for each eye
    const std::lock_guard lock(mutex_);
    if (views_.size() == kMax) views_.erase(views_.begin());
    views_.push_back(std::move(view));
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<const SharpView>> views_;  // from the oldest on
};

}  // namespace foci
