#include "app/evaluation/stability/setups.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <utility>

namespace foci::stability {

namespace {

const glm::vec3 kRed{1.0f, 0.0f, 0.0f}, kGreen{0.0f, 1.0f, 0.0f};
constexpr float kWall = 0.1f;  // radiance of the wall behind a highlight

StabilitySetup scored(StabilitySetup setup, std::function<double(const Frame&)> score) {
  setup.score = std::move(score);
  return setup;
}

double sumOfRed(const Frame& frame, int from_row, int to_row) {
  double red = 0.0;
  for (int y = from_row; y < to_row; ++y) {
    for (int x = 0; x < frame.size_px.x; ++x) red += frame.at(x, y).r;
  }
  return red;
}

/// Two planes that cross.
/// @param deep_m  max depth of the slanted plane before and behind the line where the planes meet
StabilitySetup crossing(float angle_deg, float deep_m) {
  const float a = glm::radians(angle_deg);
  return sceneOf({{.centre_m = {0, 0, -1},
                   .size_m = glm::vec2(1.2f),
                   .color = textured({1, 0.6f, 0.2f}, 0.06f)},
                  {.centre_m = {0, 0, -1},
                   .size_m = {std::min(1.2f, 2.0f * deep_m / std::sin(a)), 1.2f},
                   .across = {std::cos(a), 0, std::sin(a)},
                   .color = textured({0.2f, 0.5f, 1}, 0.06f)}},
                 lens(18.0f, 0.5f));
}

/// The image of a surfel of one pixel, blurred by `radius_px`.
/// @param light_px  red over all pixels
std::function<Frame(const View&, const RenderSettings&, int)> discOf(double light_px,
                                                                     const glm::vec2& at_px,
                                                                     double radius_px) {
  return [=](const View& seen, const RenderSettings&, int) {
    const double sigma_px = std::sqrt(1.0 + kSigmaPerSpacing * kSigmaPerSpacing);
    Frame frame{.size_px = seen.size_px, .rgba = {}, .depth_m = {}};
    for (int y = 0; y < seen.size_px.y; ++y) {
      for (int x = 0; x < seen.size_px.x; ++x) {
        const double off_px = glm::distance(glm::vec2(x, y) + 0.5f, at_px);
        const double share = radius_px > 0.0
                                 ? discThroughGaussian(off_px, radius_px, sigma_px)
                                 : std::exp(-0.5 * off_px * off_px / (sigma_px * sigma_px)) /
                                       (glm::two_pi<double>() * sigma_px * sigma_px);
        frame.rgba.emplace_back(static_cast<float>(light_px * share), 0.0f, 0.0f, 0.0f);
      }
    }
    return frame;
  };
}

/// A wall with one surfel that is brighter than the others.
struct Highlight {
  StabilitySetup setup;
  double light_px;  // red over all pixels
  glm::vec2 at_px;
};

Highlight highlightOnWall(float times) {
  constexpr float kRadius_px = 10.0f;
  SurfelCloud wall;
  addSurfels(wall,
             {.centre_m = {0, 0, -1}, .size_m = glm::vec2(0.6f), .color = plain(glm::vec3(kWall))});
  SurfelCloud lit = wall;
  const std::size_t which = wall.size() / 2 + 90;
  lit.color[which].r += kWall * times;
  Highlight highlight{
      .setup = {.view = view(),
                .cloud = std::move(lit),
                .settings = lens(kRadius_px, 0.0f),
                .without = wall},
      .light_px = double{kWall} * times * wall.area_m2[which] * kFocal_px * kFocal_px,
      .at_px = project(view(), wall.position_m[which])};
  highlight.setup.truth = discOf(highlight.light_px, highlight.at_px, kRadius_px);
  return highlight;
}

}  // namespace

View view() {
  return {.size_px = glm::ivec2(kSize_px),
          .focal_px = glm::vec2(kFocal_px),
          .principal_px = glm::vec2(0.5f * kSize_px)};
}

RenderSettings lens(float radius_px_per_D, float focus_D) {
  return {.defocus = {.radius_px_per_D = glm::vec2(radius_px_per_D),
                      .focus_D = focus_D,
                      .along = DistanceAlong::axis}};
}

StabilitySetup sceneOf(const std::vector<Sheet>& sheets, const RenderSettings& settings) {
  StabilitySetup setup{.view = view(), .cloud = {}, .settings = settings};
  for (const Sheet& sheet : sheets) addSurfels(setup.cloud, sheet);
  setup.truth = [sheets](const View& seen, const RenderSettings& with, int samples) {
    return exactFrame(sheets, seen, with, samples);
  };
  return setup;
}

std::vector<Sheet> edgeSheets(float near_m, float far_m) {
  const float half_m = 0.5f * kSize_px / kFocal_px;  // half the width of the view at 1 m
  return {{.centre_m = {0, 0, -far_m},
           .size_m = glm::vec2(4.0f * half_m * far_m),
           .color = plain(kGreen)},
          {.centre_m = {-1.5f * half_m * near_m, 0, -near_m},
           .size_m = {3.0f * half_m * near_m, 5.0f * half_m * near_m},
           .color = plain(kRed)}};
}

double edgeError(const Frame& frame, double radius_px, double reach_px) {
  const double sigma_px = std::sqrt(1.0 + kSigmaPerSpacing * kSigmaPerSpacing);
  double sum = 0.0, count = 0.0;
  for (int y = kSize_px / 4; y < 3 * kSize_px / 4; ++y) {
    for (int x = 0; x < kSize_px; ++x) {
      const double off_px = 0.5 * kSize_px - (x + 0.5);
      if (std::abs(off_px) > reach_px) continue;
      const double share = edgeShare(off_px, radius_px, sigma_px);
      const glm::vec4& at = frame.at(x, y);
      sum += std::isfinite(at.r) ? std::abs(at.r - share) : 1.0;
      count += 1.0;
    }
  }
  return sum / count;
}

double coverageErrorFrom(const Frame& frame, float alpha, int border_px) {
  double sum = 0.0, count = 0.0;
  for (int y = border_px; y < kSize_px - border_px; ++y) {
    for (int x = border_px; x < kSize_px - border_px; ++x) {
      const float a = frame.at(x, y).a;
      sum += std::isfinite(a) ? std::abs(a - alpha) : 1.0;
      count += 1.0;
    }
  }
  return sum / count;
}

double edgeShare(double distance_px, double radius_px, double sigma_px) {
  const auto disc = [&](double x) {
    if (radius_px <= 0.0) return x > 0.0 ? 1.0 : x < 0.0 ? 0.0 : 0.5;
    const double t = std::clamp(x / radius_px, -1.0, 1.0);
    return (std::acos(-t) + t * std::sqrt(1.0 - t * t)) / glm::pi<double>();
  };
  if (radius_px <= 0.0) return 0.5 * std::erfc(-distance_px / (sigma_px * std::sqrt(2.0)));
  constexpr int kSteps = 48;
  double sum = 0.0, total = 0.0;
  for (int i = -kSteps; i <= kSteps; ++i) {
    const double z = 4.0 * i / kSteps;
    const double w = std::exp(-0.5 * z * z);
    sum += w * disc(distance_px - z * sigma_px);
    total += w;
  }
  return sum / total;
}

double discThroughGaussian(double distance_px, double radius_px, double sigma_px) {
  constexpr int kSteps = 200;
  const double s2 = sigma_px * sigma_px, step_px = radius_px / kSteps;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double r = (i + 0.5) * step_px, x = r * distance_px / s2;
    // exp(-x) I0(x), which does not overflow; for large x its asymptotic series (DLMF 10.40.1).
    const double bessel = x < 50.0 ? std::exp(-x) * std::cyl_bessel_i(0.0, x)
                                   : (1.0 + 0.125 / x) / std::sqrt(glm::two_pi<double>() * x);
    const double off = r - distance_px;
    sum += r * std::exp(-0.5 * off * off / s2) * bessel * step_px;
  }
  return sum / (glm::pi<double>() * radius_px * radius_px * s2);
}

namespace {

// Each function takes the value of its scene's dial.

StabilitySetup parallel(float gap_m) {
  constexpr float kNear_m = 0.5f, kBlur_px = 10.0f;
  return scored(
      sceneOf(edgeSheets(kNear_m, kNear_m + gap_m), lens(kBlur_px, 1.0f / kNear_m - 1.0f)),
      [=](const Frame& frame) { return edgeError(frame, kBlur_px, 48.0); });
}

StabilitySetup intersecting(float angle_deg) { return crossing(angle_deg, 0.15f); }
StabilitySetup intersectingDeep(float angle_deg) { return crossing(angle_deg, 0.6f); }

StabilitySetup wire(float width_px) {
  // As many surfels across as fit the width a pixel apart, at least one.
  return scored(
      sceneOf(
          {{.centre_m = {0, 0, -2}, .size_m = glm::vec2(2.0f), .color = plain(kGreen)},
           {.centre_m = {0, 0, -1}, .size_m = {width_px / kFocal_px, 1.0f}, .color = plain(kRed)}},
          lens(12.0f, 0.5f)),
      [=](const Frame& frame) {
        const double red = sumOfRed(frame, kSize_px / 4, 3 * kSize_px / 4);
        return std::abs(red / (0.5 * kSize_px) / width_px - 1.0);
      });
}

StabilitySetup sharpSilhouette(float radius_px) {
  return scored(sceneOf(edgeSheets(1.0f, 2.0f), lens(2.0f * radius_px, 1.0f)),
                [=](const Frame& frame) { return edgeError(frame, 0.0, radius_px + 4.0); });
}

StabilitySetup blurredSilhouette(float radius_px) {
  return scored(sceneOf(edgeSheets(1.0f, 2.0f), lens(2.0f * radius_px, 0.5f)),
                [=](const Frame& frame) { return edgeError(frame, radius_px, radius_px + 4.0); });
}

StabilitySetup closeUp(float distance_m) {
  constexpr float kPupil_px_per_D = 2.0f;
  return scored(
      sceneOf(edgeSheets(distance_m, 1.0f), lens(kPupil_px_per_D, 1.0f)), [=](const Frame& frame) {
        return edgeError(frame, kPupil_px_per_D * (1.0f / distance_m - 1.0f), 0.5 * kSize_px);
      });
}

StabilitySetup nearPlane(float radius_px) {
  // The near plane cuts the slanted sheet off in the middle of the image.
  constexpr float kNearest_m = 0.5f, kFocus_D = 0.5f, kTilt_rad = 1.0f;
  StabilitySetup setup =
      sceneOf({{.centre_m = {0, 0, -2}, .size_m = glm::vec2(2.0f), .color = textured(kGreen, 0.1f)},
               {.centre_m = {0, 0, -kNearest_m},
                .size_m = glm::vec2(0.6f),
                .across = {std::cos(kTilt_rad), 0, -std::sin(kTilt_rad)},
                .color = textured({1, 0.5f, 0.3f}, 0.03f)}},
              lens(radius_px / (1.0f / kNearest_m - kFocus_D), kFocus_D));
  setup.view.near_m = kNearest_m;
  return setup;
}

StabilitySetup focusRange(float focus_D) {
  std::vector<Sheet> sheets;
  const float half_m = 0.5f * kSize_px / kFocal_px;
  for (const auto& [depth_m, middle] : {std::pair(1000.0f, 0.0f), {1.0f, -0.7f}, {0.1f, 1.2f}}) {
    const float wide_m = middle == 0.0f ? 4.0f : 1.0f;
    sheets.push_back(
        {.centre_m = {middle * half_m * depth_m, 0, -depth_m},
         .size_m = glm::vec2(wide_m, 4.0f) * half_m * depth_m,
         .color = textured(glm::vec3(1.0f, 0.5f + 0.3f * middle, 0.7f), 0.1f * depth_m)});
  }
  return sceneOf(sheets, lens(2.0f, focus_D));
}

StabilitySetup pointLight(float focus_D) {
  // The sheet covers one pixel.
  constexpr float kFar_m = 1e6f, kRadiance = 100.0f, kPupil_px_per_D = 2.0f;
  StabilitySetup setup = sceneOf({{.centre_m = {0, 0, -kFar_m},
                                   .size_m = glm::vec2(kFar_m / kFocal_px),
                                   .color = plain({kRadiance, 0.0f, 0.0f})}},
                                 lens(kPupil_px_per_D, focus_D));
  setup.truth = discOf(kRadiance, view().principal_px, kPupil_px_per_D * focus_D);
  return scored(std::move(setup), [](const Frame& frame) {
    return std::abs(sumOfRed(frame, 0, kSize_px) / kRadiance - 1.0);
  });
}

StabilitySetup transparent(float layers) {
  constexpr float kOpacity = 0.3f;
  std::vector<Sheet> sheets;
  for (int k = 0; k < static_cast<int>(layers); ++k) {
    const float depth_m = 1.0f + 0.1f * static_cast<float>(k);
    sheets.push_back({.centre_m = {0, 0, -depth_m},
                      .size_m = glm::vec2(0.9f * depth_m),
                      .color = plain(kRed),
                      .opacity = kOpacity});
  }
  return scored(sceneOf(sheets, lens(8.0f, 0.0f)), [=](const Frame& frame) {
    return coverageErrorFrom(frame, 1.0f - std::pow(1.0f - kOpacity, layers), 24);
  });
}

StabilitySetup crossingLayers(float layers) {
  // The layers form a fan about the image's vertical axis.
  constexpr float kFan_deg = 120.0f;
  std::vector<Sheet> sheets;
  for (int k = 0; k < static_cast<int>(layers); ++k) {
    const float a = glm::radians(kFan_deg * ((static_cast<float>(k) + 0.5f) / layers - 0.5f));
    const glm::vec3 color(0.3f + 0.7f * static_cast<float>(k % 2), 0.6f,
                          1.0f - 0.7f * static_cast<float>(k % 2));
    sheets.push_back({.centre_m = {0, 0, -1},
                      .size_m = {0.5f, 0.6f},
                      .across = {std::cos(a), 0, std::sin(a)},
                      .color = textured(color, 0.06f),
                      .opacity = 0.5f});
  }
  return sceneOf(sheets, lens(18.0f, 0.5f));
}

StabilitySetup highlightOf(float times) {
  Highlight highlight = highlightOnWall(times);
  return scored(std::move(highlight.setup), [light_px = highlight.light_px](const Frame& frame) {
    return std::abs(sumOfRed(frame, 0, kSize_px) / light_px - 1.0);
  });
}

StabilitySetup firefly(float times) {
  Highlight highlight = highlightOnWall(times);
  const Frame truth = highlight.setup.truth(view(), highlight.setup.settings, 0);
  return scored(std::move(highlight.setup), [truth](const Frame& frame) {
    float beyond = 0.0f, peak = 0.0f;
    for (std::size_t i = 0; i < frame.rgba.size(); ++i) {
      beyond = std::max(beyond, frame.rgba[i].r - truth.rgba[i].r);
      peak = std::max(peak, truth.rgba[i].r);
    }
    return double{beyond} / peak;
  });
}

StabilitySetup slanted(float angle_deg) {
  const float a = glm::radians(angle_deg);
  return sceneOf(
      {{.centre_m = {0, 0, -1},
        .size_m = glm::vec2(0.5f, 0.6f) * glm::vec2(1.0f / std::max(std::cos(a), 0.2f), 1.0f),
        .across = {std::cos(a), 0, std::sin(a)},
        .color = textured(glm::vec3(1.0f), 0.05f)}},
      lens(40.0f, 1.0f));
}

StabilitySetup curved(float radius_m) {
  // The nearest line of the pillar is in focus.
  constexpr float kStep_m = 1.0f / kFocal_px, kWidest_rad = 1.5f;
  const auto color = textured(glm::vec3(1.0f), 0.05f);
  StabilitySetup setup{.view = view(), .cloud = {}, .settings = lens(40.0f, 1.0f)};
  const float max_rad = std::min(kWidest_rad, 0.4f / radius_m);
  for (float y = -0.3f; y < 0.3f; y += kStep_m) {
    for (float a = -max_rad; a < max_rad; a += kStep_m / radius_m) {
      const glm::vec3 normal(std::sin(a), 0.0f, std::cos(a));
      appendSurfel(setup.cloud, radius_m * normal + glm::vec3(0.0f, y, -1.0f - radius_m), normal,
                   kSigmaPerSpacing * kStep_m, kStep_m * kStep_m, color({radius_m * a, y}));
    }
  }
  return setup;
}

std::vector<Sheet> movedSheets() {
  return {
      {.centre_m = {0, 0, -2}, .size_m = glm::vec2(1.4f), .color = textured(glm::vec3(1.0f), 0.1f)},
      {.centre_m = {-0.12f, 0, -1},
       .size_m = {0.24f, 0.6f},
       .color = textured({1, 0.4f, 0.1f}, 0.05f)}};
}

StabilitySetup sweptFocus(float radius_px_per_D) {
  StabilitySetup setup = sceneOf(movedSheets(), lens(radius_px_per_D, 0.6f));
  setup.step = [](View&, RenderSettings& settings) { settings.defocus.focus_D += 0.02f; };
  return setup;
}

StabilitySetup movingEye(float px_a_frame) {
  StabilitySetup setup = sceneOf(movedSheets(), lens(20.0f, 0.5f));
  setup.step = [=](View& seen, RenderSettings&) {
    seen.eye_from_world[3].x -= px_a_frame / kFocal_px;  // pixels of things at 1 m
  };
  return setup;
}

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
      parallel, coverage(0.02));
  add("crossing", "two textured planes that cross, blurred by 9 px where they meet",
      "angle between them, deg", {85.0f, 60.0f, 45.0f, 30.0f, 15.0f, 5.0f}, intersecting,
      psnr(42.0));
  add("crossing-deep",
      "the same, but the slanted plane reaches from 0.4 to 1.6 m: blur radius up to 36 px",
      "angle between them, deg", {15.0f, 30.0f, 45.0f, 60.0f, 85.0f}, intersectingDeep, psnr(42.0));
  add("slanted", "a textured plane through the focus, slanted", "angle to the screen, deg",
      {0.0f, 30.0f, 60.0f, 75.0f, 85.0f}, slanted, psnr(35.0));
  add("curved", "a textured pillar, its nearest line in focus", "its radius, m",
      {1.0f, 0.4f, 0.2f, 0.1f, 0.05f}, curved, psnr(35.0));
  add("density", "a wall whose samples thin out from left to right", "ratio of densities",
      {1.0f, 3.0f, 10.0f, 30.0f, 100.0f}, density, coverage(0.03));
  add("patches", "a wall with holes 24 samples apart where samples are missing, blurred by 6 px",
      "width of a hole, samples", {0.0f, 2.0f, 4.0f, 8.0f, 12.0f}, patches, coverage(0.03));
  add("duplicates", "a half-plane blurred by 8 px; a third of its points occur several times",
      "copies of each such point", {1.0f, 2.0f, 4.0f, 8.0f, 16.0f}, duplicates, kClosedForm);
  add("normals", "a half-plane blurred by 8 px; its normals are wrong, each in a random direction",
      "error of the normals, deg", {0.0f, 10.0f, 20.0f, 30.0f, 45.0f, 60.0f}, misledNormals,
      kClosedForm);
  add("wire", "a wire in front of a sheet in focus, blurred by 6 px", "width, px",
      {5.0f, 2.0f, 1.0f, 0.5f, 0.2f}, wire, kLight);
  add("sharp-before-blurred", "a half-plane in focus in front of a sheet out of focus",
      "blur of the sheet, px", {1.0f, 2.0f, 4.0f, 8.0f, 16.0f}, sharpSilhouette, kClosedForm);
  add("blurred-before-sharp", "a half-plane out of focus in front of a sheet in focus",
      "blur of the half-plane, px", {1.0f, 2.0f, 4.0f, 8.0f, 16.0f}, blurredSilhouette,
      kClosedForm);
  add("close-up", "a half-plane that approaches the eye until its blur is wider than the image",
      "distance, m", {0.5f, 0.2f, 0.1f, 0.05f, 0.02f}, closeUp, kClosedForm);
  add("near-plane", "a slanted sheet, cut off by the near plane, in front of a sheet in focus",
      "blur at the cut, px", {1.0f, 4.0f, 8.0f, 16.0f, 32.0f}, nearPlane, psnr(35.0));
  add("focus", "things 0.1 m, 1 m and 1 km away", "focus, D", {1.0f, 0.0f, 3.0f, 10.0f}, focusRange,
      psnr(35.0));
  add("point-light", "a point of light 1000 km away", "focus, D", {0.0f, 0.5f, 1.0f, 3.0f, 10.0f},
      pointLight, kLight);
  add("transparent", "layers of opacity 0.3, 0.1 m apart, all out of focus", "layers",
      {1.0f, 2.0f, 4.0f, 8.0f, 16.0f}, transparent, coverage(0.02));
  add("crossing-layers", "a fan of crossing layers of opacity 0.5, blurred by 9 px", "layers",
      {1.0f, 2.0f, 3.0f, 4.0f, 6.0f}, crossingLayers, psnr(35.0));
  add("highlight", "one bright surfel on a wall blurred by 10 px", "times as bright as the wall",
      {1.0f, 10.0f, 100.0f, 1000.0f, 10000.0f}, highlightOf, kLight);
  add("firefly", "the same: the pixel with the largest excess", "times as bright as the wall",
      {1.0f, 10.0f, 100.0f, 1000.0f, 10000.0f}, firefly,
      {"excess, relative to the blurred highlight", 0.3});
  add("focus-sweep", "the focus moves by 0.02 D a frame over two textured sheets",
      "blur, px a dioptre", {5.0f, 10.0f, 20.0f, 40.0f}, sweptFocus, change(0.005));
  add("moving-eye", "the eye moves past two textured sheets; the far one is in focus",
      "speed of the near sheet, px a frame", {0.1f, 0.3f, 1.0f, 3.0f}, movingEye, change(0.02));
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
                        .observers = kObservers,
                        .observe = [observe, by](std::size_t observer, float value) {
                          return observe(observer, value, by);
                        }});
    };
    addScored("", "share of the time with wrong focus", 0.02, GazeScore::wrong_share);
    addScored("-jumps", "excess jumps of focus a second", 0.2, GazeScore::jumps_a_second);
  };
  add("gaze-noise", "a steady gaze 0.5 to 1.5 deg from an edge between surfaces at 0.5 and 2 m",
      "noise of a sample, deg", {0.1f, 0.3f, 0.5f, 1.0f, 2.0f}, gazeNoise);
  add("gaze-loss",
      "a gaze that jumps across an edge between surfaces at 0.5 and 2 m, noise 0.3 deg",
      "data loss, %", {0.0f, 10.0f, 20.0f, 40.0f, 60.0f}, gazeLoss);
}

}  // namespace
}  // namespace foci::stability

namespace foci {

const std::vector<StabilityScene>& stabilityScenes() {
  static const std::vector<StabilityScene> scenes = [] {
    std::vector<StabilityScene> all;
    stability::addRendered(all);
    stability::addGazes(all);
    return all;
  }();
  return scenes;
}

}  // namespace foci
