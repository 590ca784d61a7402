// The sharp images of the views at which an eye rested last, and how method `auto` blurs them in
// milliseconds, for any focus and pupil: by the reverse-mapped z-buffer of Demers, Depth of Field:
// A Survey of Techniques, GPU Gems, 2004. Known failure, as in `rokita`: a pixel gathers light by
// its own blur, not by the blur of its neighbours. So a blurred surface keeps a sharp outline.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "render/image/frame.h"
#include "render/methods/method.h"
#include "render/optics/defocus.h"
#include "render/optics/view.h"

namespace foci {

/// Holds low-passed copies of a sharp image at halved sizes. Each pixel interpolates the two copies
/// whose variances are next to the mean variance of the pixel's own blur.
class BlurPyramid {
 public:
  /// @param sharp  the sharp image of the view, with depth
  void set(Frame sharp, const View& view);

  /// Blurs the image by a lens. The result has the same bytes at any number of threads.
  /// @param frame  has the image's size; receives depth where it has room for depth
  void blur(const Defocus& defocus, Frame& frame) const;

 private:
  /// Low-passed copies 1 to kCopies. Copy j is 2^(j / 2) times smaller than the image (integer
  /// division), and its sample i lies at pixel 2^(j / 2) i. Copy 12 has the variance of a blur
  /// radius of 90 px; larger radii get this blur.
  static constexpr int kCopies = 12;
  struct Copy {
    glm::ivec2 size{0};
    std::vector<glm::vec4> rgba;
  };
  class Tile;

  Frame sharp_;
  glm::vec2 principal_px_{0.0f};          // of the view
  std::vector<float> point_D_;            // vergence by pixel
  std::array<Copy, kCopies + 1> copies_;  // copies_[0] is not used
};

/// Everything that a sharp image of a scene depends on.
struct UnblurredView {
  View view;
  Lighting lighting = {};
  DistanceAlong along = DistanceAlong::sight;
  bool operator==(const UnblurredView&) const = default;
};

inline UnblurredView unblurred(const View& view, const RenderSettings& settings) {
  return {view, settings.lighting, settings.defocus.along};
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
