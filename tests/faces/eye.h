// One eye of a face: its line of sight, its eyelids, and its appearance between them.
#pragma once

#include <optional>

#include "tests/faces/face.h"

namespace foci::faces {

/// Light from the room, linear RGB, from a direction in the camera frame.
glm::vec3 roomLight(const glm::dvec3& direction_camera);

class Eye {
 public:
  /// @param side  +1: the observer's left, at x > 0; -1: right
  Eye(const Person& person, const Moment& moment, int side);

  const glm::dvec3& centre_mm() const { return centre_; }
  glm::dvec3 irisCentre_mm() const;        ///< of the limbus, head frame
  glm::dvec3 corner_mm(bool inner) const;  ///< head frame

  /// Whether a point on the eyelids' shell lies between the eyelids.
  bool isOpenAt(double x, double y) const;
  /// How much of a point outside the opening is covered by lashes, 0 to 1.
  float lashesAt(double x, double y) const;
  /// How much of a point in the opening lashes cover, 0 to 1.
  float lashesOver(double x, double y) const;
  /// Light along a ray through the opening.
  /// @param ambient  share of the light that comes from everywhere
  glm::vec3 seenAlong(const glm::dvec3& origin, const glm::dvec3& direction,
                      const glm::vec3& towards_light, float ambient) const;

 private:
  struct Lids {
    double upper, lower;
  };
  std::optional<Lids> lidsAt(double x) const;
  glm::vec3 irisAt(double x, double y) const;

  const Person& person_;
  int side_;
  double closed_;
  glm::dvec3 centre_;
  glm::dmat3 camera_from_head_;
  glm::dmat3 head_from_eye_;  // z points along the optical axis, out of the eye
  double upwards_deg_;
};

}  // namespace foci::faces
