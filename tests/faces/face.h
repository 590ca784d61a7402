// Photographs of faces with exact truth, by ray casting. The eyeballs have a cornea and glints and
// lie behind eyelids. The head turns and moves, in a room with a window, a lamp and a screen.
//
// The camera frame is in metres: x to the image's right, y down, z away from the camera. The head
// frame is that of relief.h, in millimetres. At rest it is parallel to the camera's.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <span>

#include "tests/faces/person.h"
#include "tests/faces/relief.h"

namespace foci::faces {

/// Radii of eyeball, cornea and limbus, mm (Gullstrand; Hall et al. 1985).
inline constexpr double kEyeball_mm = 12.0, kCornea_mm = 7.8, kLimbus_mm = 5.9;
inline constexpr double kCorneaIndex = 1.336;

/// A person at a moment.
struct Moment {
  glm::dvec3 head_m{0.0, 0.0, 0.6};  ///< origin of the head frame
  double yaw_rad = 0.0;              ///< to the observer's right, the image's left
  double pitch_rad = 0.0;            ///< upwards
  double roll_rad = 0.0;             ///< towards the observer's right shoulder
  glm::dvec3 looks_at_m{0.0};        ///< target of both eyes, camera frame
  double closed = 0.0;               ///< 0: open, 1: shut
};

class Face;

struct Photography {
  glm::ivec2 size_px{640, 480};
  double focal_px = 560.0;      ///< the principal point is the image's centre
  double blur_px = 0.6;         ///< standard deviation of the lens' point spread
  double noise = 2.0;           ///< standard deviation at middle grey, of 255
  double exposure = 1.0;        ///< factor on the camera's automatic exposure
  double light_yaw_rad = -0.6;  ///< direction of the main light; 0: from the camera
  double ambient = 0.55;        ///< share of the light that comes from everywhere
  std::uint32_t seed = 1;
  const Face* beside = nullptr;  ///< a second face, behind the first
  Moment beside_at{};
};

/// Index 0 is the observer's left eye, at the image's right. Pixels, pixel centres at +0.5.
struct Truth {
  std::array<glm::dvec2, 2> iris_px{};  ///< centre of the limbus
  std::array<double, 2> iris_radius_px{};
  std::array<glm::dvec2, 2> eye_px{};                ///< centre of the eyeball
  std::array<glm::dvec2, 2> inner_px{}, outer_px{};  ///< corners
  double closed = 0.0;
  double eyeDistance_px() const { return glm::distance(eye_px[0], eye_px[1]); }
};

class Face {
 public:
  explicit Face(const Person& person) : person_(person), relief_(person) {}

  /// One image, BGR, 8 bits. Several moments belong to one exposure, so that motion blurs.
  cv::Mat photograph(std::span<const Moment> moments, const Photography& how) const;
  cv::Mat photograph(const Moment& moment, const Photography& how) const {
    return photograph({&moment, 1}, how);
  }

  Truth truthOf(const Moment& moment, const Photography& how) const;

 private:
  friend struct Scene;
  Person person_;
  Relief relief_;
};

/// Rotates directions from the head frame to the camera frame.
glm::dmat3 cameraFromHead(const Moment& moment);

}  // namespace foci::faces
