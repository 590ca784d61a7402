// `observer.field` as users run it: the blur beside the line of sight, in studies of meshes and of
// points, for both eyes, with foveation.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"
#include "tests/e2e/linear_image.h"

namespace foci::e2e {
namespace FOCI_FILE {

constexpr int kWidth = 640, kHeight = 480;

class Field : public testing::Test {
 protected:
  Field() {
    // A white board 1 m away, whose upright edges lie 17 degrees beside the gaze.
    folder.write("scene.obj",
                 "v -0.3 -0.05 -1\nv 0.3 -0.05 -1\nv 0.3 0.05 -1\nv -0.3 0.05 -1\nf 1 2 3 4\n");
    folder.write("scene.ply", squarePly(64, 1.0));
    folder.write("trace.tsv", steadyTrace());
    folder.write("study.toml", smallStudy() + "[observer]\npupil_mm = 8\nfield = \"typical\"\n");
  }

  /// @param views  beside each other
  LinearImage rendered(const std::vector<std::string>& arguments, int views = 1) {
    const std::string size = std::to_string(views * kWidth) + "x" + std::to_string(kHeight);
    std::vector<std::string> all{"render", "study.toml",  "--gaze", "320,240",  "--size",
                                 size,     "--overwrite", "--out",  "image.pfm"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Outcome outcome = runFoci(all, folder.path());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return LinearImage(folder.read("image.pfm"));
  }

  TemporaryFolder folder;
};

TEST_F(Field, BlursAMeshMoreOnTheNasalSideOfEachEye) {
  const LinearImage both =
      rendered({"--scene", "scene.obj", "--method", "sweep-lod", "--view", "side-by-side"}, 2);
  ASSERT_EQ(both.width, 2 * kWidth);
  const int row = kHeight / 2, quarter = kWidth / 2;
  const auto slope = [&](int part) {
    return both.steepestIn(row, part * quarter, (part + 1) * quarter);
  };
  // There an eye is 1 D too strong, and 0.4 D on the temporal side.
  EXPECT_LT(slope(1), 0.95f * slope(0));
  EXPECT_LT(slope(2), 0.95f * slope(3));
  double apart = 0.0;
  for (int x = 0; x < kWidth; ++x) {
    apart += std::abs(both.at(x, row) - both.at(both.width - 1 - x, row)) / kWidth;
  }
  EXPECT_LT(apart, 0.003);  // surfels of a mesh are not mirror images
}

TEST_F(Field, WithFoveationIsTheSameAtTheGaze) {
  const LinearImage full = rendered({});
  const LinearImage foveated = rendered({"--set", "quality.foveated=true"});
  EXPECT_NE(full.values, foveated.values);
  constexpr int kAround = 12;  // 1 degree
  double apart = 0.0;
  for (int y = kHeight / 2 - kAround; y < kHeight / 2 + kAround; ++y) {
    for (int x = kWidth / 2 - kAround; x < kWidth / 2 + kAround; ++x) {
      apart = std::max<double>(apart, std::abs(full.at(x, y) - foveated.at(x, y)));
    }
  }
  EXPECT_LT(apart, 0.01);
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
