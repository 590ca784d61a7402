#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "app/study/framing.h"
#include "app/study/load_scene.h"
#include "app/study/session_settings_of.h"
#include "base/quantile.h"
#include "base/text.h"
#include "render/methods/method.h"

namespace foci {
namespace {

constexpr float kAround = 0.9f;      // share of directions that counts as all
constexpr float kTooNear_m = 0.02f;  // nearer than any eye focuses
constexpr int kBins = 8;             // along each side of a face of a cube around the eye
constexpr float kReach = 3.0f;       // support of a surfel's kernel, standard deviations

/// Whether any surfel may reach into the image.
bool anyInView(const View& view, const auto& cloud) {
  const glm::vec2 tangent = 0.5f * glm::vec2(view.size_px) / view.focal_px;
  const glm::vec2 across = glm::sqrt(1.0f + tangent * tangent);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const glm::vec3 p(view.eye_from_world * glm::vec4(cloud.position_m[i], 1.0f));
    const float reach = kReach * largestSigma(cloud, i);
    if (-p.z + reach < view.near_m) continue;
    // Distances from the four planes through the eye and the borders of the image.
    const glm::vec2 aside = (glm::abs(glm::vec2(p)) + p.z * tangent) / across;
    if (aside.x <= reach && aside.y <= reach) return true;
  }
  return false;
}

bool showsBack(const SurfelCloud& cloud, std::size_t i, const glm::vec3& from_eye) {
  return cloud.oriented &&
         glm::dot(glm::cross(cloud.axis_u_m[i], cloud.axis_v_m[i]), from_eye) > 0.0f;
}
bool showsBack(const GaussianCloud&, std::size_t, const glm::vec3&) { return false; }

/// The nearest surfel in each direction around the eye, on the faces of a cube.
class Surroundings {
 public:
  Surroundings(const glm::vec3& eye_m, const auto& cloud) {
    distance_m_.fill(std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const glm::vec3 to = cloud.position_m[i] - eye_m;
      const float distance = glm::length(to);
      if (!(distance > 0.0f)) continue;
      const std::size_t bin = binOf(to);
      if (distance >= distance_m_[bin]) continue;
      distance_m_[bin] = distance;
      back_[bin] = showsBack(cloud, i, to);
    }
  }

  /// Share of directions in which a surfel is nearer, or an oriented one shows its back.
  float shareNearer(float than_m) const {
    return shareWhere([&](std::size_t bin) { return distance_m_[bin] < than_m; });
  }
  float shareOfBacks() const {
    return shareWhere([&](std::size_t bin) { return back_[bin]; });
  }

 private:
  static constexpr std::size_t kCount = std::size_t{6} * kBins * kBins;

  static std::size_t binOf(const glm::vec3& to) {
    const glm::vec3 size = glm::abs(to);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    constexpr std::size_t kSide = kBins;
    const auto along = [&](int other) {
      const float share = 0.5f * (to[other] / size[axis] + 1.0f);
      return static_cast<std::size_t>(std::clamp(static_cast<int>(share * kBins), 0, kBins - 1));
    };
    const std::size_t face = 2 * static_cast<std::size_t>(axis) + (to[axis] > 0.0f ? 1 : 0);
    return (face * kSide + along((axis + 1) % 3)) * kSide + along((axis + 2) % 3);
  }

  template <class Condition>
  float shareWhere(const Condition& condition) const {
    int count = 0;
    for (std::size_t bin = 0; bin < kCount; ++bin) count += condition(bin) ? 1 : 0;
    return static_cast<float>(count) / static_cast<float>(kCount);
  }

  std::array<float, kCount> distance_m_{};
  std::array<bool, kCount> back_{};
};

std::string lengthText(double length_m) {
  const double digits = 2.0 - std::floor(std::log10(length_m));
  return decimal(length_m, static_cast<int>(std::clamp(digits, 0.0, 9.0))) + " m";
}

std::string pointText(const glm::dvec3& p) {
  return "[" + decimal(p.x, 3) + ", " + decimal(p.y, 3) + ", " + decimal(p.z, 3) + "]";
}

/// How to make the scene's unit longer or shorter.
std::string scaleAdvice(const Study& study, bool longer) {
  const double scale_m = study.scene.scale_m;
  if (longer ? scale_m >= kMaxScale_m : scale_m <= kMinScale_m) {
    return "scene.scale_m is at its limit, so write the file in other units, e.g. with Blender";
  }
  return std::string("if a unit of the file is ") + (longer ? "more" : "less") + " than " +
         exactText(scale_m) + " m, set scene.scale_m";
}

std::string sizeRemark(const Study& study, const SceneBox& box) {
  const double width_m = box.longest();
  if (width_m > kWidestScene_m) {
    return "the scene is " + lengthText(width_m) +
           " wide, and blur differs within some metres only: " +
           scaleAdvice(study, /*longer=*/false);
  }
  if (width_m > 0.0 && width_m < kNarrowestScene_m) {
    return "the scene is " + lengthText(width_m) +
           " wide, too small for an eye: " + scaleAdvice(study, /*longer=*/true);
  }
  return "";
}

/// The median distance of neighbouring surfels in view, in pixels; 0 if none is in view.
double spacingInView_px(const View& view, const SurfelCloud& cloud) {
  constexpr std::size_t kMost = 200'000;  // of all surfels, evenly spread
  std::vector<float> spacings_px;
  const std::size_t step = cloud.size() / kMost + 1;
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    const glm::vec3 p(view.eye_from_world * glm::vec4(cloud.position_m[i], 1.0f));
    const float depth_m = -p.z;
    if (depth_m < view.near_m) continue;
    const glm::vec2 at = view.principal_px + view.focal_px * glm::vec2(p.x, -p.y) / depth_m;
    const glm::vec2 size(view.size_px);
    if (at.x < 0.0f || at.y < 0.0f || at.x > size.x || at.y > size.y) continue;
    spacings_px.push_back(std::sqrt(cloud.area_m2[i]) * view.focal_px.y / depth_m);
  }
  return spacings_px.empty() ? 0.0 : double{quantile(spacings_px, 0.5)};
}

/// Parts that are hardly wider than the distance of the surfels dissolve.
std::string densityRemark(const Study& study, const Scene& scene) {
  constexpr double kCoarse_px = 3.0, kMostPoints = 1e8;
  const SurfelCloud* const cloud = scene.surfels();
  if (!cloud || !cloud->mesh) return "";
  const double spacing_px = spacingInView_px(firstViewOf(study), *cloud);
  if (spacing_px <= kCoarse_px) return "";
  const double needed = static_cast<double>(cloud->size()) * spacing_px * spacing_px;
  const double millions = std::ceil(std::min(needed, kMostPoints) / 1e6);
  return "surfels of the mesh are " + decimal(spacing_px, 0) +
         " px apart in view, and smaller parts dissolve: foci prepare --points " +
         decimal(1e6 * millions, 0) + " makes more of them";
}

}  // namespace

View firstViewOf(const Study& study) {
  const Screen screen = study.screenInForce();
  return viewThroughScreen(eyePathOf(study).eyeFromWorldAt(0.0), study.imageSize_px(),
                           screen.size_m, screen.distance_m, screen.faced_m);
}

bool isSceneInView(const Study& study, const Scene& scene) {
  return std::visit([&](const auto& cloud) { return anyInView(firstViewOf(study), cloud); },
                    scene.splats);
}

std::vector<std::string> viewRemarks(const Study& study, const Scene& scene) {
  const std::optional<Scene> outline = outlineOf(scene);
  const Scene& seen = outline ? *outline : scene;
  const glm::vec3 eye_m(glm::inverse(eyePathOf(study).eyeFromWorldAt(0.0))[3]);
  const SceneBox box = boxWithoutStrays(seen.position_m());
  std::vector<std::string> remarks;
  if (std::string remark = sizeRemark(study, box); !remark.empty())
    remarks.push_back(std::move(remark));
  if (!isSceneInView(study, seen)) {
    if (!remarks.empty() && box.longest() < kNarrowestScene_m) return remarks;  // that is why
    remarks.push_back("nothing is in view: the middle of the scene is at " +
                      pointText(box.middle()) + ", " +
                      lengthText(std::max(glm::distance(box.middle(), glm::dvec3(eye_m)), 1e-9)) +
                      " from the eye: set " +
                      (study.eye.recorded ? "gaze.scene_offset_m, gaze.scene_rotation or "
                                            "scene.scale_m, since the recording's head moves the "
                                            "eye"
                                          : "eye.look_at_m or eye.position_m"));
    return remarks;
  }
  if (std::string dissolves = densityRemark(study, scene); !dissolves.empty())
    remarks.push_back(std::move(dissolves));
  const auto aroundEye = [&](const auto& cloud) { return Surroundings(eye_m, cloud); };
  const Surroundings around = std::visit(aroundEye, seen.splats);
  const std::string place = study.eye.recorded ? "gaze.scene_offset_m" : "eye.position_m";
  if (around.shareNearer(kTooNear_m) > kAround) {
    remarks.push_back("surfaces are nearer than 2 cm all around the eye: set " + place +
                      ", or scene.scale_m");
  } else if (around.shareOfBacks() > kAround) {
    remarks.push_back("the eye stands inside a solid: set " + place + ", with the eye outside of " +
                      pointText(box.low) + " to " + pointText(box.high));
  }
  return remarks;
}

std::string memoryRemark(const Study& study, const Scene& scene, std::size_t large) {
  // Surfels and splats; measured with 20 million surfels, of which half are in view.
  constexpr double kBytesASurfel = 130.0;
  const SurfelCloud* const cloud = scene.surfels();
  if (!cloud || cloud->size() <= large || methodInfo(study.render.method).lod) return "";
  const auto count = static_cast<double>(cloud->size());
  return "render.method = \"" + study.render.method + "\" renders each of " +
         decimal(count / 1e6, 1) + " million surfels and takes about " +
         decimal(count * kBytesASurfel / 1e9, 1) +
         " GB of memory: \"auto\" and \"sweep-lod\" take memory for what the frame shows";
}

}  // namespace foci
