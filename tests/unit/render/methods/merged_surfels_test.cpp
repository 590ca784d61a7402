// Methods without level of detail for blur merge surfels that are much finer than a pixel, if the
// scene has its tree. The picture stays that of all surfels.
#include <gtest/gtest.h>

#include <string>

#include "render/image/metrics.h"
#include "render/lod/moment_tree.h"
#include "render/methods/view_splats.h"
#include "tests/unit/render/method_scenes.h"

namespace foci {
namespace FOCI_FILE {

/// A sheet before another one, both of some 40 surfels a pixel, and the same with their tree.
struct FineSheets {
  SurfelCloud all, with_tree;
  View view = squareView(48, 48.0f);

  FineSheets() {
    addSheet(all, 2.0f, 2.4f, 320, {0.2f, 0.7f, 0.4f});
    addSheet(all, 1.0f, 0.5f, 160, {0.9f, 0.3f, 0.2f}, 0.1f);
    with_tree = withTree(all);
  }
};

TEST(MergedSurfels, HardlyChangeThePicture) {
  const FineSheets scene;
  RenderSettings settings = lens(6.0f, 1.0f);
  settings.depth = true;
  for (const std::string method : {"pinhole", "sweep", "sweep:7", "accumulate:8"}) {
    Frame of_all, merged;
    const RenderStats every = makeMethod(method, scene.all)->render(scene.view, settings, of_all);
    const RenderStats few =
        makeMethod(method, scene.with_tree)->render(scene.view, settings, merged);
    EXPECT_GE(psnr_dB(of_all, merged), 60.0) << method;
    EXPECT_LT(3 * few.splats, every.splats) << method;
    EXPECT_GT(few.splats, 0u) << method;
    for (const int at : {5 * 48 + 5, 24 * 48 + 24}) {
      const auto pixel = static_cast<std::size_t>(at);
      EXPECT_NEAR(merged.depth_m[pixel], of_all.depth_m[pixel], 1e-3f) << method;
    }
  }
}

TEST(MergedSurfels, AreCoarserWhereThePrefilterIsWider) {
  const FineSheets scene;
  const auto splatsAt = [&](float base_px) {
    ViewSplats splats;
    Projection projection;
    projection.acuity.base_px = base_px;
    splats.project(scene.with_tree, scene.view, lens(0.0f, 1.0f), projection,
                   pixelCutOf(scene.with_tree, projection.acuity));
    return splats.count();
  };
  EXPECT_LT(2 * splatsAt(3.0f), splatsAt(1.0f));
}

}  // namespace FOCI_FILE
}  // namespace foci
