#include "render/image/flip.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "base/parallel.h"
#include "render/image/metrics.h"

namespace foci {
namespace {

// Section 4.1 and its Table 1: the eye's contrast sensitivity as a sum of Gaussians of the offset x
// in degrees, a sqrt(pi / b) exp(-pi^2 x^2 / b), for luminance, red-green and blue-yellow.
struct Sensitivity {
  double a, b;
};
constexpr std::array<Sensitivity, 4> kSensitivities = {
    {{1.0, 0.0047}, {1.0, 0.0053}, {34.1, 0.04}, {13.5, 0.025}}};  // the last two are summed
// Sections 4.1.3 and 4.2: colours differ by |difference|^0.7, and 0.4 of the largest difference
// takes 0.95 of the scale; edges and points are 0.082 degrees wide and count by their root.
constexpr float kColorPower = 0.7f, kMostColor = 0.4f, kMostScale = 0.95f, kFeaturePower = 0.5f;
constexpr double kFeature_deg = 0.082;

using Planes4 = std::vector<glm::vec4>;

/// The weight of a kernel at an offset from its middle.
template <class Kernel>
auto& weightAt(Kernel& kernel, int offset) {
  const int index = static_cast<int>(kernel.size()) / 2 + offset;
  return kernel[static_cast<std::size_t>(index)];
}

/// Convolves rows and columns, each channel with its own kernels from -reach to reach. The edge
/// goes on beyond it.
Planes4 convolved(const Planes4& pixels, const glm::ivec2& size_px, const Planes4& along_x,
                  const Planes4& along_y) {
  const auto pass = [&](const Planes4& from, const Planes4& kernel, const glm::ivec2& step) {
    const int reach = static_cast<int>(kernel.size()) / 2;
    Planes4 to(from.size(), glm::vec4(0.0f));
    parallelFor(static_cast<std::size_t>(size_px.y), [&](std::size_t row) {
      for (int x = 0; x < size_px.x; ++x) {
        glm::vec4& sum =
            to[row * static_cast<std::size_t>(size_px.x) + static_cast<std::size_t>(x)];
        for (int k = -reach; k <= reach; ++k) {
          const int column = std::clamp(x + k * step.x, 0, size_px.x - 1);
          const int line = std::clamp(static_cast<int>(row) + k * step.y, 0, size_px.y - 1);
          sum += weightAt(kernel, k) * from[static_cast<std::size_t>(line) * size_px.x + column];
        }
      }
    });
    return to;
  };
  return pass(pass(pixels, along_x, {1, 0}), along_y, {0, 1});
}

/// Divides each channel of a kernel by the sum of its positive weights, negative ones by theirs.
void normalise(Planes4& kernel) {
  glm::vec4 above(0.0f), below(0.0f);
  for (const glm::vec4& weight : kernel) {
    above += glm::max(weight, 0.0f);
    below -= glm::min(weight, 0.0f);
  }
  below = glm::max(below, glm::vec4(1e-20f));  // a Gaussian has none
  for (glm::vec4& weight : kernel) {
    weight = glm::max(weight, 0.0f) / above + glm::min(weight, 0.0f) / below;
  }
}

/// Linear XYZ over the white's, of light clamped to the display's; alpha is left out.
Planes4 xyzOf(const Frame& frame) {
  Planes4 xyz(frame.rgba.size());
  for (std::size_t i = 0; i < xyz.size(); ++i) {
    xyz[i] = glm::vec4(kXyzOfWhite * glm::clamp(glm::vec3(frame.rgba[i]), 0.0f, 1.0f), 0.0f);
  }
  return xyz;
}

/// L*a*b* with less colour where it is dark (Hunt's effect).
glm::vec3 huntLabOf(const glm::vec3& rgb) {
  const glm::vec3 lab = labOf(rgb);
  return {lab.x, 0.01f * lab.x * lab.y, 0.01f * lab.x * lab.z};
}

/// HyAB (Abasi, Amani Tehran and Fairchild 2019) to the power of the paper.
float colorDifference(const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 d = a - b;
  return std::pow(std::abs(d.x) + std::hypot(d.y, d.z), kColorPower);
}

/// Colours as the eye resolves them, in Hunt's L*a*b*.
std::vector<glm::vec3> colorsOf(const Planes4& xyz, const glm::ivec2& size_px, double px_per_deg) {
  const double widest = std::max_element(kSensitivities.begin(), kSensitivities.end(),
                                         [](const auto& p, const auto& q) { return p.b < q.b; })
                            ->b;
  const double pi = glm::pi<double>();
  const int reach =
      static_cast<int>(std::ceil(3.0 * std::sqrt(widest / (2.0 * pi * pi)) * px_per_deg));
  Planes4 kernel(static_cast<std::size_t>(2 * reach + 1));
  glm::dvec4 sums(0.0);
  for (int k = -reach; k <= reach; ++k) {
    const double x_deg = k / px_per_deg;
    for (int c = 0; c < 4; ++c) {
      const double weight =
          std::exp(-pi * pi * x_deg * x_deg / kSensitivities[static_cast<std::size_t>(c)].b);
      weightAt(kernel, k)[c] = static_cast<float>(weight);
      sums[c] += weight;
    }
  }
  normalise(kernel);
  const auto volume = [&](int c) {
    const Sensitivity& one = kSensitivities[static_cast<std::size_t>(c)];
    return one.a * std::sqrt(pi / one.b) * sums[c] * sums[c];
  };
  const auto wide = static_cast<float>(volume(2) / (volume(2) + volume(3)));

  // Opponent colours are linear: Y, X - Y, and Y - Z twice.
  Planes4 opponent(xyz.size());
  for (std::size_t i = 0; i < xyz.size(); ++i) {
    const glm::vec4& p = xyz[i];
    opponent[i] = {p.y, p.x - p.y, p.y - p.z, p.y - p.z};
  }
  opponent = convolved(opponent, size_px, kernel, kernel);
  const glm::mat3 rgbOfXyz = glm::inverse(kXyzOfWhite);
  std::vector<glm::vec3> colors(xyz.size());
  parallelFor(colors.size(), [&](std::size_t i) {
    const glm::vec4& p = opponent[i];
    const glm::vec3 seen(p.x + p.y, p.x, p.x - glm::mix(p.w, p.z, wide));
    colors[i] = huntLabOf(glm::clamp(rgbOfXyz * seen, 0.0f, 1.0f));
  });
  return colors;
}

/// Strengths of edges and points of the luminance: first and second derivatives of a Gaussian.
std::vector<glm::vec2> featuresOf(const Planes4& xyz, const glm::ivec2& size_px,
                                  double px_per_deg) {
  const double sigma_px = 0.5 * kFeature_deg * px_per_deg;
  const int reach = static_cast<int>(std::ceil(3.0 * sigma_px));
  Planes4 along_x(static_cast<std::size_t>(2 * reach + 1)), along_y = along_x;
  for (int k = -reach; k <= reach; ++k) {
    const double x = k / sigma_px, gaussian = std::exp(-0.5 * x * x);
    const auto edge = static_cast<float>(-x * gaussian), flat = static_cast<float>(gaussian);
    const auto point = static_cast<float>((x * x - 1.0) * gaussian);
    weightAt(along_x, k) = {edge, flat, point, flat};
    weightAt(along_y, k) = {flat, edge, flat, point};
  }
  normalise(along_x);
  normalise(along_y);
  Planes4 luminance(xyz.size());
  for (std::size_t i = 0; i < xyz.size(); ++i) luminance[i] = glm::vec4(xyz[i].y);
  std::vector<glm::vec2> features(xyz.size());
  std::ranges::transform(
      convolved(luminance, size_px, along_x, along_y), features.begin(),
      [](const glm::vec4& p) { return glm::vec2(std::hypot(p.x, p.y), std::hypot(p.z, p.w)); });
  return features;
}

}  // namespace

std::vector<float> flipOf(const Frame& a, const Frame& b, double px_per_deg) {
  assert(a.size_px == b.size_px && px_per_deg > 0.0);
  const glm::ivec2& size_px = a.size_px;
  const Planes4 xyz_a = xyzOf(a), xyz_b = xyzOf(b);
  const auto colors_a = colorsOf(xyz_a, size_px, px_per_deg);
  const auto colors_b = colorsOf(xyz_b, size_px, px_per_deg);
  const auto features_a = featuresOf(xyz_a, size_px, px_per_deg);
  const auto features_b = featuresOf(xyz_b, size_px, px_per_deg);
  const float largest =
      colorDifference(huntLabOf({0.0f, 1.0f, 0.0f}), huntLabOf({0.0f, 0.0f, 1.0f}));
  const float most = kMostColor * largest;
  std::vector<float> flip(colors_a.size());
  parallelFor(flip.size(), [&](std::size_t i) {
    const float apart = colorDifference(colors_a[i], colors_b[i]);
    const float color = apart < most
                            ? kMostScale / most * apart
                            : kMostScale + (apart - most) / (largest - most) * (1.0f - kMostScale);
    const glm::vec2 d = glm::abs(features_a[i] - features_b[i]);
    const float feature =
        std::min(std::pow(std::max(d.x, d.y) / glm::root_two<float>(), kFeaturePower), 1.0f);
    flip[i] = std::pow(color, 1.0f - feature);
  });
  return flip;
}

}  // namespace foci
