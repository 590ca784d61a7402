// How closely the surfels of a mesh show its triangles, seen from all sides.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/graphics/video_writer.h"
#include "render/optics/view.h"
#include "render/scene/mesh/triangle_mesh.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

struct Frame;
struct TriangleView;

/// A surfel cloud leaks at a pixel where its coverage is below 1 by more than this, though the
/// triangles are opaque all around: a twentieth of the light behind shows.
inline constexpr float kLeak = 0.05f;

/// Directions from which a mesh is seen.
inline constexpr std::size_t kFidelityViews = 64;

/// Width of the mesh's bounding sphere in the views: as on a screen of 1080 rows that the scene
/// fills by 80 %, which is how foci frames a scene (app/study/framing.h).
inline constexpr int kObject_px = 864;

/// Side of the part of a view that is measured. It limits the time.
inline constexpr int kFidelity_px = 288;

/// Differences between the image of the surfels (method `pinhole`, as every method shows them in
/// focus) and the image of the triangles.
///
/// The interior are the pixels around which all rays of 7 x 7 pixels end on opaque triangles. So
/// transparent surfaces and outlines do not count there. A hole through which another part of the
/// object shows is no leak, but an error of the colour.
struct Fidelity {
  std::size_t interior = 0;   ///< pixels
  std::size_t leaking = 0;    ///< pixels of the interior that leak more than `kLeak`
  float largest_leak = 0.0f;  ///< largest 1 - coverage in the interior
  /// Over the interior: mean, and 99 % quantile, of the difference in code values (0 to 255) of an
  /// sRGB display, the mean of R, G and B. The surfels are before black or before white, whichever
  /// is worse at the pixel. Absent without interior.
  std::optional<double> color_mean = {}, color_99 = {};
  /// Sum of |coverage - coverage of the triangles| around the outlines, over the outlines' length
  /// (`outlineLength_px`): the mean distance of the two outlines, px. Absent without an outline.
  std::optional<double> outline_px = {};
  /// The same without taking absolute values: how much farther out the surfels reach.
  std::optional<double> outline_shift_px = {};

  double leakShare() const {
    return interior == 0 ? 0.0 : static_cast<double>(leaking) / static_cast<double>(interior);
  }
};

/// @param surfels  before black. Their coverage gives the image before white, which differs by
///                 (1 - coverage) white.
Fidelity fidelityOf(const TriangleView& truth, const Frame& surfels);

/// One of the views, and a small picture of it.
struct FidelityView {
  glm::vec3 towards{0.0f};  ///< unit vector from the middle of the object to the eye
  Fidelity figures = {};
  Image tile = {};  ///< see `leakColor`
};

struct FidelityReport {
  Fidelity all = {};  ///< over the pixels of all views
  std::vector<FidelityView> views = {};
  double pixel_m = 0.0;            ///< width of a pixel at the middle of the object
  double spacing_m = 0.0;          ///< of the surfels
  double transparent_share = 0.0;  ///< of the pixels inside silhouettes
  double seconds = 0.0;
  std::size_t worst = 0;  ///< number of the view that the pictures show
  Image triangles = {}, surfels = {}, difference = {};  ///< of that view, before white

  double pixelSpacings() const { return pixel_m / spacing_m; }
};

/// Directions spread evenly over the sphere: the Fibonacci lattice (Swinbank and Purser 2006), from
/// top to bottom. Unit vectors.
std::vector<glm::vec3> directionsOverSphere(std::size_t count);

struct BoundingSphere {
  glm::vec3 middle_m{0.0f};
  double radius_m = 0.0;
};

/// The sphere around the middle of the bounding box.
BoundingSphere boundingSphereOf(const TriangleMesh& mesh);

/// Centres of triangles, spread evenly over the area: where windows lie.
/// @param mesh  not empty (asserted)
std::vector<glm::vec3> pointsOverSurface(const TriangleMesh& mesh, std::size_t count);

/// View with the eye `towards` a direction from the middle of the mesh. The eye is 5 radii of the
/// bounding sphere away, outside of the mesh: it sees rooms from outside, and open surfaces from
/// both sides. The image is the window of `kFidelity_px` around `target_m`, within the whole view.
View viewFromOutside(const BoundingSphere& sphere, const glm::vec3& towards,
                     const glm::vec3& target_m);

/// Compares the surfels with the triangles from `kFidelityViews` directions.
/// @param spacing_m  of the surfels
/// @return nullopt if foci was built without ray tracing (FOCI_RAYTRACE)
std::optional<FidelityReport> measureFidelity(const SurfelCloud& cloud, const TriangleMesh& mesh,
                                              double spacing_m, std::size_t views = kFidelityViews);

/// Colour of a leak in the tiles, sRGB: "inferno" from `kLeak` (dark) to `kWorstLeak` (bright).
std::array<std::uint8_t, 3> leakColor(float leak);

/// The goal for every surface: at most this share of the interior leaks, and no pixel more than
/// this.
inline constexpr double kMaxLeakShare = 1e-4;
inline constexpr float kWorstLeak = 0.15f;

/// A 99 % quantile of the colour error from which `fidelityWarnings` speaks: a tenth of the range
/// of code values, chosen by eye.
inline constexpr double kMaxColor99 = 26.0;

/// One sentence for each goal that is missed, with its figure and the `--points` to set.
///
/// Leaks: more than `kMaxLeakShare` or `kWorstLeak`. Colours: more than `kMaxColor99`, where the
/// surfels are fewer than the mesh's detail asks for. foci suggests
///   - `defaultPoints`, if there are fewer than half: a surfel for each texel or vertex that a
///     screen of `kScreenRows` rows can show;
///   - else four times as many, which halves the spacing;
///   - no number where a pixel is two spacings wide: the pixel filter then hides the surfels.
/// @param surfels  their number
std::vector<std::string> fidelityWarnings(const FidelityReport& report, std::size_t surfels,
                                          const TriangleMesh& mesh);

}  // namespace foci
