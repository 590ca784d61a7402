// One image of what both eyes see: side by side, one above the other, or red and cyan.
#pragma once

#include <glm/glm.hpp>
#include <string_view>
#include <vector>

#include "render/image/frame.h"
#include "render/optics/view.h"

namespace foci {

/// How the views are put together.
///   side-by-side  the left eye's in the left half, the right eye's in the right, each squeezed to
///                 half of the width, as displays for it take them
///   top-bottom    the left eye's above, the right eye's below, squeezed likewise
///   anaglyph      red from the left eye, green and blue from the right
enum class StereoView { mono, side_by_side, top_bottom, anaglyph };

/// "mono", "side-by-side", "top-bottom", "anaglyph" (asserted).
StereoView stereoViewNamed(std::string_view name);

struct EyeView {
  double offset_m = 0.0;  ///< from between the eyes, to the right
  View view;
  glm::ivec2 corner_px{0, 0};  ///< of its image in the whole
  bool operator==(const EyeView&) const = default;
};

/// The views of one eye between both, or of left and right. All see the same screen, so what lies
/// on it has no disparity: an eye `e` to the right sees a point (X, Y) of the screen at X - e, and
/// its principal point is where it faces the screen, e focal_px / d to the right.
/// @param middle      through the whole screen, from between the eyes, as large as the image;
///   even numbers of px where it is halved
/// @param distance_m  to the screen
std::vector<EyeView> eyeViews(StereoView stereo, const View& middle, double between_m,
                              double distance_m);

/// Puts one eye's frame into `whole`, which has its size and no depth. Mono is the frame itself.
void putEye(StereoView stereo, const EyeView& eye, const Frame& frame, Frame& whole);

/// Image point of `p_eye`, given in the frame of the eye in the middle, in the whole image.
glm::dvec2 projectForEye(const EyeView& eye, const glm::dvec3& p_middle);

}  // namespace foci
