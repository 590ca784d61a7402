#include "render/lod/outline.h"

#include <gtest/gtest.h>

#include "render/lod/moment_tree.h"
#include "render/scene/builtin/procedural.h"

namespace foci {
namespace {

TEST(Outline, OnlyOfALargeSceneWithATree) {
  const SurfelCloud gallery = makeGallery();
  EXPECT_TRUE(outlineOf(gallery, 1).empty());
  EXPECT_TRUE(outlineOf(withTree(gallery)).empty());
  EXPECT_FALSE(outlineOf(withTree(gallery), 1).empty());
}

TEST(Outline, CoversTheScene) {
  const SurfelCloud scene = withTree(makeGallery());
  const SurfelCloud outline = outlineOf(scene, 1);
  const int level = std::min(16, scene.tree->levels() - 1);
  ASSERT_EQ(outline.size(), std::size_t{1} << level);
  EXPECT_EQ(outline.oriented, scene.oriented);
  for (std::size_t j = 0; j < outline.size(); ++j) {
    const float reach_m = 3.0f * glm::length(outline.axis_u_m[j]) * 1.0001f;
    const auto [begin, end] = scene.tree->range(level, j);
    for (std::size_t i = begin; i < end; ++i) {
      EXPECT_LE(glm::distance(outline.position_m[j], scene.position_m[i]), reach_m);
    }
  }
}

}  // namespace
}  // namespace foci
