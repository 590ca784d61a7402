// The observer's eye as Python describes it, and the settings that it makes.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "app/session/session_settings.h"

namespace foci {

/// One eye at one place. Its prescription is not worn: 0 is normal sight, or glasses.
struct StillEye {
  glm::dvec3 position_m{0.0}, look_at_m{0.0, 0.0, -1.0}, up{0.0, 1.0, 0.0};
  double pupil_mm = 4.0;
  std::optional<double> age_years{};
  Prescription prescription{};
  bool chromatic = false;
  Wavefront wavefront{};  ///< empty: no aberrations
  bool stiles_crawford = false, diffraction = false;
};

/// What a picture is made with, besides eye and screen.
struct PictureOptions {
  std::optional<glm::ivec2> size_px;  ///< absent: the screen's
  std::string method;
  glm::dvec3 background;
  double shading, tolerance;
};

EyePath pathOf(const StillEye& eye);

/// @throws InputError
SessionSettings settingsOf(const StillEye& eye, const Screen& screen,
                           const PictureOptions& options);

}  // namespace foci
