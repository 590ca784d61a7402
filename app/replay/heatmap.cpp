#include "app/replay/heatmap.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numeric>
#include <span>
#include <utility>

#include "app/graphics/image.h"
#include "base/text.h"
#include "render/image/srgb.h"
#include "render/methods/method.h"
#include "render/optics/view.h"
#include "render/scene/io/ply.h"

namespace foci {
namespace {

constexpr double kFov_rad = 0.9, kTurn_rad = glm::pi<double>() / 3.0;
constexpr float kDim = 0.45f;       // of the scene under the heat
constexpr float kShading = 0.6f;    // shows the form of plain surfaces
constexpr double kExceeded = 0.01;  // share of the time beyond the end of the scale
const glm::vec3 kLuminance(0.2126f, 0.7152f, 0.0722f);  // of the sRGB primaries

glm::vec3 linearOf(const glm::vec3& code) {
  return {linearFromSrgb(code.x), linearFromSrgb(code.y), linearFromSrgb(code.z)};
}

/// Attention per area at the end of the scale.
double scaleOf(const std::vector<double>& attention_s, const std::vector<double>& heat_s_per_m2) {
  std::vector<std::size_t> order(attention_s.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    return heat_s_per_m2[a] > heat_s_per_m2[b] || (heat_s_per_m2[a] == heat_s_per_m2[b] && a < b);
  });
  const double all_s = std::accumulate(attention_s.begin(), attention_s.end(), 0.0);
  double sum_s = 0.0;
  for (const std::size_t i : order) {
    sum_s += attention_s[i];
    if (sum_s >= kExceeded * all_s) return heat_s_per_m2[i];
  }
  return 0.0;
}

/// Gives each surfel or Gaussian the display colour `codeOf(i, linear)`.
void recolor(SurfelCloud& cloud, const auto& codeOf) {
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.color[i] = linearOf(codeOf(i, std::as_const(cloud).color[i]));
  }
}
void recolor(GaussianCloud& cloud, const auto& codeOf) {
  cloud.degree = 0;
  cloud.tree.reset();
  cloud.harmonics.clear();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.color[i] = codeOf(i, linearOf(displayColorOf(cloud, i)));
  }
}

void addColors(PointCloud& points, const SurfelCloud& cloud) {
  points.color.assign(cloud.color.begin(), cloud.color.end());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    points.normal.push_back(glm::normalize(
        glm::cross(glm::normalize(cloud.axis_u_m[i]), glm::normalize(cloud.axis_v_m[i]))));
  }
}
void addColors(PointCloud& points, const GaussianCloud& cloud) {
  for (const glm::vec3& code : cloud.color) points.color.push_back(linearOf(code));
}

HeatPicture pictureFrom(Method& method, const glm::dvec3& eye_m, const glm::dvec3& middle_m,
                        const glm::dvec3& up, const glm::ivec2& size_px, std::string caption) {
  const glm::dvec3 towards = glm::normalize(middle_m - eye_m);
  const bool along_up = std::abs(glm::dot(towards, up)) > 0.99;
  const glm::dvec3 other = tangentTo(glm::vec3(up));
  const View view = viewOfCamera(
      eyeFromWorld(glm::vec3(eye_m), glm::vec3(middle_m), glm::vec3(along_up ? other : up)),
      size_px, kFov_rad);
  Frame frame;
  RenderSettings settings;
  settings.lighting.shading = kShading;
  method.render(view, settings, frame);
  return {.caption = std::move(caption), .image = imageOf(frame)};
}

}  // namespace

HeatMap heatMapOf(const Scene& scene, const GazeInScene& gaze, ColorMap colors) {
  HeatMap map{.scene = scene, .most_s_per_m2 = scaleOf(gaze.attention_s, gaze.heat_s_per_m2)};
  const auto codeOf = [&](std::size_t i, const glm::vec3& linear) {
    const float grey = kDim * glm::dot(kLuminance, glm::clamp(linear, 0.0f, 1.0f));
    const bool scaled = map.most_s_per_m2 > 0.0;
    const double share = scaled ? gaze.heat_s_per_m2[i] / map.most_s_per_m2 : 0.0;
    return heatAt(colors, static_cast<float>(std::min(share, 1.0)), srgbFromLinear(grey));
  };
  std::visit([&](auto& cloud) { recolor(cloud, codeOf); }, map.scene.splats);
  return map;
}

std::string heatBarHtml(double most_s_per_m2) {
  constexpr int kStops = 12;
  std::string colors;
  for (int i = 0; i <= kStops; ++i) {
    colors += ", " + hexOf(heatAt(ColorMap::inferno, static_cast<float>(i) / kStops, 0.0f));
  }
  return "<p class=\"quiet\">0 <span role=\"img\" aria-label=\"scale of the heatmap\" "
         "style=\"display:inline-block;width:20rem;height:1rem;background:linear-gradient(to "
         "right" +
         colors + ")\"></span> &ge; " + significant(most_s_per_m2, 3) + " s/m&sup2;</p>\n";
}

std::vector<HeatPicture> heatPictures(const Scene& heat, const GazeInScene& gaze,
                                      const glm::ivec2& size_px) {
  glm::dvec3 eye_m(0.0), middle_m(0.0);
  double all_s = 0.0;
  for (const SightSample& sample : gaze.samples) {
    if (!sample.hit) continue;
    eye_m += sample.lasts_s * sample.origin_m;
    middle_m += sample.lasts_s * sample.hit->point_m;
    all_s += sample.lasts_s;
  }
  if (!(all_s > 0.0)) return {};
  eye_m /= all_s;
  middle_m /= all_s;
  const glm::dvec3 from = eye_m - middle_m;
  if (!(glm::length(from) > 1e-6)) return {};
  const glm::dvec3 turned = glm::angleAxis(kTurn_rad, gaze.up) * from;
  const auto method = makeMethod("pinhole", heat);
  std::vector<HeatPicture> pictures;
  pictures.push_back(
      pictureFrom(*method, eye_m, middle_m, gaze.up, size_px, "from the observer's mean place"));
  pictures.push_back(
      pictureFrom(*method, middle_m + turned, middle_m, gaze.up, size_px, "turned by 60 degrees"));
  return pictures;
}

void writeHeatPly(const std::filesystem::path& file, const Scene& heat,
                  const std::vector<double>& attention_s) {
  PointCloud points;
  const std::span<const glm::vec3> all_m = heat.position_m();
  points.position_m.assign(all_m.begin(), all_m.end());
  std::visit([&](const auto& cloud) { addColors(points, cloud); }, heat.splats);
  const std::vector<float> seconds(attention_s.begin(), attention_s.end());
  writePly(file, points, {.name = "attention_s", .values = seconds});
}

}  // namespace foci
