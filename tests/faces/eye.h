// One eye of a face: where it looks, what its lids leave open, and what is seen there.
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

  /// Does a point of the lids' shell lie between the lids?
  bool isOpenAt(double x, double y) const;
  /// 0 to 1: how much of lashes lies over a point outside.
  float lashesAt(double x, double y) const;
  /// Light along a ray through the opening.
  /// @param light  of the room's general level
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
  glm::dmat3 head_from_eye_;  // z along the optical axis, out of the eye
  double upwards_deg_;
};

}  // namespace foci::faces
