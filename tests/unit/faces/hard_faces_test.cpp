// How many irises each tracker finds on faces as hard as real ones.
#include "tests/faces/hard_faces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>

#include "gaze/webcam/webcam_tracker.h"

namespace foci::faces {
namespace {

const Lens kCamera{{.focal_px = {560, 560}, .principal_px = {320, 240}}};

struct Count {
  int right = 0, wrong = 0, all = 0;
};

struct Shown {
  std::string what;
  cv::Mat image;
  Truth truth;
};

const std::vector<Shown>& images() {
  static const std::vector<Shown> all = [] {
    std::vector<Shown> shown;
    for (const HardFace& each : hardFaces(2)) {
      const Face face(each.person);
      shown.push_back(
          {each.what, face.photograph(each.moment, each.how), face.truthOf(each.moment, each.how)});
    }
    return shown;
  }();
  return all;
}

/// Each face alone, as the first one of its tracker. An iris within a quarter of its diameter is
/// right. Reports "right wrong all" of each difficulty for docs/results.py.
template <class MakeTracker>
Count countIrises(const MakeTracker& makeTracker, bool colour) {
  Count sum;
  std::map<std::string, Count> counts;
  for (const Shown& each : images()) {
    cv::Mat image = each.image;
    if (!colour) cv::cvtColor(each.image, image, cv::COLOR_BGR2GRAY);
    auto tracker = makeTracker();
    const WebcamRecord record = tracker.push(image);
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const auto& iris = record.irises[eye];
      const double reach_px = 0.5 * each.truth.iris_radius_px[eye];
      const bool right = iris && glm::distance(iris->centre_px, each.truth.iris_px[eye]) < reach_px;
      for (Count* count : {&sum, &counts[each.what]}) {
        count->right += right;
        count->wrong += iris && !right;
        ++count->all;
      }
    }
  }
  for (const auto& [what, count] : counts) {
    std::string key = "hard_" + what;
    std::replace(key.begin(), key.end(), ' ', '_');
    testing::Test::RecordProperty(key, std::to_string(count.right) + " " +
                                           std::to_string(count.wrong) + " " +
                                           std::to_string(count.all));
  }
  return sum;
}

TEST(HardFaces, TheCascadesGetAboutHalfOfTheIrises) {
  const Count count = countIrises([] { return CascadeTracker(kCamera, {}); }, false);
  EXPECT_GT(count.right, 0.3 * count.all) << count.wrong << " of " << count.all << " wrong";
  EXPECT_LT(count.right, 0.65 * count.all) << "easier than real faces, of which half are right";
}

TEST(HardFaces, TheNetworksGetMore) {
  if (!FaceNetworks::missing().empty()) {
    GTEST_SKIP() << "the webcam's networks are not installed: sh app/webcam_models.sh";
  }
  const Count count =
      countIrises([] { return NetworkTracker(*FaceNetworks::load(), kCamera, {}); }, true);
  EXPECT_GE(count.right, 0.65 * count.all);
  EXPECT_LE(count.wrong, 0.04 * count.all) << "no iris is better than a wrong one";
}

}  // namespace
}  // namespace foci::faces
