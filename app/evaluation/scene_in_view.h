// The scenes that the program measures its methods on: what is seen from where, what is in focus.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "render/methods/method.h"
#include "render/optics/view.h"
#include "render/scene/builtin/procedural.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// A scene as a camera sees it. Blur grows with the aperture, linearly.
struct SceneInView {
  std::string name;
  SurfelCloud cloud;
  View view;
  RenderSettings settings;  ///< all but the aperture

  Defocus defocusThrough(double aperture_m) const;
  RenderSettings settingsThrough(double aperture_m) const;

  /// Along the axis, of the surfels whose centres are on the image.
  std::vector<float> depthsInView_m() const;

  /// The largest circle of confusion of a surfel whose centre is on the image, px.
  double largestBlurThrough_px(double aperture_m) const;
};

struct ScanView {
  std::filesystem::path file;
  EyePose pose;
};

/// The paper's plane, tilted, so far that method `paper` renders about as many fragments as the
/// paper counted; its middle is in focus. `samples`: surfels a side; `size_px`: of the square
/// image.
SceneInView planeInView(int samples, int size_px);

/// The procedural lion, what is in the middle in focus.
SceneInView statueInView(int size_px);

/// A lion of one's own, likewise.
/// @throws InputError for what cannot be read, or where fewer than a thousand points are in view
SceneInView scanInView(const ScanView& scan, int size_px);

/// The gallery from its eye, focus on the knot; things from 0.25 to 6 m. @param width_px  16 : 9
SceneInView galleryInView(int width_px);

/// The paper's Figure 1: the gallery's half-transparent mask before its bust, which is in focus.
SceneInView maskInView(int size_px);

/// Whence it is seen: past the foreground.
View maskView(int size_px);

/// The fence, the wall behind it in focus.
SceneInView fenceInView(int size_px);

/// Depth along the axis of one of `galleryPointsOfInterest()`.
double galleryDepth_m(const View& view, const std::string& place);

}  // namespace foci
