#include "app/stability_scenes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "app/base/quantile.h"
#include "app/stability_setups.h"
#include "render/image/metrics.h"

namespace foci {
namespace {

double highlight(std::string_view method, float times, const StabilityEffort&) {
  const StabilitySetup with = stability::highlightOf(times);
  const Frame lit = stabilityFrame(with, method);
  const Frame unlit = stabilityFrame(stability::highlightOf(0.0f), method);
  double light = 0.0;
  for (std::size_t i = 0; i < lit.rgba.size(); ++i) light += lit.rgba[i].r - unlit.rgba[i].r;
  const double area_px = with.cloud.area_m2[0] * stability::kFocal_px * stability::kFocal_px;
  return std::abs(light / (0.1 * times * area_px) - 1.0);
}

/// The change from frame to frame beyond the reference's own that 99.9 % of the pixels stay below,
/// the most over a sweep of the focus through 0.02 D steps.
double popping(std::string_view method, float radius_px_per_D, const StabilityEffort& effort) {
  const StabilitySetup scene = stability::sweptScene(radius_px_per_D);
  const SurfelCloud& cloud = scene.cloud;
  const int steps = effort.every_value ? 12 : 4;
  const auto tested = makeMethod(method, cloud);
  const auto exact = makeMethod("accumulate:" + std::to_string(effort.views), cloud);
  Frame now, before, exact_now, exact_before;
  double most = 0.0;
  for (int k = 0; k <= steps; ++k) {
    RenderSettings settings = scene.settings;
    settings.defocus.focus_D += 0.02f * static_cast<float>(k);
    tested->render(stability::view(), settings, now);
    exact->render(stability::view(), settings, exact_now);
    if (k > 0) {
      std::vector<double> extra;
      for (std::size_t i = 0; i < now.rgba.size(); ++i) {
        const glm::vec3 change = glm::abs(glm::vec3(now.rgba[i] - before.rgba[i]));
        const glm::vec3 own = glm::abs(glm::vec3(exact_now.rgba[i] - exact_before.rgba[i]));
        const glm::vec3 beyond = glm::max(change - own, glm::vec3(0.0f));
        extra.push_back(std::max({beyond.x, beyond.y, beyond.z}));
      }
      most = std::max(most, quantile(extra, 0.999));
    }
    std::swap(now, before);
    std::swap(exact_now, exact_before);
  }
  return most;
}

}  // namespace

Frame stabilityFrame(const StabilitySetup& setup, std::string_view method) {
  Frame frame;
  makeMethod(method, setup.cloud)->render(stability::view(), setup.settings, frame);
  return frame;
}

std::vector<double> stabilityScores(const StabilityScene& scene, float value,
                                    const std::vector<std::string>& methods,
                                    const StabilityEffort& effort) {
  constexpr double kMost_dB = 99.0;
  std::vector<double> scores;
  if (scene.measure) {
    for (const std::string& method : methods) {
      scores.push_back(scene.measure(method, value, effort));
    }
    return scores;
  }
  const StabilitySetup setup = scene.setup(value);
  std::optional<Frame> reference;
  for (const std::string& method : methods) {
    const Frame frame = stabilityFrame(setup, method);
    if (setup.score) {
      scores.push_back(setup.score(frame));
      continue;
    }
    if (!reference) {
      reference = stabilityFrame(setup, "accumulate:" + std::to_string(effort.views));
    }
    scores.push_back(std::min(psnr_dB(frame, *reference), kMost_dB));
  }
  return scores;
}

const std::vector<StabilityScene>& stabilityScenes() {
  static const std::vector<StabilityScene> scenes = {
      {.name = "parallel",
       .what = "a half-plane 0.5 m away before a sheet, both blurred by 10 px",
       .dial = "distance between them, m",
       .score = "coverage error, mean",
       .values = {0.2f, 0.1f, 0.05f, 0.02f, 0.01f, 0.005f, 0.002f, 0.001f},
       .short_values = {0.1f, 0.005f},
       .setup = stability::parallel},
      {.name = "intersecting",
       .what = "two textured planes that cross, blurred by 9 px where they meet",
       .dial = "angle between them, deg",
       .score = "PSNR, dB",
       .high_is_good = true,
       .values = {85.0f, 60.0f, 45.0f, 30.0f, 15.0f, 5.0f},
       .short_values = {45.0f},
       .setup = stability::intersecting},
      {.name = "intersecting, deep",
       .what = "the same, but the slanted plane reaches from 0.4 to 1.6 m: blur up to 36 px",
       .dial = "angle between them, deg",
       .score = "PSNR, dB",
       .high_is_good = true,
       .values = {5.0f, 15.0f, 30.0f, 45.0f, 60.0f, 85.0f},
       .short_values = {},
       .setup = stability::intersectingDeep},
      {.name = "density",
       .what = "a wall whose samples thin out from left to right",
       .dial = "ratio of densities",
       .score = "coverage error, mean",
       .values = {1.0f, 3.0f, 10.0f, 30.0f, 100.0f},
       .short_values = {1.0f, 100.0f},
       .setup = stability::density},
      {.name = "wire",
       .what = "a wire before a sheet in focus, blurred by 6 px",
       .dial = "width, px",
       .score = "share of its light that is wrong",
       .values = {5.0f, 2.0f, 1.0f, 0.5f, 0.2f},
       .short_values = {5.0f, 0.2f},
       .setup = stability::wire},
      {.name = "silhouette, sharp before blurred",
       .what = "a half-plane in focus before a sheet that is not",
       .dial = "blur of the sheet, px",
       .score = "error against the closed form, mean",
       .values = {1.0f, 2.0f, 4.0f, 8.0f, 16.0f},
       .short_values = {8.0f},
       .setup = stability::sharpSilhouette},
      {.name = "silhouette, blurred before sharp",
       .what = "a half-plane out of focus before a sheet in focus",
       .dial = "blur of the half-plane, px",
       .score = "error against the closed form, mean",
       .values = {1.0f, 2.0f, 4.0f, 8.0f, 16.0f},
       .short_values = {8.0f},
       .setup = stability::blurredSilhouette},
      {.name = "close-up",
       .what = "a half-plane that comes up to the eye, until its blur is wider than the picture",
       .dial = "distance, m",
       .score = "error against the closed form, mean",
       .values = {0.5f, 0.2f, 0.1f, 0.05f, 0.02f},
       .short_values = {0.2f, 0.02f},
       .setup = stability::closeUp},
      {.name = "focus",
       .what = "things 0.1 m, 1 m and 1 km away",
       .dial = "focus, D",
       .score = "PSNR, dB",
       .high_is_good = true,
       .values = {1.0f, 0.0f, 3.0f, 10.0f},
       .short_values = {0.0f},
       .setup = stability::focusRange},
      {.name = "transparent",
       .what = "layers of an opacity of 0.3, 0.1 m apart, all blurred",
       .dial = "layers",
       .score = "coverage error, mean",
       .values = {1.0f, 2.0f, 4.0f, 8.0f, 16.0f},
       .short_values = {1.0f, 16.0f},
       .setup = stability::transparent},
      {.name = "highlight",
       .what = "one bright surfel on a wall blurred by 10 px",
       .dial = "times as bright as the wall",
       .score = "share of its light lost or gained",
       .values = {1.0f, 10.0f, 100.0f, 1000.0f, 10000.0f},
       .short_values = {10000.0f},
       .setup = stability::highlightOf,
       .measure = highlight},
      {.name = "slanted",
       .what = "a textured plane through the focus, slanted",
       .dial = "angle to the screen, deg",
       .score = "PSNR, dB",
       .high_is_good = true,
       .values = {0.0f, 30.0f, 60.0f, 75.0f, 85.0f},
       .short_values = {60.0f},
       .setup = stability::slanted},
      {.name = "focus sweep",
       .what = "the focus moves by 0.02 D a frame over two textured sheets",
       .dial = "blur, px a dioptre",
       .score = "change beyond the reference's, 99.9 % of pixels",
       .values = {5.0f, 10.0f, 20.0f, 40.0f},
       .short_values = {20.0f},
       .setup = stability::sweptScene,
       .measure = popping},
  };
  return scenes;
}

}  // namespace foci
