// One image of what both eyes see: side by side, one above the other, or red and cyan.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "gaze/geometry/gaze_sample.h"
#include "render/image/frame.h"
#include "render/optics/view.h"

namespace foci {

/// How an image shows the views of the eyes.
///   mono          one eye, in the middle between both
///   side_by_side  left eye in the left half, right eye in the right half, each squeezed to half of
///                 the width, as stereo displays expect
///   top_bottom    left eye above, right eye below, squeezed likewise
///   anaglyph      red from the left eye, green and blue from the right
///   left, right   one eye where it is
/// A headset's views are not squeezed: the image has room for both.
enum class StereoView { mono, side_by_side, top_bottom, anaglyph, left, right };

/// How many views an image has beside each other, and one above the other.
glm::ivec2 viewsAcross(StereoView stereo);

struct EyeView {
  glm::dvec3 offset_m{0.0};  ///< of the eye from the middle between both; x right, y up
  glm::dquat middle_from_eye{1.0, 0.0, 0.0, 0.0};  ///< a headset's displays may be canted
  View view;
  glm::ivec2 corner_px{0, 0};  ///< of the view in the image
  bool operator==(const EyeView&) const = default;

  bool isLeft() const { return offset_m.x < 0.0; }
  /// A point in the frame of the middle, in the eye's own.
  glm::dvec3 inEye(const glm::dvec3& p_middle) const {
    return glm::conjugate(middle_from_eye) * (p_middle - offset_m);
  }
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

/// The views of a headset's image. Each eye looks along the axis of its own display, whose frustum
/// is asymmetric:
///   focal_px = size_px / (tan left + tan right, tan up + tan down)
/// In an anaglyph, which overlays the views, each eye has the field of both.
/// @param head_from_world  the middle between both eyes is the head's origin
/// @param stereo    not mono, which has the view of an eye in the middle
/// @param size_px   of the image
std::vector<EyeView> headsetViews(StereoView stereo, const glm::mat4& head_from_world,
                                  const HeadsetEyes& displays, const glm::ivec2& size_px);

/// Copies the frame of one eye to its place in `image`, which has its size and no depth. Not for
/// an image of one view, where the frame is the image.
void putEye(StereoView stereo, const EyeView& eye, const Frame& frame, Frame& image);

/// Where `eye` has a point in the image.
/// @param p_middle  in the frame of an eye in the middle between both
glm::dvec2 projectForEye(const EyeView& eye, const glm::dvec3& p_middle);

}  // namespace foci
