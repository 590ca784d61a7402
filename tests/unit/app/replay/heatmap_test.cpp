// The pictures of a heatmap show its heat, with the scene's own axis upwards and a scale.
#include "app/replay/heatmap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/glm.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "render/lod/moment_tree.h"
#include "render/scene/surfel_cloud.h"

namespace foci {
namespace FOCI_FILE {

/// A grey wall 3 m away, across the line of sight along `towards`, with its tree.
SurfelCloud wallOf(const glm::vec3& towards, const glm::vec3& up) {
  constexpr float kSpacing_m = 0.03f;
  const glm::vec3 right = glm::cross(towards, up);
  SurfelCloud cloud;
  for (int x = -40; x <= 40; ++x) {
    for (int y = -40; y <= 40; ++y) {
      appendSurfel(cloud,
                   3.0f * towards +
                       kSpacing_m * (static_cast<float>(x) * right + static_cast<float>(y) * up),
                   -towards, kSigmaPerSpacing * kSpacing_m, kSpacing_m * kSpacing_m,
                   glm::vec3(0.4f));
    }
  }
  return withTree(std::move(cloud));
}

/// Gaze rests on a pole in the middle of the wall: high along `up`, narrow across it.
struct Looked {
  Looked(const glm::vec3& towards, const glm::vec3& up) : cloud(wallOf(towards, up)) {
    const glm::vec3 right = glm::cross(towards, up);
    gaze.up = up;
    for (const glm::vec3& p : positionsOf(cloud)) {
      const bool on_pole = std::abs(glm::dot(p, right)) < 0.1f && std::abs(glm::dot(p, up)) < 0.6f;
      gaze.attention_s.push_back(on_pole ? 0.01 : 0.0);
    }
    gaze.samples = {{.lasts_s = 1.0,
                     .valid = true,
                     .hit = SightHit{.point_m = 3.0 * glm::dvec3(towards), .distance_m = 3.0}}};
  }
  SurfelCloud cloud;
  GazeInScene gaze;
};

/// The bounds of what is not grey, px.
cv::Rect colouredIn(const HeatPicture& picture) {
  const glm::ivec2 size_px = picture.image.size_px;
  const cv::Mat image(size_px.y, size_px.x, CV_8UC3,
                      const_cast<unsigned char*>(picture.image.rgb.data()));
  cv::Mat coloured(image.size(), CV_8U, cv::Scalar(0));
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const auto& c = image.at<cv::Vec3b>(y, x);
      const auto [low, high] = std::minmax({c[0], c[1], c[2]});
      if (high - low > 60) coloured.at<unsigned char>(y, x) = 1;
    }
  }
  return cv::boundingRect(coloured);
}

TEST(HeatPictures, ShowTheHeatUpright) {
  const std::vector<std::pair<glm::vec3, glm::vec3>> views = {
      {{0.0f, 0.0f, -1.0f}, {0.0f, 1.0f, 0.0f}}, {{0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}}};
  for (const auto& [towards, up] : views) {
    const Looked looked(towards, up);
    const HeatMap map = heatMapOf(looked.cloud, looked.gaze.attention_s);
    const auto pictures = heatPictures(map.cloud, looked.gaze);
    ASSERT_EQ(pictures.size(), 2u);
    for (const HeatPicture& picture : pictures) {
      const cv::Rect pole = colouredIn(picture);
      EXPECT_GT(pole.width, 10) << picture.caption;
      EXPECT_GT(pole.height, 3 * pole.width) << picture.caption;
    }
  }
}

TEST(HeatMap, StatesItsScaleInSecondsPerSquareMetre) {
  const Looked looked({0.0f, 0.0f, -1.0f}, {0.0f, 1.0f, 0.0f});
  const HeatMap map = heatMapOf(looked.cloud, looked.gaze.attention_s);
  EXPECT_NEAR(map.most_s_per_m2, 0.01 / (0.03 * 0.03), 0.01);
  EXPECT_NE(heatBarHtml(map.most_s_per_m2).find("11.1 s/m&sup2;"), std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci
