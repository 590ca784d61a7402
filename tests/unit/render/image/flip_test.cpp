#include "render/image/flip.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/image/metrics.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kPx_per_deg = 40.0;
constexpr float kFloatSums = 1e-4f;  // kernels in single precision

Frame flat(const glm::vec3& rgb) {
  Frame frame;
  frame.resize({24, 16});
  frame.rgba.assign(frame.rgba.size(), glm::vec4(rgb, 1.0f));
  return frame;
}

/// Black left of a column, white from it on.
Frame step(int column) {
  Frame frame = flat(glm::vec3(0.0f));
  for (std::size_t i = 0; i < frame.rgba.size(); ++i) {
    if (static_cast<int>(i % 24) >= column) frame.rgba[i] = glm::vec4(1.0f);
  }
  return frame;
}

/// The paper's difference of two colours, without its scale.
double apart(const glm::vec3& a, const glm::vec3& b) {
  const auto hunt = [](const glm::vec3& rgb) {
    const glm::vec3 lab = labOf(rgb);
    return glm::vec3(lab.x, 0.01f * lab.x * lab.y, 0.01f * lab.x * lab.z);
  };
  const glm::vec3 d = hunt(a) - hunt(b);
  return std::pow(std::abs(d.x) + std::hypot(d.y, d.z), 0.7);
}

TEST(Flip, IsZeroForEqualFramesAndTheSameBothWays) {
  for (const float one : flipOf(step(9), step(9), kPx_per_deg)) EXPECT_EQ(one, 0.0f);
  EXPECT_EQ(flipOf(step(9), step(14), kPx_per_deg), flipOf(step(14), step(9), kPx_per_deg));
}

TEST(Flip, OfEvenFramesIsTheColoursDifferenceOnTheScaleFromZeroToGreenAgainstBlue) {
  const glm::vec3 black(0.0f), white(1.0f), green(0, 1, 0), blue(0, 0, 1), grey(0.2f);
  const double largest = apart(green, blue), most = 0.4 * largest;
  EXPECT_NEAR(largest, 41.277, 0.02);  // of the authors' program
  const auto at = [](const glm::vec3& a, const glm::vec3& b) {
    return flipOf(flat(a), flat(b), kPx_per_deg)[100];
  };
  EXPECT_NEAR(at(green, blue), 1.0f, kFloatSums);
  const double dark = apart(black, white);  // L* of 100 apart
  EXPECT_NEAR(dark, std::pow(100.0, 0.7), 1e-3);
  EXPECT_NEAR(at(black, white), 0.95 + 0.05 * (dark - most) / (largest - most), kFloatSums);
  EXPECT_NEAR(at(grey, {0.25f, 0.2f, 0.15f}), 0.95 / most * apart(grey, {0.25f, 0.2f, 0.15f}),
              kFloatSums);
  EXPECT_NEAR(at(glm::vec3(3.0f), white), 0.0f, kFloatSums);  // a display shows no more than white
}

// Beside a step the edge has the strength 1, so colour counts to the power of 1 - sqrt(1 / sqrt 2).
TEST(Flip, CountsColourMoreWhereOneFrameHasAnEdge) {
  const Frame even = flat(glm::vec3(0.5f));
  const std::vector<float> flip = flipOf(step(12), even, kPx_per_deg);
  const double color = 0.95 / (0.4 * apart({0, 1, 0}, {0, 0, 1}));
  const std::size_t beside = 8 * 24 + 12, far = 8 * 24 + 23;
  EXPECT_NEAR(flip[far], color * apart(glm::vec3(1.0f), glm::vec3(0.5f)), kFloatSums);
  EXPECT_GT(flip[beside], 1.5f * flip[far]);
  // The same frames from twice as near: the edge is as strong, and reaches twice as far.
  EXPECT_GT(flipOf(step(12), even, 2.0 * kPx_per_deg)[beside + 4], flip[beside + 4]);
}

TEST(Flip, ForgivesAPatternThatTheEyeDoesNotResolve) {
  Frame checks = flat(glm::vec3(0.5f));
  for (std::size_t i = 0; i < checks.rgba.size(); ++i) {
    checks.rgba[i] = glm::vec4(glm::vec3((i % 24 + i / 24) % 2 == 0 ? 0.45f : 0.55f), 1.0f);
  }
  const std::size_t middle = 8 * 24 + 12;
  const Frame even = flat(glm::vec3(0.5f));
  EXPECT_LT(flipOf(checks, even, 4.0 * kPx_per_deg)[middle], 0.02f);
  EXPECT_GT(flipOf(checks, even, 10.0)[middle], 0.1f);
}

}  // namespace FOCI_FILE
}  // namespace foci
