#include "app/prepare/fidelity.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <numbers>
#include <tuple>
#include <utility>

#include "app/graphics/image.h"
#include "base/text.h"
#include "render/image/srgb.h"
#include "render/methods/method.h"
#include "render/scene/mesh/sample_mesh.h"

#ifdef FOCI_RAYTRACE
#include "render/literature/raytrace/triangle_view.h"
#endif

namespace foci {
namespace {

constexpr double kRadiiAway = 5.0;  // about as far as the framing of a scene without a study
const double kHalfWidth = std::tan(std::asin(1.0 / kRadiiAway));  // of the sphere, at distance 1
constexpr int kMargin_px = 6;  // twice the reach of the pixel filter

#ifdef FOCI_RAYTRACE

constexpr int kTile_px = 88;         // eight fill the page's width
constexpr float kTileLight = 0.35f;  // of the object, so that leaks stand out

/// Differences of code values, summed over R, G and B.
using ColorErrors = std::array<std::size_t, 3 * 255 + 1>;

/// What `Fidelity` is made of, summed over pixels.
struct FidelitySums {
  std::size_t interior = 0, leaking = 0;
  float largest_leak = 0.0f;
  ColorErrors color{};
  double apart = 0.0, farther = 0.0, length_px = 0.0;  // of outlines

  void add(const FidelitySums& other) {
    interior += other.interior;
    leaking += other.leaking;
    largest_leak = std::max(largest_leak, other.largest_leak);
    for (std::size_t i = 0; i < color.size(); ++i) color[i] += other.color[i];
    apart += other.apart;
    farther += other.farther;
    length_px += other.length_px;
  }

  Fidelity figures() const {
    Fidelity figures{.interior = interior, .leaking = leaking, .largest_leak = largest_leak};
    if (interior > 0) {
      double sum = 0.0;
      std::size_t below = 0, at = 0;
      for (std::size_t i = 0; i < color.size(); ++i) {
        sum += static_cast<double>(i * color[i]);
        if (below <= static_cast<std::size_t>(0.99 * static_cast<double>(interior - 1))) at = i;
        below += color[i];
      }
      figures.color_mean = sum / 3.0 / static_cast<double>(interior);
      figures.color_99 = static_cast<double>(at) / 3.0;
    }
    if (length_px >= 1.0) {
      figures.outline_px = apart / length_px;
      figures.outline_shift_px = farther / length_px;
    }
    return figures;
  }
};

Frame beforeWhite(const Frame& black) {
  Frame white = black;
  for (glm::vec4& rgba : white.rgba) rgba += glm::vec4(glm::vec3(1.0f - rgba.a), 0.0f);
  return white;
}

int codesApart(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b,
               std::size_t pixel) {
  int sum = 0;
  for (std::size_t i = 3 * pixel; i < 3 * pixel + 3; ++i) sum += std::abs(a[i] - b[i]);
  return sum;
}

/// @param surfels  before black; the coverage gives the image before white, which differs from it
///                 by (1 - coverage) white
FidelitySums sumsOf(const TriangleView& truth, const Frame& surfels) {
  FidelitySums sums;
  const auto expected = codesOf(truth.frame);  // opaque in the interior: alike before white
  const auto before_black = codesOf(surfels), before_white = codesOf(beforeWhite(surfels));
  for (std::size_t p = 0; p < surfels.rgba.size(); ++p) {
    if (truth.interior[p] != 0) {
      const float leak = 1.0f - surfels.rgba[p].a;
      ++sums.interior;
      if (leak > kLeak) ++sums.leaking;
      sums.largest_leak = std::max(sums.largest_leak, leak);
      ++sums.color[static_cast<std::size_t>(
          std::max(codesApart(before_black, expected, p), codesApart(before_white, expected, p)))];
    } else if (truth.outline[p] != 0) {
      const double farther = double{surfels.rgba[p].a} - truth.frame.rgba[p].a;
      sums.apart += std::abs(farther);
      sums.farther += farther;
    }
  }
  sums.length_px = outlineLength_px(truth.frame, truth.outline);
  return sums;
}

/// The object in grey, and the largest leak of each pixel's surroundings in colour.
Image tileOf(const TriangleView& truth, const Frame& surfels) {
  Frame grey = truth.frame;
  for (glm::vec4& rgba : grey.rgba) {
    const float light = 0.2126f * rgba.r + 0.7152f * rgba.g + 0.0722f * rgba.b;
    rgba = glm::vec4(glm::vec3(kTileLight * (0.1f * rgba.a + 0.9f * light)), 1.0f);
  }
  Image tile = thumbnail(imageOf(grey), kTile_px);
  std::vector<float> leaks(static_cast<std::size_t>(kTile_px) * tile.size_px.y, 0.0f);
  const int side = surfels.size_px.x;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      if (truth.interior[static_cast<std::size_t>(y) * side + x] == 0) continue;
      float& leak =
          leaks[static_cast<std::size_t>(y * kTile_px / side) * kTile_px + x * kTile_px / side];
      leak = std::max(leak, 1.0f - surfels.at(x, y).a);
    }
  }
  for (std::size_t i = 0; i < leaks.size(); ++i) {
    if (leaks[i] <= kLeak) continue;
    const auto color = leakColor(leaks[i]);
    std::ranges::copy(color, tile.rgb.begin() + static_cast<std::ptrdiff_t>(3 * i));
  }
  return tile;
}

/// The larger of the differences before black and before white.
Image differenceImage(const Frame& triangles, const Frame& surfels) {
  Frame difference = triangles;
  for (std::size_t p = 0; p < difference.rgba.size(); ++p) {
    const glm::vec4 apart = surfels.rgba[p] - triangles.rgba[p];
    const glm::vec3 black(apart);
    const glm::vec3 larger = glm::max(glm::abs(black), glm::abs(black - glm::vec3(apart.a)));
    difference.rgba[p] = glm::vec4(kDifferenceGain * larger, 1.0f);
  }
  return imageOf(difference);
}

#endif  // FOCI_RAYTRACE

}  // namespace

BoundingSphere boundingSphereOf(const TriangleMesh& mesh) {
  glm::vec3 low = mesh.corners_m.front(), high = low;
  for (const glm::vec3& corner : mesh.corners_m) {
    low = glm::min(low, corner);
    high = glm::max(high, corner);
  }
  BoundingSphere sphere{.middle_m = 0.5f * (low + high)};
  for (const glm::vec3& corner : mesh.corners_m) {
    sphere.radius_m = std::max(sphere.radius_m, double{glm::distance(corner, sphere.middle_m)});
  }
  return sphere;
}

std::vector<glm::vec3> pointsOverSurface(const TriangleMesh& mesh, std::size_t count) {
  std::vector<double> up_to_m2(mesh.size());
  double sum_m2 = 0.0;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const glm::dvec3 a = mesh.corners_m[3 * i], b = mesh.corners_m[3 * i + 1],
                     c = mesh.corners_m[3 * i + 2];
    up_to_m2[i] = sum_m2 += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  std::vector<glm::vec3> points_m;
  points_m.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    // Multiples of the golden ratio, modulo 1, are spread evenly however many there are.
    const double share = std::fmod(static_cast<double>(i) * std::numbers::phi, 1.0);
    const auto found = std::upper_bound(up_to_m2.begin(), up_to_m2.end(), share * sum_m2);
    const auto triangle =
        static_cast<std::size_t>(std::min(found, std::prev(up_to_m2.end())) - up_to_m2.begin());
    const glm::vec3* corners_m = &mesh.corners_m[3 * triangle];
    points_m.push_back((corners_m[0] + corners_m[1] + corners_m[2]) / 3.0f);
  }
  return points_m;
}

std::vector<glm::vec3> directionsOverSphere(std::size_t count) {
  std::vector<glm::vec3> directions;
  directions.reserve(count);
  const double turn_rad = std::numbers::pi * (3.0 - std::sqrt(5.0));  // the golden angle
  for (std::size_t i = 0; i < count; ++i) {
    const double y = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(count);
    const double ring = std::sqrt(1.0 - y * y), angle_rad = turn_rad * static_cast<double>(i);
    directions.emplace_back(ring * std::sin(angle_rad), y, ring * std::cos(angle_rad));
  }
  return directions;
}

View viewFromOutside(const BoundingSphere& sphere, const glm::vec3& towards,
                     const glm::vec3& target_m) {
  const double distance_m = kRadiiAway * sphere.radius_m;
  constexpr int kWhole_px = kObject_px + 2 * kMargin_px;
  const glm::vec3 eye_m = sphere.middle_m + static_cast<float>(distance_m) * towards;
  View view{.eye_from_world = eyeFromWorld(eye_m, sphere.middle_m, {0.0f, 1.0f, 0.0f}),
            .size_px = glm::ivec2(kFidelity_px),
            .focal_px = glm::vec2(static_cast<float>(0.5 * kObject_px / kHalfWidth)),
            .principal_px = glm::vec2(0.5f * kWhole_px),
            .near_m = static_cast<float>(0.5 * distance_m)};
  const glm::vec2 target_px =
      project(view, glm::vec3(view.eye_from_world * glm::vec4(target_m, 1.0f)));
  view.principal_px -= glm::clamp(glm::floor(target_px - 0.5f * kFidelity_px), 0.0f,
                                  1.0f * (kWhole_px - kFidelity_px));
  return view;
}

#ifdef FOCI_RAYTRACE
Fidelity fidelityOf(const TriangleView& truth, const Frame& surfels) {
  return sumsOf(truth, surfels).figures();
}
#endif

std::optional<FidelityReport> measureFidelity(const SurfelCloud& cloud, const TriangleMesh& mesh,
                                              double spacing_m, std::size_t views) {
#ifdef FOCI_RAYTRACE
  const auto start = std::chrono::steady_clock::now();
  FidelityReport report{.spacing_m = spacing_m};
  const MeshRays rays(mesh);
  const auto method = makeMethod("pinhole", cloud);
  FidelitySums all;
  std::size_t transparent = 0, covered = 0;
  Frame surfels, worst_triangles, worst_surfels;
  const auto badness = [](const Fidelity& of) {
    return std::tuple(of.leakShare(), of.largest_leak, of.color_99.value_or(0.0));
  };
  const BoundingSphere sphere = boundingSphereOf(mesh);
  const std::vector<glm::vec3> targets_m = pointsOverSurface(mesh, views);
  for (const glm::vec3& towards : directionsOverSphere(views)) {
    const View view = viewFromOutside(sphere, towards, targets_m[report.views.size()]);
    report.pixel_m = kRadiiAway * sphere.radius_m / view.focal_px.x;
    TriangleView truth = triangleView(rays, view);
    method->render(view, {}, surfels);
    const FidelitySums sums = sumsOf(truth, surfels);
    all.add(sums);
    transparent += truth.transparent;
    covered += sums.interior + truth.transparent;
    report.views.push_back(
        {.towards = towards, .figures = sums.figures(), .tile = tileOf(truth, surfels)});
    if (report.views.size() == 1 ||
        badness(report.views.back().figures) > badness(report.views[report.worst].figures)) {
      report.worst = report.views.size() - 1;
      worst_triangles = std::move(truth.frame);
      worst_surfels = surfels;
    }
  }
  report.all = all.figures();
  report.transparent_share =
      static_cast<double>(transparent) / static_cast<double>(std::max<std::size_t>(covered, 1));
  report.triangles = imageOf(beforeWhite(worst_triangles));
  report.surfels = imageOf(beforeWhite(worst_surfels));
  report.difference = differenceImage(worst_triangles, worst_surfels);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
#else
  static_cast<void>(cloud), static_cast<void>(mesh), static_cast<void>(spacing_m),
      static_cast<void>(views);
  return std::nullopt;
#endif
}

std::array<std::uint8_t, 3> leakColor(float leak) {
  // Inferno (van der Walt and Smith 2015) at 1/4, 1/2, 3/4 and 1.
  constexpr float kStops[][3] = {{87, 16, 110}, {188, 55, 84}, {249, 142, 9}, {252, 255, 164}};
  const float at = 3.0f * std::clamp((leak - kLeak) / (kWorstLeak - kLeak), 0.0f, 1.0f);
  const int low = std::min(static_cast<int>(at), 2);
  const float share = at - static_cast<float>(low);
  std::array<std::uint8_t, 3> color{};
  for (std::size_t i = 0; i < 3; ++i) {
    color[i] = static_cast<std::uint8_t>(
        std::lround(kStops[low][i] + share * (kStops[low + 1][i] - kStops[low][i])));
  }
  return color;
}

namespace {

constexpr double kMostPoints = 1e8;      // what --points takes
constexpr double kEnough = 0.5;          // of `defaultPoints`: the spacing is 1.4 times wider
constexpr double kFinestSpacings = 2.0;  // width of a pixel from which finer surfels add nothing

/// Two significant digits, rounded up.
std::string roundNumber(double points) {
  const double step = std::pow(10.0, std::floor(std::log10(points)) - 1.0);
  return decimal(std::min(std::ceil(points / step) * step, kMostPoints), 0);
}

std::string pointsAdvice(const FidelityReport& report, double surfels, double wanted) {
  if (surfels < kEnough * wanted) return "set --points " + roundNumber(wanted);
  if (report.pixelSpacings() < kFinestSpacings) return "try --points " + roundNumber(4.0 * surfels);
  return "more points will hardly help: the surfels are finer than the screen's pixels";
}

}  // namespace

std::vector<std::string> fidelityWarnings(const FidelityReport& report, std::size_t surfels,
                                          const TriangleMesh& mesh) {
  std::vector<std::string> warnings;
  const Fidelity& all = report.all;
  const auto wanted = static_cast<double>(defaultPoints(mesh)), have = static_cast<double>(surfels);
  if (all.leakShare() > kMaxLeakShare || all.largest_leak > kWorstLeak) {
    warnings.push_back(decimal(100.0 * all.leakShare(), 3) +
                       " % of the surface shows what is behind it, at worst " +
                       decimal(100.0 * all.largest_leak, 0) + " % of its light (goal: at most " +
                       decimal(100.0 * kMaxLeakShare, 2) + " %, and " +
                       decimal(100.0 * kWorstLeak, 0) + " %); " +
                       pointsAdvice(report, have, wanted));
  }
  if (all.color_99.value_or(0.0) > kMaxColor99 && have < kEnough * wanted) {
    warnings.push_back("colours are off by more than " + decimal(*all.color_99, 0) +
                       " of 255 on 1 % of the surface: their detail is finer than the surfels; " +
                       pointsAdvice(report, have, wanted));
  }
  return warnings;
}

}  // namespace foci
