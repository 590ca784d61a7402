#include "app/evaluation/stability/scenes.h"

#include <utility>

#include "app/evaluation/stability/setups.h"

namespace foci {
namespace {

using stability::GazeScore;

std::vector<StabilityScene> surfaces() {
  return {
      {.name = "parallel",
       .what = "a half-plane 0.5 m away in front of a sheet, both blurred by 10 px",
       .dial = "distance between them, m",
       .score = "coverage error, mean",
       .good = 0.02,
       .values = {0.2f, 0.1f, 0.05f, 0.02f, 0.01f, 0.005f, 0.002f, 0.001f},
       .setup = stability::parallel},
      {.name = "crossing",
       .what = "two textured planes that cross, blurred by 9 px where they meet",
       .dial = "angle between them, deg",
       .score = "PSNR, dB",
       .high_is_good = true,
       .good = 42.0,
       .values = {85.0f, 60.0f, 45.0f, 30.0f, 15.0f, 5.0f},
       .setup = stability::intersecting},
      {.name = "crossing-deep",
       .what = "the same, but the slanted plane reaches from 0.4 to 1.6 m: blur radius up to 36 px",
       .dial = "angle between them, deg",
       .score = "PSNR, dB",
       .high_is_good = true,
       .good = 42.0,
       .values = {15.0f, 30.0f, 45.0f, 60.0f, 85.0f},
       .setup = stability::intersectingDeep},
      {.name = "slanted",
       .what = "a textured plane through the focus, slanted",
       .dial = "angle to the screen, deg",
       .score = "PSNR, dB",
       .high_is_good = true,
       .good = 35.0,
       .values = {0.0f, 30.0f, 60.0f, 75.0f, 85.0f},
       .setup = stability::slanted},
      {.name = "curved",
       .what = "a textured pillar, its nearest line in focus",
       .dial = "its radius, m",
       .score = "PSNR, dB",
       .high_is_good = true,
       .good = 35.0,
       .values = {1.0f, 0.4f, 0.2f, 0.1f, 0.05f},
       .setup = stability::curved},
  };
}

std::vector<StabilityScene> samplings() {
  return {
      {.name = "density",
       .what = "a wall whose samples thin out from left to right",
       .dial = "ratio of densities",
       .score = "coverage error, mean",
       .good = 0.03,
       .values = {1.0f, 3.0f, 10.0f, 30.0f, 100.0f},
       .setup = stability::density},
      {.name = "patches",
       .what = "a wall with holes 24 samples apart where samples are missing, blurred by 6 px",
       .dial = "width of a hole, samples",
       .score = "coverage error, mean",
       .good = 0.03,
       .values = {0.0f, 2.0f, 4.0f, 8.0f, 12.0f},
       .setup = stability::patches},
      {.name = "duplicates",
       .what = "a half-plane blurred by 8 px; a third of its points occur several times",
       .dial = "copies of each such point",
       .score = "error against the closed form, mean",
       .good = 0.02,
       .values = {1.0f, 2.0f, 4.0f, 8.0f, 16.0f},
       .setup = stability::duplicates},
      {.name = "normals",
       .what = "a half-plane blurred by 8 px; its normals are wrong, each in a random direction",
       .dial = "error of the normals, deg",
       .score = "error against the closed form, mean",
       .good = 0.02,
       .values = {0.0f, 10.0f, 20.0f, 30.0f, 45.0f, 60.0f},
       .setup = stability::misledNormals},
  };
}

std::vector<StabilityScene> outlines() {
  return {
      {.name = "wire",
       .what = "a wire in front of a sheet in focus, blurred by 6 px",
       .dial = "width, px",
       .score = "relative error of its light",
       .good = 0.02,
       .values = {5.0f, 2.0f, 1.0f, 0.5f, 0.2f},
       .setup = stability::wire},
      {.name = "sharp-before-blurred",
       .what = "a half-plane in focus in front of a sheet out of focus",
       .dial = "blur of the sheet, px",
       .score = "error against the closed form, mean",
       .good = 0.02,
       .values = {1.0f, 2.0f, 4.0f, 8.0f, 16.0f},
       .setup = stability::sharpSilhouette},
      {.name = "blurred-before-sharp",
       .what = "a half-plane out of focus in front of a sheet in focus",
       .dial = "blur of the half-plane, px",
       .score = "error against the closed form, mean",
       .good = 0.02,
       .values = {1.0f, 2.0f, 4.0f, 8.0f, 16.0f},
       .setup = stability::blurredSilhouette},
      {.name = "close-up",
       .what = "a half-plane that approaches the eye until its blur is wider than the image",
       .dial = "distance, m",
       .score = "error against the closed form, mean",
       .good = 0.02,
       .values = {0.5f, 0.2f, 0.1f, 0.05f, 0.02f},
       .setup = stability::closeUp},
      {.name = "near-plane",
       .what = "a slanted sheet, cut off by the near plane, in front of a sheet in focus",
       .dial = "blur at the cut, px",
       .score = "PSNR, dB",
       .high_is_good = true,
       .good = 35.0,
       .values = {1.0f, 4.0f, 8.0f, 16.0f, 32.0f},
       .setup = stability::nearPlane},
  };
}

std::vector<StabilityScene> lights() {
  return {
      {.name = "focus",
       .what = "things 0.1 m, 1 m and 1 km away",
       .dial = "focus, D",
       .score = "PSNR, dB",
       .high_is_good = true,
       .good = 35.0,
       .values = {1.0f, 0.0f, 3.0f, 10.0f},
       .setup = stability::focusRange},
      {.name = "point-light",
       .what = "a point of light 1000 km away",
       .dial = "focus, D",
       .score = "relative error of its light",
       .good = 0.02,
       .values = {0.0f, 0.5f, 1.0f, 3.0f, 10.0f},
       .setup = stability::pointLight},
      {.name = "transparent",
       .what = "layers of opacity 0.3, 0.1 m apart, all out of focus",
       .dial = "layers",
       .score = "coverage error, mean",
       .good = 0.02,
       .values = {1.0f, 2.0f, 4.0f, 8.0f, 16.0f},
       .setup = stability::transparent},
      {.name = "crossing-layers",
       .what = "a fan of crossing layers of opacity 0.5, blurred by 9 px",
       .dial = "layers",
       .score = "PSNR, dB",
       .high_is_good = true,
       .good = 35.0,
       .values = {1.0f, 2.0f, 3.0f, 4.0f, 6.0f},
       .setup = stability::crossingLayers},
      {.name = "highlight",
       .what = "one bright surfel on a wall blurred by 10 px",
       .dial = "times as bright as the wall",
       .score = "relative error of its light",
       .good = 0.02,
       .values = {1.0f, 10.0f, 100.0f, 1000.0f, 10000.0f},
       .setup = stability::highlightOf},
      {.name = "firefly",
       .what = "the same: the pixel with the largest excess",
       .dial = "times as bright as the wall",
       .score = "excess, relative to the blurred highlight",
       .good = 0.3,
       .values = {1.0f, 10.0f, 100.0f, 1000.0f, 10000.0f},
       .setup = stability::firefly},
  };
}

std::vector<StabilityScene> sequences() {
  const std::string change = "excess change, 99.9 % quantile";
  return {
      {.name = "focus-sweep",
       .what = "the focus moves by 0.02 D a frame over two textured sheets",
       .dial = "blur, px a dioptre",
       .score = change,
       .good = 0.005,
       .values = {5.0f, 10.0f, 20.0f, 40.0f},
       .setup = stability::sweptFocus},
      {.name = "moving-eye",
       .what = "the eye moves past two textured sheets; the far one is in focus",
       .dial = "speed of the near sheet, px a frame",
       .score = change,
       .good = 0.02,
       .values = {0.1f, 0.3f, 1.0f, 3.0f},
       .setup = stability::movingEye},
  };
}

std::vector<StabilityScene> gazes() {
  const std::string steady =
      "a steady gaze 0.5 to 1.5 deg from an edge between surfaces at 0.5 and 2 m";
  const std::string crossing =
      "a gaze that jumps across an edge between surfaces at 0.5 and 2 m, noise 0.3 deg";
  const std::string wrong = "share of the time with wrong focus";
  const std::string jumps = "excess jumps of focus a second";
  const std::vector<float> noise_deg = {0.1f, 0.3f, 0.5f, 1.0f, 2.0f};
  const std::vector<float> lost_percent = {0.0f, 10.0f, 20.0f, 40.0f, 60.0f};
  const auto by = [](double (*of)(std::size_t, float, GazeScore), GazeScore score) {
    return [=](std::size_t observer, float value) { return of(observer, value, score); };
  };
  return {{.name = "gaze-noise",
           .what = steady,
           .dial = "noise of a sample, deg",
           .score = wrong,
           .good = 0.02,
           .values = noise_deg,
           .observers = stability::kObservers,
           .observe = by(stability::gazeNoise, GazeScore::wrong_share)},
          {.name = "gaze-noise-jumps",
           .what = steady,
           .dial = "noise of a sample, deg",
           .score = jumps,
           .good = 0.2,
           .values = noise_deg,
           .observers = stability::kObservers,
           .observe = by(stability::gazeNoise, GazeScore::jumps_a_second)},
          {.name = "gaze-loss",
           .what = crossing,
           .dial = "data loss, %",
           .score = wrong,
           .good = 0.02,
           .values = lost_percent,
           .observers = stability::kObservers,
           .observe = by(stability::gazeLoss, GazeScore::wrong_share)},
          {.name = "gaze-loss-jumps",
           .what = crossing,
           .dial = "data loss, %",
           .score = jumps,
           .good = 0.2,
           .values = lost_percent,
           .observers = stability::kObservers,
           .observe = by(stability::gazeLoss, GazeScore::jumps_a_second)}};
}

}  // namespace

const std::vector<StabilityScene>& stabilityScenes() {
  static const std::vector<StabilityScene> scenes = [] {
    std::vector<StabilityScene> all;
    for (auto* some : {surfaces, samplings, outlines, lights, sequences, gazes}) {
      for (StabilityScene& scene : some()) all.push_back(std::move(scene));
    }
    return all;
  }();
  return scenes;
}

}  // namespace foci
