// A sharp image with depth, from which one with any blur is read in milliseconds: its low-passed
// copies at halved sizes, and for each pixel the mean of the two whose variance is next to its own
// blur's (the reverse-mapped z-buffer of Demers, Depth of Field: A Survey of Techniques, GPU Gems,
// 2004). Known failure: Rokita's; a pixel takes from its neighbours as its own blur says, not
// theirs, so that a blurred thing keeps its sharp outline.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "render/image/frame.h"
#include "render/optics/defocus.h"

namespace foci {

class BlurPyramid {
 public:
  /// @param sharp  with depth
  /// @param focal_px  of its view, along x and y
  void set(Frame sharp, const glm::vec2& focal_px);

  /// The image through a lens. The same bytes at any number of threads.
  /// @param frame  of the image's size; with depth where it has room for it
  void blur(const Defocus& defocus, Frame& frame) const;

 private:
  /// Low-passed copies, from the first, whose index is 1: the size of copy j is 2^-(j / 2) that of
  /// the image, and its sample i lies at pixel 2^(j / 2) i.
  static constexpr int kCopies = 12;
  struct Copy {
    glm::ivec2 size{0};
    std::vector<glm::vec4> rgba;
  };
  class Tile;

  Frame sharp_;
  std::vector<float> point_D_;            // vergence by pixel
  std::array<Copy, kCopies + 1> copies_;  // the first is not used
};

}  // namespace foci
