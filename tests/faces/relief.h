// A face as a relief: height, colour and occlusion on a grid.
//
// The head frame is in millimetres. Its origin is midway between the centres of the eyeballs. Seen
// from the front, x points to the image's right, y down and z into the head.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "tests/faces/person.h"

namespace foci::faces {

class Relief {
 public:
  explicit Relief(const Person& person);

  /// The point where a ray from outside first meets the skin. Head frame, mm.
  std::optional<glm::dvec3> meet(const glm::dvec3& origin, const glm::dvec3& direction) const;

  /// Linear RGB of the lit skin.
  /// @param towards_light  unit, head frame
  glm::vec3 colourAt(double x, double y, const glm::vec3& towards_light, float ambient) const;

  /// Height towards the viewer, mm; nothing beside the face.
  std::optional<float> heightAt(double x, double y) const;

 private:
  cv::Mat1f height_;
  cv::Mat1f ceiling_;  // maximum height around a point
  cv::Mat3f albedo_, normal_;
  cv::Mat1f open_;  // share of the ambient light that arrives
};

/// Radius of the eyelids' shell around the eyeball's centre, mm.
inline constexpr double kLids_mm = 13.2;

}  // namespace foci::faces
