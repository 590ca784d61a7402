// Blurs a sharp image with depth in milliseconds, for any focus and pupil: the reverse-mapped
// z-buffer of Demers, Depth of Field: A Survey of Techniques, GPU Gems, 2004. It holds low-passed
// copies at halved sizes. Each pixel interpolates the two copies whose variances are next to the
// variance of the pixel's own blur. Known failure, as in `rokita`: a pixel gathers light by its own
// blur, not by the blur of its neighbours. So a blurred surface keeps a sharp outline.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "render/image/frame.h"
#include "render/optics/defocus.h"

namespace foci {

class BlurPyramid {
 public:
  /// @param sharp  the sharp image, with depth
  /// @param focal_px  focal length of its view, along x and y
  void set(Frame sharp, const glm::vec2& focal_px);

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
  std::vector<float> point_D_;            // vergence by pixel
  std::array<Copy, kCopies + 1> copies_;  // copies_[0] is not used
};

}  // namespace foci
