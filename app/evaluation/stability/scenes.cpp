#include "app/evaluation/stability/scenes.h"

#include <utility>

#include "app/evaluation/stability/setups.h"

namespace foci {
namespace {

using stability::GazeScore;

struct Score {
  const char* name;
  double good;
  bool high_is_good = false;
};
constexpr Score psnr(double good_dB) { return {"PSNR, dB", good_dB, true}; }
constexpr Score coverage(double good) { return {"coverage error, mean", good}; }
constexpr Score change(double good) { return {"excess change, 99.9 % quantile", good}; }
constexpr Score kClosedForm{"error against the closed form, mean", 0.02};
constexpr Score kLight{"relative error of its light", 0.02};

/// Scenes that methods render.
void addRendered(std::vector<StabilityScene>& scenes) {
  const auto add = [&](const char* name, const char* what, const char* dial,
                       std::vector<float> values, StabilitySetup (*setup)(float),
                       const Score& score) {
    scenes.push_back({.name = name,
                      .what = what,
                      .dial = dial,
                      .score = score.name,
                      .high_is_good = score.high_is_good,
                      .good = score.good,
                      .values = std::move(values),
                      .setup = setup});
  };
  add("parallel", "a half-plane 0.5 m away in front of a sheet, both blurred by 10 px",
      "distance between them, m", {0.2f, 0.1f, 0.05f, 0.02f, 0.01f, 0.005f, 0.002f, 0.001f},
      stability::parallel, coverage(0.02));
  add("crossing", "two textured planes that cross, blurred by 9 px where they meet",
      "angle between them, deg", {85.0f, 60.0f, 45.0f, 30.0f, 15.0f, 5.0f}, stability::intersecting,
      psnr(42.0));
  add("crossing-deep",
      "the same, but the slanted plane reaches from 0.4 to 1.6 m: blur radius up to 36 px",
      "angle between them, deg", {15.0f, 30.0f, 45.0f, 60.0f, 85.0f}, stability::intersectingDeep,
      psnr(42.0));
  add("slanted", "a textured plane through the focus, slanted", "angle to the screen, deg",
      {0.0f, 30.0f, 60.0f, 75.0f, 85.0f}, stability::slanted, psnr(35.0));
  add("curved", "a textured pillar, its nearest line in focus", "its radius, m",
      {1.0f, 0.4f, 0.2f, 0.1f, 0.05f}, stability::curved, psnr(35.0));
  add("density", "a wall whose samples thin out from left to right", "ratio of densities",
      {1.0f, 3.0f, 10.0f, 30.0f, 100.0f}, stability::density, coverage(0.03));
  add("patches", "a wall with holes 24 samples apart where samples are missing, blurred by 6 px",
      "width of a hole, samples", {0.0f, 2.0f, 4.0f, 8.0f, 12.0f}, stability::patches,
      coverage(0.03));
  add("duplicates", "a half-plane blurred by 8 px; a third of its points occur several times",
      "copies of each such point", {1.0f, 2.0f, 4.0f, 8.0f, 16.0f}, stability::duplicates,
      kClosedForm);
  add("normals", "a half-plane blurred by 8 px; its normals are wrong, each in a random direction",
      "error of the normals, deg", {0.0f, 10.0f, 20.0f, 30.0f, 45.0f, 60.0f},
      stability::misledNormals, kClosedForm);
  add("wire", "a wire in front of a sheet in focus, blurred by 6 px", "width, px",
      {5.0f, 2.0f, 1.0f, 0.5f, 0.2f}, stability::wire, kLight);
  add("sharp-before-blurred", "a half-plane in focus in front of a sheet out of focus",
      "blur of the sheet, px", {1.0f, 2.0f, 4.0f, 8.0f, 16.0f}, stability::sharpSilhouette,
      kClosedForm);
  add("blurred-before-sharp", "a half-plane out of focus in front of a sheet in focus",
      "blur of the half-plane, px", {1.0f, 2.0f, 4.0f, 8.0f, 16.0f}, stability::blurredSilhouette,
      kClosedForm);
  add("close-up", "a half-plane that approaches the eye until its blur is wider than the image",
      "distance, m", {0.5f, 0.2f, 0.1f, 0.05f, 0.02f}, stability::closeUp, kClosedForm);
  add("near-plane", "a slanted sheet, cut off by the near plane, in front of a sheet in focus",
      "blur at the cut, px", {1.0f, 4.0f, 8.0f, 16.0f, 32.0f}, stability::nearPlane, psnr(35.0));
  add("focus", "things 0.1 m, 1 m and 1 km away", "focus, D", {1.0f, 0.0f, 3.0f, 10.0f},
      stability::focusRange, psnr(35.0));
  add("point-light", "a point of light 1000 km away", "focus, D", {0.0f, 0.5f, 1.0f, 3.0f, 10.0f},
      stability::pointLight, kLight);
  add("transparent", "layers of opacity 0.3, 0.1 m apart, all out of focus", "layers",
      {1.0f, 2.0f, 4.0f, 8.0f, 16.0f}, stability::transparent, coverage(0.02));
  add("crossing-layers", "a fan of crossing layers of opacity 0.5, blurred by 9 px", "layers",
      {1.0f, 2.0f, 3.0f, 4.0f, 6.0f}, stability::crossingLayers, psnr(35.0));
  add("highlight", "one bright surfel on a wall blurred by 10 px", "times as bright as the wall",
      {1.0f, 10.0f, 100.0f, 1000.0f, 10000.0f}, stability::highlightOf, kLight);
  add("firefly", "the same: the pixel with the largest excess", "times as bright as the wall",
      {1.0f, 10.0f, 100.0f, 1000.0f, 10000.0f}, stability::firefly,
      {"excess, relative to the blurred highlight", 0.3});
  add("focus-sweep", "the focus moves by 0.02 D a frame over two textured sheets",
      "blur, px a dioptre", {5.0f, 10.0f, 20.0f, 40.0f}, stability::sweptFocus, change(0.005));
  add("moving-eye", "the eye moves past two textured sheets; the far one is in focus",
      "speed of the near sheet, px a frame", {0.1f, 0.3f, 1.0f, 3.0f}, stability::movingEye,
      change(0.02));
}

/// Scenes of gaze. Each is scored twice.
void addGazes(std::vector<StabilityScene>& scenes) {
  const auto add = [&](const std::string& name, const char* what, const char* dial,
                       const std::vector<float>& values,
                       double (*observe)(std::size_t, float, GazeScore)) {
    const auto addScored = [&](const char* suffix, const char* score, double good, GazeScore by) {
      scenes.push_back({.name = name + suffix,
                        .what = what,
                        .dial = dial,
                        .score = score,
                        .good = good,
                        .values = values,
                        .observers = stability::kObservers,
                        .observe = [observe, by](std::size_t observer, float value) {
                          return observe(observer, value, by);
                        }});
    };
    addScored("", "share of the time with wrong focus", 0.02, GazeScore::wrong_share);
    addScored("-jumps", "excess jumps of focus a second", 0.2, GazeScore::jumps_a_second);
  };
  add("gaze-noise", "a steady gaze 0.5 to 1.5 deg from an edge between surfaces at 0.5 and 2 m",
      "noise of a sample, deg", {0.1f, 0.3f, 0.5f, 1.0f, 2.0f}, stability::gazeNoise);
  add("gaze-loss",
      "a gaze that jumps across an edge between surfaces at 0.5 and 2 m, noise 0.3 deg",
      "data loss, %", {0.0f, 10.0f, 20.0f, 40.0f, 60.0f}, stability::gazeLoss);
}

}  // namespace

const std::vector<StabilityScene>& stabilityScenes() {
  static const std::vector<StabilityScene> scenes = [] {
    std::vector<StabilityScene> all;
    addRendered(all);
    addGazes(all);
    return all;
  }();
  return scenes;
}

}  // namespace foci
