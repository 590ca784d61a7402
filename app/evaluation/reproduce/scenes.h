// What the paper's Table 1 and Figure 6 show: the textured plane and the lion, from where, in focus
// where, through which apertures.
#pragma once

#include <array>
#include <cstddef>
#include <functional>

#include "app/evaluation/scene_in_view.h"

namespace foci {

inline constexpr std::size_t kApertures = 3;  // none, a small one, a large one

/// A row of the paper's Table 1 (512 x 512, c = 2.5, Pentium 4 at 1.4 GHz).
struct PaperRow {
  std::size_t aperture;     ///< 0, 1, 2
  const char* aperture_as;  ///< in the paper's own units
  bool lod;
  double kfragments, points, seconds;
};

struct ReproduceScene : SceneInView {
  std::array<double, kApertures> apertures_m{};  ///< diameters; the first is 0
  std::array<PaperRow, 5> paper;
  double paper_reference_s;  ///< what its 200 views took

  RenderSettings settingsAt(std::size_t aperture) const {
    return settingsThrough(apertures_m[aperture]);
  }
  double largestBlur_px(std::size_t aperture) const {
    return largestBlurThrough_px(apertures_m[aperture]);
  }
};

/// The paper's plane, with its apertures, so tilted and so far that method `paper` draws about as
/// many fragments as the paper counted. `samples`: surfels a side.
ReproduceScene planeScene(int samples = 512);

/// The lion as a procedural statue, without apertures yet.
ReproduceScene statueScene();

/// The lion as a scan: of what is in the middle of the view the focus is, apertures are missing
/// yet.
/// @throws InputError for what cannot be read, or where fewer than a thousand points are in view
ReproduceScene scanScene(const ScanView& scan);

/// Gives the scene the apertures at which method `paper` draws as many fragments, over those
/// without blur, as the paper counted on its lion. Fragments grow with the square of the aperture
/// where blur dominates: a few steps of the secant in that.
/// @param on_frame  after every frame drawn
/// @throws InputError where no aperture does
void chooseApertures(ReproduceScene& scene, const std::function<void()>& on_frame);

}  // namespace foci
