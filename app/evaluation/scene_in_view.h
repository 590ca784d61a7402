// The scenes that foci measures its methods on, each with its view and its focus.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "render/methods/method.h"
#include "render/optics/view.h"
#include "render/scene/builtin/procedural.h"
#include "render/scene/mesh/triangle_mesh.h"
#include "render/scene/scene.h"

namespace foci {

/// A scene as a camera sees it. Blur is proportional to the aperture.
struct SceneInView {
  std::string name;
  Scene scene;
  View view;
  RenderSettings settings;                 ///< everything but the aperture
  std::vector<std::string> warnings = {};  ///< of reading a scan, printed already

  Defocus defocusThrough(double aperture_m) const;
  RenderSettings settingsThrough(double aperture_m) const;

  /// Distances along the axis, of the surfels whose centres lie on the image.
  std::vector<float> depthsInView_m() const;

  /// The largest blur radius of a surfel whose centre lies on the image, px.
  double largestBlurThrough_px(double aperture_m) const;
};

struct ScanView {
  std::filesystem::path file;
  EyePose pose;
};

/// SHA-256 of a scan, and its pose: everything that results on the scan depend on.
/// @throws InputError if the file cannot be read
std::string scanKey(const ScanView& scan);

/// The plane of the 2003 paper. Tilt and distance are such that method `paper` renders about as
/// many fragments as the paper counted. The middle of the plane is in focus.
/// @param samples  surfels along a side
/// @param size_px  side of the square image
SceneInView planeInView(int samples, int size_px);

/// The procedural lion. The surface in the middle of the image is in focus.
SceneInView statueInView(int size_px);

/// A scan. The surface in the middle of the image is in focus.
/// @throws InputError if the file cannot be read, or if fewer than a thousand points are in view
SceneInView scanInView(const ScanView& scan, int size_px);

/// The same. @throws InputError for a scene of Gaussians, too
SceneInView surfacesInView(const ScanView& scan, int size_px);

/// Whether a scene file holds Gaussians. @throws InputError
bool holdsGaussians(const std::filesystem::path& file);

/// Distance of the gallery's surfels in a chart (`makeGallery`).
inline constexpr float kGalleryStep_px = 1.8f;

/// The gallery from its own eye pose, with things from 0.25 to 6 m and the knot in focus.
/// @param width_px  of an image of 16 : 9
SceneInView galleryInView(int width_px, float step_px = kGalleryStep_px);

/// Figure 1 of the 2003 paper: a half-transparent mask before a bust. The bust is in focus.
SceneInView maskInView(int size_px, float step_px = kGalleryStep_px);

/// The view of `maskInView`: past the foreground of the gallery.
View maskView(int size_px);

/// A fence before a wall. The wall is in focus.
SceneInView fenceInView(int size_px);

/// The garden of Gaussians. The blades are in focus.
/// @param width_px  of an image of 16 : 9
SceneInView gardenInView(int width_px);

/// A lumpy ball of about `radius_m` around the origin, closed, with a texture of checks over a
/// gradient. Every run makes the same bytes.
TriangleMesh makeBallMesh(float radius_m);

/// The ball sampled as any mesh is, before a light background. Its nearest point is in focus.
/// `SurfelCloud::mesh` holds its triangles.
/// @param size_px  side of the square image
SceneInView ballInView(int size_px);

/// Distance along the axis of one of `galleryPointsOfInterest()`.
/// @param place  its name (asserted)
double galleryDepth_m(const View& view, const std::string& place);

}  // namespace foci
