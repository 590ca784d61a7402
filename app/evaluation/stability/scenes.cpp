#include "app/evaluation/stability/scenes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "app/evaluation/stability/setups.h"
#include "base/quantile.h"
#include "render/image/metrics.h"

namespace foci {
namespace {

using stability::GazeScore;

constexpr double kMost_dB = 99.0;

std::vector<StabilityScene> surfaces() {
  return {
      {.name = "parallel",
       .what = "a half-plane 0.5 m away before a sheet, both blurred by 10 px",
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
       .what = "the same, but the slanted plane reaches from 0.4 to 1.6 m: blur up to 36 px",
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
       .what = "a half-plane blurred by 8 px, of a third of whose points there are several",
       .dial = "copies of these points",
       .score = "error against the closed form, mean",
       .good = 0.02,
       .values = {1.0f, 2.0f, 4.0f, 8.0f, 16.0f},
       .setup = stability::duplicates},
      {.name = "normals",
       .what = "a half-plane blurred by 8 px whose normals are wrong, each in its own direction",
       .dial = "off by, deg",
       .score = "error against the closed form, mean",
       .good = 0.02,
       .values = {0.0f, 10.0f, 20.0f, 30.0f, 45.0f, 60.0f},
       .setup = stability::misledNormals},
  };
}

std::vector<StabilityScene> outlines() {
  return {
      {.name = "wire",
       .what = "a wire before a sheet in focus, blurred by 6 px",
       .dial = "width, px",
       .score = "share of its light that is wrong",
       .good = 0.02,
       .values = {5.0f, 2.0f, 1.0f, 0.5f, 0.2f},
       .setup = stability::wire},
      {.name = "sharp-before-blurred",
       .what = "a half-plane in focus before a sheet that is not",
       .dial = "blur of the sheet, px",
       .score = "error against the closed form, mean",
       .good = 0.02,
       .values = {1.0f, 2.0f, 4.0f, 8.0f, 16.0f},
       .setup = stability::sharpSilhouette},
      {.name = "blurred-before-sharp",
       .what = "a half-plane out of focus before a sheet in focus",
       .dial = "blur of the half-plane, px",
       .score = "error against the closed form, mean",
       .good = 0.02,
       .values = {1.0f, 2.0f, 4.0f, 8.0f, 16.0f},
       .setup = stability::blurredSilhouette},
      {.name = "close-up",
       .what = "a half-plane that comes up to the eye, until its blur is wider than the image",
       .dial = "distance, m",
       .score = "error against the closed form, mean",
       .good = 0.02,
       .values = {0.5f, 0.2f, 0.1f, 0.05f, 0.02f},
       .setup = stability::closeUp},
      {.name = "near-plane",
       .what = "a slanted sheet that the near plane cuts off, before a sheet in focus",
       .dial = "blur where it is cut, px",
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
       .score = "share of its light lost or gained",
       .good = 0.02,
       .values = {0.0f, 0.5f, 1.0f, 3.0f, 10.0f},
       .setup = stability::pointLight},
      {.name = "transparent",
       .what = "layers of an opacity of 0.3, 0.1 m apart, all blurred",
       .dial = "layers",
       .score = "coverage error, mean",
       .good = 0.02,
       .values = {1.0f, 2.0f, 4.0f, 8.0f, 16.0f},
       .setup = stability::transparent},
      {.name = "crossing-layers",
       .what = "a fan of layers of an opacity of 0.5 that cross, blurred by 9 px",
       .dial = "layers",
       .score = "PSNR, dB",
       .high_is_good = true,
       .good = 35.0,
       .values = {1.0f, 2.0f, 3.0f, 4.0f, 6.0f},
       .setup = stability::crossingLayers},
      {.name = "highlight",
       .what = "one bright surfel on a wall blurred by 10 px",
       .dial = "times as bright as the wall",
       .score = "share of its light lost or gained",
       .good = 0.02,
       .values = {1.0f, 10.0f, 100.0f, 1000.0f, 10000.0f},
       .setup = stability::highlightOf},
      {.name = "firefly",
       .what = "the same: the pixel that is most too bright",
       .dial = "times as bright as the wall",
       .score = "too bright by, of the blurred highlight",
       .good = 0.3,
       .values = {1.0f, 10.0f, 100.0f, 1000.0f, 10000.0f},
       .setup = stability::firefly},
  };
}

std::vector<StabilityScene> sequences() {
  const std::string change = "change beyond the reference's, 99.9 % of pixels";
  return {
      {.name = "focus-sweep",
       .what = "the focus moves by 0.02 D a frame over two textured sheets",
       .dial = "blur, px a dioptre",
       .score = change,
       .good = 0.005,
       .values = {5.0f, 10.0f, 20.0f, 40.0f},
       .setup = stability::sweptFocus},
      {.name = "moving-eye",
       .what = "the eye moves past two textured sheets, the far one in focus",
       .dial = "speed of what is near, px a frame",
       .score = change,
       .good = 0.02,
       .values = {0.1f, 0.3f, 1.0f, 3.0f},
       .setup = stability::movingEye},
  };
}

std::vector<StabilityScene> gazes() {
  const std::string steady = "a steady gaze 0.5 to 1.5 deg beside an edge, 0.5 m before 2 m";
  const std::string crossing = "gaze to and fro across an edge, 0.5 m before 2 m, noise 0.3 deg";
  const std::string wrong = "share of the time in wrong focus";
  const std::string jumps = "jumps of focus a second too many";
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
           .dial = "samples lost, %",
           .score = wrong,
           .good = 0.02,
           .values = lost_percent,
           .observers = stability::kObservers,
           .observe = by(stability::gazeLoss, GazeScore::wrong_share)},
          {.name = "gaze-loss-jumps",
           .what = crossing,
           .dial = "samples lost, %",
           .score = jumps,
           .good = 0.2,
           .values = lost_percent,
           .observers = stability::kObservers,
           .observe = by(stability::gazeLoss, GazeScore::jumps_a_second)}};
}

/// What of a frame is scored.
Frame less(Frame frame, const Frame& without) {
  for (std::size_t i = 0; i < frame.rgba.size(); ++i) frame.rgba[i] -= without.rgba[i];
  return frame;
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

StabilityTrial::StabilityTrial(const StabilityScene& scene, float value,
                               const StabilityEffort& effort)
    : setup_(scene.setup(value)), effort_(effort) {
  assert(!scene.observe);
}

Frame StabilityTrial::draw(std::string_view method, const SurfelCloud& cloud) const {
  Frame frame;
  makeMethod(method, cloud)->render(setup_.view, setup_.settings, frame);
  return frame;
}

const std::vector<Frame>& StabilityTrial::references() {
  if (!references_.empty()) return references_;
  View view = setup_.view;
  RenderSettings settings = setup_.settings;
  for (int k = 0; k <= (setup_.step ? effort_.steps : 0); ++k) {
    if (k > 0) setup_.step(view, settings);
    if (setup_.truth) {
      references_.push_back(setup_.truth(view, settings, effort_.samples));
    } else {
      makeMethod("accumulate:" + std::to_string(effort_.samples), setup_.cloud)
          ->render(view, settings, references_.emplace_back());
    }
  }
  return references_;
}

const Frame& StabilityTrial::reference() { return references().back(); }

double StabilityTrial::popping(std::string_view method) {
  const auto tested = makeMethod(method, setup_.cloud);
  View view = setup_.view;
  RenderSettings settings = setup_.settings;
  double most = 0.0;
  tested->render(view, settings, drawn_);
  for (std::size_t k = 1; k < references().size(); ++k) {
    const Frame before = drawn_, &exact = references()[k], &exact_before = references()[k - 1];
    setup_.step(view, settings);
    tested->render(view, settings, drawn_);
    std::vector<double> extra;
    for (std::size_t i = 0; i < drawn_.rgba.size(); ++i) {
      const glm::vec3 change = glm::abs(glm::vec3(drawn_.rgba[i] - before.rgba[i]));
      const glm::vec3 own = glm::abs(glm::vec3(exact.rgba[i] - exact_before.rgba[i]));
      const glm::vec3 beyond = glm::max(change - own, glm::vec3(0.0f));
      extra.push_back(std::max({beyond.x, beyond.y, beyond.z}));
    }
    most = std::max(most, quantile(extra, 0.999));
  }
  return most;
}

double StabilityTrial::score(std::string_view method) {
  if (setup_.step) return popping(method);
  drawn_ = draw(method, setup_.cloud);
  if (setup_.without) drawn_ = less(std::move(drawn_), draw(method, *setup_.without));
  if (setup_.score) return setup_.score(drawn_);
  return std::min(psnr_dB(drawn_, reference()), kMost_dB);
}

}  // namespace foci
