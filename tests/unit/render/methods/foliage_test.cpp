// Leaves at many depths in front of a wall in focus: the known failure of `sweep` and, with too few
// sub-apertures, of `sweep-lod`. Each leaf covers another area of the lens, so one straight edge
// does not describe the open part.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "render/image/metrics.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace FOCI_FILE {

class Foliage : public testing::Test {
 protected:
  Foliage() {
    std::mt19937 random(11);
    const auto uniform = [&](float a, float b) {
      return a + (b - a) * static_cast<float>(random() >> 8) / static_cast<float>(1 << 24);
    };
    addSheetOf(cloud_, {.center_m = {0.0f, 0.0f, -2.0f},
                        .side_m = 1.2f,
                        .samples = 80,
                        .color = {0.9f, 0.9f, 0.8f}});
    for (int leaf = 0; leaf < 150; ++leaf) {
      const float depth_m = uniform(0.6f, 1.2f);
      addSheetOf(cloud_, {.center_m = {uniform(-0.25f, 0.25f) * depth_m,
                                       uniform(-0.25f, 0.25f) * depth_m, -depth_m},
                          .side_m = 0.03f,
                          .samples = 10,
                          .color = {0.1f, uniform(0.2f, 0.7f), uniform(0.0f, 0.2f)}});
    }
  }

  /// The difference from the reference.
  /// @param lens_px_per_D  the leaves are 0.3 to 1.2 D out of focus
  std::vector<double> distances_dB(float lens_px_per_D, const std::vector<const char*>& methods) {
    const RenderSettings settings = blurredBy(lens_px_per_D, 0.5f);
    const Frame reference = renderedBy("accumulate:150", cloud_, view_, settings);
    std::vector<double> all_dB;
    for (const char* method : methods) {
      all_dB.push_back(psnr_dB(renderedBy(method, cloud_, view_, settings), reference));
    }
    return all_dB;
  }

  SurfelCloud cloud_;
  View view_ = squareViewOf(64, 128.0f);
};

TEST_F(Foliage, FailureOfSweepOneEdgeAcrossTheLensIsNotEnough) {
  const auto dB = distances_dB(10.0f, {"sweep", "sweep-lod:7"});
  EXPECT_LT(dB[0], dB[1] - 3.0) << dB[0] << " dB";
}

TEST_F(Foliage, FailureOfSweepLodFewSubAperturesAreNotEnough) {
  const auto dB = distances_dB(30.0f, {"sweep-lod:7", "sweep-lod:61"});
  EXPECT_LT(dB[0], dB[1] - 3.0) << dB[0] << " dB";
}

}  // namespace FOCI_FILE
}  // namespace foci
