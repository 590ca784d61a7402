#include "app/session/stereo.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "base/parallel.h"

namespace foci {

std::vector<EyeView> eyeViews(StereoView stereo, const View& middle, double ipd_m,
                              double distance_m) {
  if (stereo == StereoView::mono) return {{.view = middle}};
  glm::ivec2 parts(1, 1);
  if (stereo == StereoView::side_by_side) parts.x = 2;
  if (stereo == StereoView::top_bottom) parts.y = 2;
  std::vector<EyeView> eyes;
  for (const int side : {0, 1}) {
    EyeView eye{.offset_m = (side == 0 ? -0.5 : 0.5) * ipd_m, .view = middle};
    const auto offset_m = static_cast<float>(eye.offset_m);
    eye.view.eye_from_world =
        glm::translate(glm::mat4(1.0f), {-offset_m, 0.0f, 0.0f}) * middle.eye_from_world;
    eye.view.size_px = middle.size_px / parts;
    eye.view.focal_px = middle.focal_px / glm::vec2(parts);
    eye.view.principal_px = middle.principal_px / glm::vec2(parts);
    eye.view.principal_px.x += offset_m * eye.view.focal_px.x / static_cast<float>(distance_m);
    eye.corner_px = side * (parts - 1) * eye.view.size_px;
    eyes.push_back(eye);
  }
  return eyes;
}

void putEye(StereoView stereo, const EyeView& eye, const Frame& frame, Frame& image) {
  const auto width = static_cast<std::size_t>(frame.size_px.x);
  const auto image_width = static_cast<std::size_t>(image.size_px.x);
  parallelFor(static_cast<std::size_t>(frame.size_px.y), [&](std::size_t y) {
    const auto from = frame.rgba.begin() + static_cast<std::ptrdiff_t>(y * width);
    const auto to =
        image.rgba.begin() + static_cast<std::ptrdiff_t>((y + eye.corner_px.y) * image_width +
                                                         static_cast<std::size_t>(eye.corner_px.x));
    // The left eye of an anaglyph comes first, with all colours. The right eye then replaces green
    // and blue.
    if (stereo != StereoView::anaglyph || eye.offset_m < 0.0) {
      std::copy_n(from, width, to);
    } else {
      std::transform(from, from + static_cast<std::ptrdiff_t>(width), to, to,
                     [](const glm::vec4& right, const glm::vec4& left) {
                       return glm::vec4(left.r, right.g, right.b, std::max(left.a, right.a));
                     });
    }
  });
}

glm::dvec2 projectForEye(const EyeView& eye, const glm::dvec3& p_middle) {
  const glm::vec3 p_eye(p_middle - glm::dvec3(eye.offset_m, 0.0, 0.0));
  return glm::dvec2(project(eye.view, p_eye)) + glm::dvec2(eye.corner_px);
}

}  // namespace foci
