// Points on the lens.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <vector>

namespace foci {

/// Sample `i` of `n` on the unit disc, stratified: Vogel's spiral, equal areas at the golden angle.
/// Every other one is again stratified.
inline glm::vec2 lensSample(int i, int n) {
  const double golden_angle_rad = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double radius = std::sqrt((i + 0.5) / n), angle_rad = i * golden_angle_rad;
  return {static_cast<float>(radius * std::cos(angle_rad)),
          static_cast<float>(radius * std::sin(angle_rad))};
}

/// The same for one pixel of many, so that neighbours err independently: radii systematic in area
/// from a random `shift`, the whole turned by a random `turn`, both 0 to 1. A mean over
/// them is then unbiased whatever n, one over the even or the odd ones alone too.
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

/// Centres of `n` parts of the unit disc. Their mean is its centre and their variance its own, 1/4
/// along every axis, exactly: few as they are, the average of their views is neither moved nor
/// wider.
inline std::vector<glm::vec2> lensParts(int n) {
  std::vector<glm::vec2> parts;
  glm::vec2 mean(0.0f);
  for (int i = 0; i < n; ++i) {
    // Seven lie best as one and six.
    parts.push_back(n == 7 ? (i == 0 ? glm::vec2(0.0f) : ring(i - 1, 6)) : lensSample(i, n));
    mean += parts.back() / static_cast<float>(n);
  }
  float xx = 0.0f, xy = 0.0f, yy = 0.0f;
  for (glm::vec2& part : parts) {
    part -= mean;
    xx += part.x * part.x / static_cast<float>(n);
    xy += part.x * part.y / static_cast<float>(n);
    yy += part.y * part.y / static_cast<float>(n);
  }
  if (n < 3) return parts;
  // Cholesky: L L' the variance; L^-1 makes it 1, half of that 1/4.
  const float lx = std::sqrt(xx), l = xy / lx, ly = std::sqrt(yy - l * l);
  for (glm::vec2& part : parts) {
    const float x = part.x / lx;
    part = 0.5f * glm::vec2(x, (part.y - l * x) / ly);
  }
  return parts;
}

}  // namespace foci
