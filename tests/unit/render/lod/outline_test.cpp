#include "render/lod/moment_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace foci {
namespace FOCI_FILE {

SurfelCloud helix() {
  SurfelCloud cloud;
  for (int i = 0; i < 500; ++i) {
    const float turn = 0.05f * static_cast<float>(i);
    appendSurfel(cloud, {std::cos(turn), 0.1f * turn, std::sin(turn)}, {0.0f, 1.0f, 0.0f}, 0.02f,
                 1e-3f, glm::vec3(0.5f));
  }
  cloud.oriented = true;
  return cloud;
}

TEST(Outline, OnlyOfALargeSceneWithATree) {
  const SurfelCloud scene = helix();
  EXPECT_FALSE(outlineOf({scene}, 1));
  EXPECT_FALSE(outlineOf({withTree(scene)}));
  EXPECT_TRUE(outlineOf({withTree(scene)}, 1));
}

TEST(Outline, CoversTheScene) {
  const SurfelCloud scene = withTree(helix());
  const Scene found = outlineOf({scene}, 1).value();
  const SurfelCloud& outline = *found.surfels();
  const int level = std::min(16, builtTree(scene)->levels() - 1);
  ASSERT_EQ(outline.size(), std::size_t{1} << level);
  EXPECT_EQ(outline.oriented, scene.oriented);
  for (std::size_t j = 0; j < outline.size(); ++j) {
    const float reach_m = 3.0f * glm::length(outline.axis_u_m[j]) * 1.0001f;
    const auto [begin, end] = builtTree(scene)->range(level, j);
    for (std::size_t i = begin; i < end; ++i) {
      EXPECT_LE(glm::distance(outline.position_m[j], scene.position_m[i]), reach_m);
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
