// The options of each `foci calibrate` command, and the functions that run them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/input_error.h"

namespace foci {

struct CalibrateScreenOptions {
  bool headless = false, json = false, overwrite = false;
  bool window = false;                   ///< instead of the full screen
  std::string size_px, card_px, size_m;  ///< "WxH"; a card's height is optional
  std::string blind_spot_px;             ///< offsets by commas; outwards > 0, inwards < 0
  std::string gamma = "sRGB";
  std::optional<double> distance_m, face_px, face_reference_px, face_reference_m;
  std::filesystem::path monitor, edid, out, psychopy;
};

struct CalibrateGazeOptions {
  bool json = false, overwrite = false;
  std::filesystem::path pairs, validate, drift, out, report, screen, camera;
  std::string units;  ///< empty: deg
  std::string model = "auto";
  std::string source = "mouse";
  int targets = 9;
  unsigned seed = 1;
  bool window = false;  ///< instead of the full screen
  bool manual = false;  ///< each target waits for the space key
};

struct CalibrateBinocularOptions {
  bool json = false, overwrite = false;
  std::filesystem::path pairs, validate, out;
};

struct CalibrateCameraOptions {
  bool json = false, overwrite = false;
  bool window = false;  ///< show the video; a device is always shown
  std::vector<std::string> images;
  std::filesystem::path video, out;
  std::optional<int> device;
  std::string board = "9x6", charuco;
  double square_mm = 25.0, marker_mm = 18.0;
};

void calibrateScreen(const CalibrateScreenOptions& options);
void calibrateGaze(const CalibrateGazeOptions& options);
void calibrateBinocular(const CalibrateBinocularOptions& options);
void calibrateCamera(const CalibrateCameraOptions& options);

/// @param file     of `others`
/// @param hasGaze  of a sample; others are passed over
/// @throws InputError where each of the first 1000 of `others` is one of `fit`
template <class Sample, class HasGaze>
void refuseOwnSamples(const std::filesystem::path& file, const std::vector<Sample>& fit,
                      const std::vector<Sample>& others, const HasGaze& hasGaze) {
  constexpr std::size_t kTested = 1000;
  std::size_t tested = 0;
  for (const Sample& sample : others) {
    if (tested == kTested) break;
    if (!hasGaze(sample)) continue;
    if (std::ranges::find(fit, sample) == fit.end()) return;
    ++tested;
  }
  if (tested == 0) return;
  throw InputError("--validate " + file.string(),
                   "the samples of the fit: expected others, or leave --validate out");
}

}  // namespace foci
