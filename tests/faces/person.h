// The properties that differ from face to face.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace foci::faces {

/// Colours are linear RGB. Lengths are those of adults (Hall et al. 1985; Dodgson 2004).
struct Person {
  glm::vec3 skin{0.50f, 0.30f, 0.21f};
  glm::vec3 iris{0.09f, 0.05f, 0.03f};
  glm::vec3 hair{0.05f, 0.035f, 0.025f};
  double ipd_mm = 63.0;
  double nose_mm = 22.0;  ///< how far the nose stands out
  double face_width_mm = 150.0;
  double pupil_mm = 4.0;           ///< diameter
  glm::dvec2 kappa_deg{5.0, 1.5};  ///< from the eye's axis to the line of sight: nasal, upwards
  double lids = 1.0;               ///< opening of the lids, over the usual one
  double lashes = 0.0;             ///< how much the lashes hang over the eye, 0 to 1
  double shade = 0.0;              ///< of the white under the lid and in the corners, 0 to 1
  bool made_up = false;            ///< dark lines and shadows around the eyes
  bool glasses = false;
  float mirrored = 0.06f;  ///< reflectance of both faces of a lens, here partly coated
  bool beard = false;
  std::uint32_t seed = 1;  ///< of the texture of skin, brows and irises
};

/// A person with one of six skins and five irises. The same index always gives the same person.
Person somebody(std::uint32_t index);

/// White noise from integers, 0 to 1. The same on every machine.
float noiseAt(std::uint32_t x, std::uint32_t y, std::uint32_t seed);

/// Smooth noise of unit scale, 0 to 1.
float smoothNoise(float x, float y, std::uint32_t seed);

}  // namespace foci::faces
