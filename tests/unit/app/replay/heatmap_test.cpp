// The pictures of a heatmap show its heat, with the scene's own axis upwards and a scale.
#include "app/replay/heatmap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/glm.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "render/lod/moment_tree.h"
#include "render/lod/surface_query.h"
#include "render/scene/gaussian_cloud.h"
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
  Looked(const glm::vec3& towards, const glm::vec3& up) : scene{wallOf(towards, up)} {
    const glm::vec3 right = glm::cross(towards, up);
    gaze.up = up;
    for (const glm::vec3& p : scene.position_m()) {
      const bool on_pole = std::abs(glm::dot(p, right)) < 0.1f && std::abs(glm::dot(p, up)) < 0.6f;
      gaze.attention_s.push_back(on_pole ? 0.01 : 0.0);
      gaze.heat_s_per_m2.push_back(gaze.attention_s.back() / (0.03 * 0.03));
    }
    gaze.samples = {{.lasts_s = 1.0,
                     .valid = true,
                     .hit = SightHit{.point_m = 3.0 * glm::dvec3(towards), .distance_m = 3.0}}};
  }
  Scene scene;
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
    const HeatMap map = heatMapOf(looked.scene, looked.gaze);
    const auto pictures = heatPictures(map.scene, looked.gaze);
    ASSERT_EQ(pictures.size(), 2u);
    for (const HeatPicture& picture : pictures) {
      const cv::Rect pole = colouredIn(picture);
      EXPECT_GT(pole.width, 10) << picture.caption;
      EXPECT_GT(pole.height, 3 * pole.width) << picture.caption;
    }
  }
}

/// What a cone of 0.02 rad meets first.
std::vector<SurfelShare> lookedAt(const Scene& scene, const glm::dvec3& towards) {
  const auto hit = SurfaceQuery(scene).hit(glm::dvec3(0.0), glm::normalize(towards), 0.02, 0.5);
  return hit ? hit->surfels : std::vector<SurfelShare>{};
}

TEST(HeatMap, OfGaussiansHasTheTimeOfGazeAndItsDensity) {
  // A wall 3 m away whose Gaussians are as wide as their spacing, so that several overlap.
  constexpr float kSpacing_m = 0.01f;
  GaussianCloud wall;
  for (int x = -60; x <= 60; ++x) {
    for (int y = -60; y <= 60; ++y) {
      wall.position_m.emplace_back(kSpacing_m * static_cast<float>(x),
                                   kSpacing_m * static_cast<float>(y), -3.0f);
      wall.covariance_m2.push_back(covarianceOf({0.01f, 0.01f, 0.001f}, {0.0f, 0.0f, 0.0f, 1.0f}));
      wall.opacity.push_back(0.6f);
      wall.color.emplace_back(0.5f);
    }
  }
  const Scene scene{std::move(wall)};
  GazeInScene gaze;
  gaze.attention_s.assign(scene.size(), 0.0);
  gaze.heat_s_per_m2 = gaze.attention_s;
  // Gaze rests for 1 s on each of 21 x 21 places, a centimetre apart.
  double shares = 0.0;
  for (int x = -10; x <= 10; ++x) {
    for (int y = -10; y <= 10; ++y) {
      for (const SurfelShare& each : lookedAt(scene, {0.01 * x, 0.01 * y, -3.0})) {
        shares += each.share;
        gaze.attention_s[each.surfel] += each.share;
        gaze.heat_s_per_m2[each.surfel] += each.per_m2;
      }
    }
  }
  EXPECT_NEAR(shares, 21.0 * 21.0, 1e-6) << "all of the time";
  // In the middle it is a second on each square centimetre, however much the Gaussians overlap.
  const std::size_t middle = 60 * 121 + 60;
  EXPECT_NEAR(gaze.heat_s_per_m2[middle], 1e4, 0.05e4);
  EXPECT_EQ(gaze.heat_s_per_m2[0], 0.0);

  const HeatMap map = heatMapOf(scene, gaze);
  EXPECT_NEAR(map.most_s_per_m2, 1e4, 0.1e4);
  const std::vector<glm::vec3>& colors = map.scene.gaussians()->color;
  EXPECT_EQ(colors[0].x, colors[0].y) << "grey where nobody looked";
  EXPECT_GT(colors[middle].x, colors[middle].z + 0.3f) << "bright yellow";
}

TEST(HeatMap, StatesItsScaleInSecondsPerSquareMetre) {
  const Looked looked({0.0f, 0.0f, -1.0f}, {0.0f, 1.0f, 0.0f});
  const HeatMap map = heatMapOf(looked.scene, looked.gaze);
  EXPECT_NEAR(map.most_s_per_m2, 0.01 / (0.03 * 0.03), 0.01);
  EXPECT_NE(heatBarHtml(map.most_s_per_m2).find("11.1 s/m&sup2;"), std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci
