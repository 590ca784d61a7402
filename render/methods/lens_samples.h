// Points and sub-apertures of the lens, on the unit disc.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <vector>

namespace foci {

/// Sample `i` of `n` on the unit disc, stratified: equal areas, each at the golden angle from the
/// one before (Vogel, A Better Way to Construct the Sunflower Head, Mathematical Biosciences 44,
/// 1979). The even samples alone are stratified too, and so are the odd ones.
inline glm::vec2 lensSample(int i, int n) {
  const double golden_angle_rad = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double radius = std::sqrt((i + 0.5) / n), angle_rad = i * golden_angle_rad;
  return {static_cast<float>(radius * std::cos(angle_rad)),
          static_cast<float>(radius * std::sin(angle_rad))};
}

/// Sample `i` of `n` for one pixel, so that neighbouring pixels err independently. The samples are
/// systematic in area from a random `shift` on, and rotated by a random `turn`; both are 0 to 1.
/// The mean over the samples is then unbiased for every n. So is the mean over the even samples,
/// and over the odd ones.
inline glm::vec2 lensSampleOfPixel(int i, int n, float shift, float turn) {
  const int half = (n + 1 - i % 2) / 2;  // as many have the parity of i
  const double offset = shift + 0.5 * (i % 2);
  const double radius = std::sqrt((i / 2 + offset - std::floor(offset)) / half);
  const double golden_angle_rad = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double angle_rad = 2.0 * std::numbers::pi * turn + i * golden_angle_rad;
  return {static_cast<float>(radius * std::cos(angle_rad)),
          static_cast<float>(radius * std::sin(angle_rad))};
}

/// Point `i` of `n` on the unit circle.
inline glm::vec2 ring(int i, int n) {
  const double angle_rad = 2.0 * std::numbers::pi * i / n;
  return {static_cast<float>(std::cos(angle_rad)), static_cast<float>(std::sin(angle_rad))};
}

/// Centres of `n` sub-apertures of the unit disc. Their mean is exactly the disc's centre. Their
/// variance is exactly the disc's, 1/4 along every axis (from n = 3 on). So the average of the
/// sub-apertures' views is neither shifted nor wider than the view through the full aperture.
inline std::vector<glm::vec2> subApertureCentres(int n) {
  std::vector<glm::vec2> centres;
  glm::vec2 mean(0.0f);
  for (int i = 0; i < n; ++i) {
    // The densest packing of seven equal discs in a disc: one in the middle and six around it.
    centres.push_back(n == 7 ? (i == 0 ? glm::vec2(0.0f) : ring(i - 1, 6)) : lensSample(i, n));
    mean += centres.back() / static_cast<float>(n);
  }
  float xx = 0.0f, xy = 0.0f, yy = 0.0f;
  for (glm::vec2& each : centres) {
    each -= mean;
    xx += each.x * each.x / static_cast<float>(n);
    xy += each.x * each.y / static_cast<float>(n);
    yy += each.y * each.y / static_cast<float>(n);
  }
  if (n < 3) return centres;
  // Cholesky, variance = L L': L^-1 makes the variance 1, and half of each centre makes it 1/4.
  const float lx = std::sqrt(xx), l = xy / lx, ly = std::sqrt(yy - l * l);
  for (glm::vec2& each : centres) {
    const float x = each.x / lx;
    each = 0.5f * glm::vec2(x, (each.y - l * x) / ly);
  }
  return centres;
}

}  // namespace foci
