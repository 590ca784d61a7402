#include "app/replay/heatmap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <numeric>

#include "app/graphics/image.h"
#include "render/image/srgb.h"
#include "render/methods/method.h"
#include "render/optics/view.h"
#include "render/scene/io/ply.h"

namespace foci {
namespace {

constexpr glm::ivec2 kPicture_px{720, 480};
constexpr double kFov_rad = 0.9, kTurn_rad = glm::pi<double>() / 3.0;
constexpr float kDim = 0.45f;       // of the scene under the heat
constexpr float kShading = 0.6f;    // shows the form of plain surfaces
constexpr double kExceeded = 0.01;  // share of the time beyond the end of the scale
const glm::vec3 kLuminance(0.2126f, 0.7152f, 0.0722f);  // of the sRGB primaries

/// Inferno (van der Walt and Smith 2015) at 0, 1/4, 1/2, 3/4 and 1; sRGB.
glm::vec3 infernoAt(float heat) {
  constexpr std::array<glm::vec3, 5> kStops = {glm::vec3(0, 0, 4), glm::vec3(87, 16, 110),
                                               glm::vec3(188, 55, 84), glm::vec3(249, 142, 9),
                                               glm::vec3(252, 255, 164)};
  const float at = 4.0f * std::clamp(heat, 0.0f, 1.0f);
  const auto low = static_cast<std::size_t>(std::min(at, 3.0f));
  const glm::vec3 code = glm::mix(kStops.at(low), kStops.at(low + 1), at - static_cast<float>(low));
  glm::vec3 linear;
  for (int c = 0; c < 3; ++c) linear[c] = linearFromSrgb(code[c] / 255.0f);
  return linear;
}

/// Attention per area at the end of the scale.
double scaleOf(const SurfelCloud& cloud, const std::vector<double>& attention_s) {
  std::vector<std::size_t> order(attention_s.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto density = [&](std::size_t i) {
    return attention_s[i] / static_cast<double>(cloud.area_m2[i]);
  };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return density(a) > density(b) || (density(a) == density(b) && a < b);
  });
  const double all_s = std::accumulate(attention_s.begin(), attention_s.end(), 0.0);
  double sum_s = 0.0;
  for (const std::size_t i : order) {
    sum_s += attention_s[i];
    if (sum_s >= kExceeded * all_s) return density(i);
  }
  return 0.0;
}

HeatPicture pictureFrom(Method& method, const glm::dvec3& eye_m, const glm::dvec3& middle_m,
                        std::string caption) {
  const glm::dvec3 towards = middle_m - eye_m;
  const bool upright = std::abs(towards.y) > 0.99 * glm::length(towards);
  const View view = viewOfCamera(
      eyeFromWorld(glm::vec3(eye_m), glm::vec3(middle_m),
                   upright ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(0.0f, 1.0f, 0.0f)),
      kPicture_px, kFov_rad);
  Frame frame;
  RenderSettings settings;
  settings.shading = kShading;
  method.render(view, settings, frame);
  return {.caption = std::move(caption), .jpeg = jpegOf(imageOf(frame))};
}

}  // namespace

SurfelCloud heatCloud(const SurfelCloud& cloud, const std::vector<double>& attention_s) {
  SurfelCloud heat = cloud;
  const double scale = scaleOf(cloud, attention_s);
  for (std::size_t i = 0; i < heat.size(); ++i) {
    const float grey = kDim * glm::dot(kLuminance, glm::min(cloud.color[i], glm::vec3(1.0f)));
    const double density = attention_s[i] / static_cast<double>(cloud.area_m2[i]);
    const auto share = scale > 0.0 ? static_cast<float>(std::min(density / scale, 1.0)) : 0.0f;
    heat.color[i] = share > 0.0f ? glm::mix(glm::vec3(grey), infernoAt(0.25f + 0.75f * share),
                                            std::min(8.0f * share, 1.0f))
                                 : glm::vec3(grey);
  }
  return heat;
}

std::vector<HeatPicture> heatPictures(const SurfelCloud& heat, const GazeInScene& gaze) {
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
  const double c = std::cos(kTurn_rad), s = std::sin(kTurn_rad);
  const glm::dvec3 turned(c * from.x + s * from.z, from.y, c * from.z - s * from.x);
  const auto method = makeMethod("pinhole", heat);
  std::vector<HeatPicture> pictures;
  pictures.push_back(pictureFrom(*method, eye_m, middle_m, "from the observer's mean place"));
  pictures.push_back(pictureFrom(*method, middle_m + turned, middle_m, "turned by 60 degrees"));
  return pictures;
}

void writeHeatPly(const std::filesystem::path& file, const SurfelCloud& heat,
                  const std::vector<double>& attention_s) {
  PointCloud points;
  points.position_m.assign(heat.position_m.begin(), heat.position_m.end());
  points.color.assign(heat.color.begin(), heat.color.end());
  points.normal.resize(heat.size());
  for (std::size_t i = 0; i < heat.size(); ++i) {
    points.normal[i] = glm::normalize(
        glm::cross(glm::normalize(heat.axis_u_m[i]), glm::normalize(heat.axis_v_m[i])));
  }
  const std::vector<float> seconds(attention_s.begin(), attention_s.end());
  writePly(file, points, {.name = "attention_s", .values = seconds});
}

}  // namespace foci
