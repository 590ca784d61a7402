// The scene of a run as its report shows it: some of its points, the path of the eye, and the
// fixations, in a frame of their own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/replay/gaze_in_scene.h"
#include "render/scene/scene.h"

namespace foci {

/// A line of sight and its end.
struct SightLine {
  glm::dvec3 eye_m, end_m;
  bool met;  ///< a surface, at the end
};

/// In metres; x to the right of the mean line of sight, y up, z towards the observer. The origin is
/// the mean of the points that gaze met.
struct SceneView {
  struct Point {
    glm::vec3 at_m;
    float radius_m;     ///< of a disc, so that discs cover the surface
    glm::u8vec3 color;  ///< sRGB codes
  };
  struct Sight {
    double time_s;
    glm::vec3 eye_m, point_m;  ///< NaN: the sight met nothing
  };
  struct Fixation : Sight {
    double duration_s;
    std::size_t number;  ///< in fixations.tsv
    glm::vec3 normal;    ///< unit, towards the eye
  };

  std::vector<Point> points;
  std::size_t points_near = 0, points_all = 0;  ///< of the scene: within `reach_m`; all
  float reach_m = 0.0f;       ///< no coordinate of a point is larger; > 0 if there are points
  glm::vec3 low_m, high_m;    ///< box about nearly all eye positions and points met
  std::vector<Sight> path{};  ///< at most `kMaxSights` samples, in order of time
  std::vector<Fixation> fixations{};  ///< that met a surface
  std::vector<SightLine> lines{};     ///< beside those of fixations
};

inline constexpr std::size_t kMaxViewPoints = 200'000, kMaxSights = 4000;

/// @return absent if no gaze met the scene
std::optional<SceneView> sceneViewOf(const Scene& scene, const GazeInScene& gaze);

/// A view of the whole scene with these lines, whether they meet it or not. The path follows them.
/// @param lines  in the scene's world; not empty
SceneView sceneViewOf(const Scene& scene, const std::vector<SightLine>& lines,
                      const glm::dvec3& up);

enum class SceneSide { above, right };

/// Plan or side view for paper, an <svg> element: the scene as an image, without what lies between
/// the viewer and the gaze, and on it the path of the eye, lines of sight, and numbered fixations;
/// the observer looks to the right. Both sides have one scale.
std::string scenePlanSvg(const SceneView& view, SceneSide from);
glm::ivec2 scenePlanSize_px(const SceneView& view, SceneSide from);

/// Radius of a disc about a surfel or Gaussian, so that discs cover the surface.
float coveringRadius_m(const SurfelCloud& cloud, std::size_t i);
float coveringRadius_m(const GaussianCloud& cloud, std::size_t i);

class SceneVoxels {
 public:
  /// The cubes are a share of the box's longest side, and at least as wide as discs.
  /// @param low_m, high_m  what lies outside is left out
  SceneVoxels(const Scene& scene, const glm::dvec3& low_m, const glm::dvec3& high_m);

  /// Walks from cube to cube (Amanatides and Woo, 1987).
  /// @param direction  unit
  /// @return to the middle of the first full cube's stretch of the ray; 0 if the origin is in one
  std::optional<double> distance_m(const glm::dvec3& origin_m, const glm::dvec3& direction) const;

  double cube_m() const { return cube_m_; }

 private:
  void fill(const auto& cloud, const glm::dvec3& high_m);
  std::size_t indexOf(const glm::ivec3& at) const {
    return (std::size_t(at.z) * std::size_t(count_.y) + std::size_t(at.y)) * std::size_t(count_.x) +
           std::size_t(at.x);
  }

  glm::dvec3 low_m_;
  double cube_m_ = 0.0;
  glm::ivec3 count_{0};
  std::vector<std::uint8_t> full_{};
};

}  // namespace foci
