// How many irises each tracker finds on faces as hard as real ones.
#include "tests/faces/hard_faces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "gaze/webcam/webcam_source.h"

namespace foci::faces {
namespace FOCI_FILE {

const Lens kCamera{{.focal_px = {560, 560}, .principal_px = {320, 240}}};

struct Count {
  int right = 0, wrong = 0, all = 0;
  double confidence = 0.0;  // sum over the irises that were found
};

struct Shown {
  std::string what;
  cv::Mat image;
  Truth truth;
};

const std::vector<Shown>& images() {
  static const std::vector<Shown> all = [] {
    std::vector<Shown> shown;
    for (const HardFace& each : hardFaces(4)) {
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
Count countIrises(const MakeTracker& makeTracker, bool colour, bool report = true) {
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
        count->confidence += iris ? iris->confidence : 0.0;
        ++count->all;
      }
    }
  }
  for (const auto& [what, count] : counts) {
    if (!report) break;
    std::string key = "hard_" + what;
    std::replace(key.begin(), key.end(), ' ', '_');
    testing::Test::RecordProperty(key, std::to_string(count.right) + " " +
                                           std::to_string(count.wrong) + " " +
                                           std::to_string(count.all));
  }
  return sum;
}

CascadeTracker cascades() { return {kCamera, {}}; }

TEST(HardFaces, TheCascadesGetHalfOfTheIrises) {
  const Count count = countIrises(cascades, false);
  // As of real faces. Two standard errors of a share of one half.
  EXPECT_NEAR(count.right, 0.5 * count.all, std::sqrt(count.all)) << count.wrong << " wrong";
}

/// They are worth their installation if they halve the misses. Of the irises that they report, as
/// many are right as their confidence says; its curve was fitted to other faces.
TEST(HardFaces, TheNetworksHalveTheMisses) {
  if (!FaceNetworks::missing().empty()) {
    GTEST_SKIP() << "the webcam's networks are not installed: sh app/webcam_models.sh";
  }
  const Count before = countIrises(cascades, false, false);
  const Count count =
      countIrises([] { return NetworkTracker(*FaceNetworks::load(), kCamera, {}); }, true);
  EXPECT_LE(2 * (count.all - count.right), before.all - before.right);
  EXPECT_LE(count.wrong, 0.5 * before.wrong) << "no iris is better than a wrong one";
  const double found = count.right + count.wrong;
  EXPECT_NEAR(count.confidence / found, count.right / found, 0.1);
}

}  // namespace FOCI_FILE
}  // namespace foci::faces
