// The scenes of Table 1 and Figure 6 of the 2003 paper: the textured plane and the lion, each with
// its view, its focus and its apertures.
#pragma once

#include <array>
#include <cstddef>
#include <functional>

#include "app/evaluation/scene_in_view.h"

namespace foci {

inline constexpr std::size_t kApertures = 3;  // a pinhole, a small aperture, a large one

/// A row of the paper's Table 1 (512 x 512, c = 2.5, Pentium 4 at 1.4 GHz).
struct PaperRow {
  std::size_t aperture;     ///< 0, 1, 2
  const char* aperture_as;  ///< in the paper's units
  bool lod;
  double kfragments, points, seconds;
};

struct ReproduceScene : SceneInView {
  std::array<double, kApertures> apertures_m{};  ///< diameters; the first is 0
  std::array<PaperRow, 5> paper;
  double paper_reference_s;  ///< time of the paper's 200 views

  RenderSettings settingsAt(std::size_t aperture) const {
    return settingsThrough(apertures_m[aperture]);
  }
  double largestBlur_px(std::size_t aperture) const {
    return largestBlurThrough_px(apertures_m[aperture]);
  }
};

/// The paper's plane with its apertures: see `planeInView`. @param samples  surfels along a side
ReproduceScene planeScene(int samples = 512);

/// The procedural lion, without apertures.
ReproduceScene statueScene();

/// A scan in place of the lion, without apertures.
/// @throws InputError as `scanInView`
ReproduceScene scanScene(const ScanView& scan);

/// Chooses the scene's apertures: with them, fragments of method `paper` grow as the paper's
/// fragments do on its lion. Where blur dominates, fragments are proportional to the square of the
/// aperture; a secant search in the square takes a few steps.
/// @param on_frame  called after every rendered frame
/// @throws InputError if no aperture reaches the paper's growth
void chooseApertures(ReproduceScene& scene, const std::function<void()>& on_frame);

}  // namespace foci
