// The observer's eye itself: what it does to a point of light, to gratings and through focus.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/eye/visual_quality.h"
#include "app/platform/output_guard.h"
#include "app/study/study.h"

namespace foci {

inline constexpr std::size_t kMostDistances = 12, kMostFields = 6;  ///< of a request

struct EyeRequest {
  std::optional<double> focus_D = {};    ///< target; absent: the screen
  std::vector<double> distances_D = {};  ///< of points of light, 1 / m; empty: within 1 D of focus
  std::vector<double> fields_deg = {};   ///< to the right of the line of sight; see `fieldOfEye`
};

/// The image of a point of light.
struct PointImage {
  double vergence_D = 0.0;  ///< of the point; below 0 behind infinity
  double strehl = 0.0;      ///< at 555 nm
  Psf psf;                  ///< at 555 nm
};

/// The eye beside its line of sight.
struct FieldFigures {
  double field_deg = 0.0;
  double aspect = 1.0;      ///< of the pupil, see `FieldOfEye`
  glm::dvec3 power_D{0.0};  ///< M, J0, J45: how much stronger the eye is than on the line of sight
  std::vector<PointImage> points = {};
  std::vector<double> white_mtf = {}, green_mtf = {};
};

/// An eye at one focus.
struct EyeFigures {
  std::string name;  ///< "left eye", "right eye" or "both eyes"
  Pupil pupil;       ///< refraction included
  double focus_D = 0.0;
  std::vector<PointImage> points = {};
  std::vector<double> cycles_per_deg = {}, white_mtf = {}, green_mtf = {};  ///< of a point in focus
  ThroughFocus through = {};
  DepthOfFocus depth = {};
  GratingAcuity acuity = {};
  std::vector<FieldFigures> fields = {};
};

/// One eye, or two where they differ. Progress on standard error.
std::vector<EyeFigures> eyeFiguresOf(const Study& study, const EyeRequest& request);

/// The files that `foci eye` may write into its folder.
std::vector<std::filesystem::path> eyeFiles(const std::filesystem::path& out);

/// Computes the figures and writes the files.
std::vector<EyeFigures> reportEye(const Study& study, const EyeRequest& request,
                                  const std::filesystem::path& out, const OutputGuard& guard);

}  // namespace foci
