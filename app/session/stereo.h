// One image of what both eyes see: side by side, one above the other, or red and cyan.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "render/image/frame.h"
#include "render/optics/view.h"

namespace foci {

/// How an image shows the views of the eyes.
///   mono          one eye, in the middle between both
///   side_by_side  left eye in the left half, right eye in the right half, each squeezed to half of
///                 the width, as stereo displays expect
///   top_bottom    left eye above, right eye below, squeezed likewise
///   anaglyph      red from the left eye, green and blue from the right
enum class StereoView { mono, side_by_side, top_bottom, anaglyph };

struct EyeView {
  double offset_m = 0.0;  ///< of the eye from the middle between both, to the right
  View view;
  glm::ivec2 corner_px{0, 0};  ///< of the view in the image
  bool operator==(const EyeView&) const = default;
};

/// The views of an image: one from the middle between both eyes, or left and right. All look
/// through the same screen, so what lies on the screen has no disparity. An eye `e` to the right
/// sees a point (X, Y) of the screen at X - e. Its principal point is where it faces the screen,
/// e focal_px / d to the right.
/// @param middle      from the middle between both eyes, as large as the image;
///   even numbers of px where it is halved
/// @param ipd_m       interpupillary distance
/// @param distance_m  to the screen
std::vector<EyeView> eyeViews(StereoView stereo, const View& middle, double ipd_m,
                              double distance_m);

/// Copies the frame of one eye to its place in `image`, which has its size and no depth. Not for
/// mono, where the frame is the image.
void putEye(StereoView stereo, const EyeView& eye, const Frame& frame, Frame& image);

/// Where `eye` has a point in the image.
/// @param p_middle  in the frame of an eye in the middle between both
glm::dvec2 projectForEye(const EyeView& eye, const glm::dvec3& p_middle);

}  // namespace foci
