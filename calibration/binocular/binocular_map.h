// Calibration of trackers that give eye centres and directions in space: the display's pose in the
// tracker's frame, and kappa, the angle of each eye between its line of sight and the axis that the
// tracker measures. Its file, and recordings mapped by it.
#pragma once

#include <array>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// One moment at one target. Metres, in the tracker's frame; an eye without data is absent.
struct BinocularSample {
  struct Eye {
    glm::dvec3 centre_m{0.0};
    glm::dvec3 direction{0.0, 0.0, 1.0};  ///< of any length above 0
    bool operator==(const Eye&) const = default;
  };
  std::array<std::optional<Eye>, 2> eyes{};  ///< left, right
  glm::dvec2 target_m{0.0};                  ///< on the display, from its centre, x right, y up
  bool operator==(const BinocularSample&) const = default;
};

struct BinocularMap {
  /// p_tracker = rotation p_display + translation; the display is the plane z = 0.
  glm::dmat3 rotation{1.0};
  glm::dvec3 translation_m{0.0};
  /// Added to each eye's yaw and pitch in the tracker's frame. Radians.
  std::array<glm::dvec2, 2> kappa_rad{};
};

/// The line of sight: the measured direction with yaw = atan2(x, z) and pitch = asin(y) moved by
/// kappa. Unit length.
glm::dvec3 correctedDirection(const BinocularMap& map, std::size_t eye,
                              const glm::dvec3& direction);

/// Where the line of sight of an eye meets the display; absent if it leads away from the display.
std::optional<glm::dvec2> pointOnDisplay(const BinocularMap& map, std::size_t eye,
                                         const BinocularSample::Eye& measured);

/// Vergence of the two corrected lines of sight (`vergenceOf`). Dioptres, negative where they
/// diverge; absent with one eye.
std::optional<double> vergence_D(const BinocularMap& map, const BinocularSample& sample);

/// Angle between each corrected line of sight and its target, one for each eye with data.
std::vector<double> errorsOf_deg(const BinocularMap& map, std::span<const BinocularSample> samples);

struct BinocularCalibration {
  BinocularMap map;
  double uncertainty_deg = 0.0;  ///< 68.27 % of one eye's errors are smaller
};

/// The calibration as commented TOML, every digit kept.
std::string binocularToml(const BinocularCalibration& calibration);

/// Whether a file is a binocular calibration. Never throws.
bool isBinocularFile(const std::filesystem::path& file);

/// @throws InputError by file and key
BinocularCalibration readBinocular(const std::filesystem::path& file);

/// The recording with points on `screen`: where each corrected line of sight meets it, and the
/// `Cyclopean` point of both. Eyes' centres and directions come out in the frame of an eye that
/// faces the screen's centre, which vergence needs.
/// @param screen  with resolution, size and distance known
/// @throws InputError where no sample has an eye's centre and direction
GazeTrace mapTrace(const BinocularCalibration& calibration, const Screen& screen, GazeTrace trace);

}  // namespace foci
