#include "app/session/stereo.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "base/parallel.h"

namespace foci {
namespace {

glm::mat4 shifted(const glm::mat4& middle_from_world, const glm::dvec3& offset_m) {
  return glm::translate(glm::mat4(1.0f), -glm::vec3(offset_m)) * middle_from_world;
}

/// 0: the left eye, 1: the right one.
std::vector<int> sidesIn(StereoView stereo) {
  if (stereo == StereoView::left) return {0};
  if (stereo == StereoView::right) return {1};
  return {0, 1};
}

}  // namespace

glm::ivec2 viewsAcross(StereoView stereo) {
  if (stereo == StereoView::side_by_side) return {2, 1};
  if (stereo == StereoView::top_bottom) return {1, 2};
  return {1, 1};
}

std::vector<EyeView> eyeViews(StereoView stereo, const View& middle, double ipd_m,
                              double distance_m) {
  if (stereo == StereoView::mono) return {{.view = middle}};
  const glm::ivec2 parts = viewsAcross(stereo);
  std::vector<EyeView> eyes;
  for (const int side : sidesIn(stereo)) {
    EyeView eye{.offset_m = {(side == 0 ? -0.5 : 0.5) * ipd_m, 0.0, 0.0}, .view = middle};
    const auto offset_m = static_cast<float>(eye.offset_m.x);
    eye.view.eye_from_world = shifted(middle.eye_from_world, eye.offset_m);
    eye.view.size_px = middle.size_px / parts;
    eye.view.focal_px = middle.focal_px / glm::vec2(parts);
    eye.view.principal_px = middle.principal_px / glm::vec2(parts);
    eye.view.principal_px.x += offset_m * eye.view.focal_px.x / static_cast<float>(distance_m);
    eye.corner_px = side * (parts - 1) * eye.view.size_px;
    eyes.push_back(eye);
  }
  return eyes;
}

std::vector<EyeView> headsetViews(StereoView stereo, const glm::mat4& head_from_world,
                                  const HeadsetEyes& displays, const glm::ivec2& size_px) {
  const glm::ivec2 parts = viewsAcross(stereo);
  const auto tangent = [](double deg) { return std::tan(glm::radians(deg)); };
  std::vector<EyeView> eyes;
  for (const int side : sidesIn(stereo)) {
    const HeadsetEye& display = displays.at(static_cast<std::size_t>(side));
    const EyeField field =
        stereo == StereoView::anaglyph ? fieldOfBothEyes(displays) : display.field;
    const glm::dvec2 before(tangent(field.left_deg), tangent(field.up_deg));
    const glm::dvec2 behind(tangent(field.right_deg), tangent(field.down_deg));
    EyeView eye{
        .offset_m = display.position_m, .middle_from_eye = display.head_from_eye, .view = {}};
    const glm::mat4 eye_from_middle(glm::mat3_cast(glm::conjugate(display.head_from_eye)));
    eye.view.eye_from_world = eye_from_middle * shifted(head_from_world, eye.offset_m);
    eye.view.size_px = size_px / parts;
    const glm::dvec2 focal_px = glm::dvec2(eye.view.size_px) / (before + behind);
    eye.view.focal_px = glm::vec2(focal_px);
    eye.view.principal_px = glm::vec2(before * focal_px);
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
    if (stereo != StereoView::anaglyph || eye.isLeft()) {
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
  return glm::dvec2(project(eye.view, glm::vec3(eye.inEye(p_middle)))) + glm::dvec2(eye.corner_px);
}

}  // namespace foci
