#include "render/scene/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>

#include "render/lod/moment_tree.h"
#include "render/methods/method.h"
#include "render/scene/gaussian_cloud.h"
#include "render/scene/harmonics.h"

namespace foci {
namespace FOCI_FILE {

/// A square of the given half side before the eye, which looks along -z.
SurfelCloud square(float z, float half, const glm::vec3& color) {
  SurfelCloud cloud;
  constexpr float kStep = 0.01f;
  const int count = static_cast<int>(half / kStep);
  for (int y = -count; y < count; ++y) {
    for (int x = -count; x < count; ++x) {
      appendSurfel(
          cloud,
          {(static_cast<float>(x) + 0.5f) * kStep, (static_cast<float>(y) + 0.5f) * kStep, z},
          {0, 0, 1}, kSigmaPerSpacing * kStep, kStep * kStep, color);
    }
  }
  cloud.oriented = true;
  return cloud;
}

Scene asGaussianScene(const SurfelCloud& surfels) { return {gaussiansOf(surfels)}; }

Frame render(const Scene& scene, float blur_px_per_D) {
  const View view = viewOfCamera(eyeFromWorld({0, 0, 0}, {0, 0, -1}, {0, 1, 0}), {80, 60}, 0.5);
  RenderSettings settings;
  settings.defocus = {.radius_px_per_D = glm::vec2(blur_px_per_D), .focus_D = 0.5f};
  Frame frame;
  makeMethod(blur_px_per_D > 0.0f ? "sweep" : "pinhole", scene)->render(view, settings, frame);
  return frame;
}

const glm::vec3 kRed(0.6f, 0.05f, 0.05f), kGreen(0.05f, 0.5f, 0.05f);

TEST(Scene, TellsWhatBothKindsHave) {
  SurfelCloud surfels;
  appendSurfel(surfels, glm::vec3(0.0f), {0.0f, 0.0f, 1.0f}, 0.1f, 0.01f, glm::vec3(0.5f));
  surfels.objects = {.of = {1}, .names = {"", "wall"}};
  const Scene of_surfels{surfels}, of_gaussians{gaussiansOf(surfels)};
  EXPECT_EQ(of_surfels.size(), 1u);
  EXPECT_EQ(of_gaussians.size(), 1u);
  EXPECT_EQ(of_surfels.objects().names.at(1), "wall");
  EXPECT_TRUE(of_gaussians.objects().empty());
  EXPECT_EQ(of_surfels.preservesLight(), std::nullopt);
  EXPECT_EQ(of_gaussians.preservesLight(), false);
  EXPECT_TRUE(withSurfelTree(of_surfels));
  EXPECT_FALSE(withSurfelTree(of_gaussians));
}

TEST(JoinedScene, APartIsTurnedAndMoved) {
  const glm::quat quarter = glm::angleAxis(glm::radians(90.0f), glm::vec3(0, 1, 0));
  SurfelCloud surfels;
  appendSurfel(surfels, {1, 2, 3}, {0, 0, 1}, 0.1f, 0.01f, kRed);
  const Scene placed_surfels = placed({surfels}, {.position_m = {10, 0, 0}, .rotation = quarter});
  const SurfelCloud& moved = *placed_surfels.surfels();
  EXPECT_LT(glm::distance(moved.position_m[0], glm::vec3(13, 2, -1)), 1e-5f);
  const glm::vec3 normal = glm::normalize(glm::cross(moved.axis_u_m[0], moved.axis_v_m[0]));
  EXPECT_LT(glm::distance(normal, glm::vec3(1, 0, 0)), 1e-5f);

  // A Gaussian scene of the same surfel moves alike.
  const Scene placed_volume =
      placed(asGaussianScene(surfels), {.position_m = {10, 0, 0}, .rotation = quarter});
  const GaussianCloud& volume = *placed_volume.gaussians();
  const GaussianCloud expected = gaussiansOf(moved);
  EXPECT_LT(glm::distance(volume.position_m[0], expected.position_m[0]), 1e-5f);
  EXPECT_NEAR(volume.covariance_m2[0].xx, expected.covariance_m2[0].xx, 1e-7);
  EXPECT_NEAR(volume.covariance_m2[0].yy, expected.covariance_m2[0].yy, 1e-7);
}

TEST(JoinedScene, ColoursThatDependOnTheDirectionTurn) {
  auto gaussians = gaussiansOf(square(-1.0f, 0.1f, kRed));
  gaussians.degree = kMaxHarmonicsDegree;
  gaussians.harmonics.resize(gaussians.size() * gaussians.harmonicsPerGaussian());
  for (std::size_t k = 0; k < gaussians.harmonics.size(); ++k) {
    gaussians.harmonics[k] = static_cast<std::int16_t>(static_cast<int>(k * 7919 % 801) - 400);
  }
  for (glm::vec3& color : gaussians.color) color = glm::vec3(2.0f);  // above 0 in all directions
  const Scene scene{gaussians};
  for (const float angle_rad : {0.3f, 1.5708f, 2.9f}) {
    const Placement place{
        .rotation = glm::angleAxis(angle_rad, glm::normalize(glm::vec3(0.3f, -0.8f, 0.5f)))};
    const Scene turned = placed(scene, place);
    for (const glm::vec3 along :
         {glm::vec3(0, 0, -1), glm::vec3(1, 0, 0), glm::vec3(0.6f, -0.48f, 0.64f)}) {
      for (const std::size_t i : {std::size_t{0}, gaussians.size() - 1}) {
        const glm::vec3 before = colorOf(gaussians, i, along);
        const glm::vec3 after = colorOf(*turned.gaussians(), i, place.rotation * along);
        // Each coefficient is rounded by half a step of 1/4096.
        EXPECT_LT(glm::distance(before, after), 1.5e-3f) << angle_rad;
      }
    }
  }
}

TEST(JoinedScene, SurfelsThatJoinGaussiansGetHarmonics) {
  auto gaussians = gaussiansOf(square(-1.0f, 0.1f, kRed));
  gaussians.degree = 1;
  gaussians.harmonics.assign(gaussians.size() * gaussians.harmonicsPerGaussian(), 0);
  const Scene scene{gaussians};
  // Surfels that join it get harmonics of 0.
  const Scene joint = joined(scene, {square(-2.0f, 0.1f, kGreen)}, "green");
  const GaussianCloud& all = *joint.gaussians();
  EXPECT_EQ(all.degree, 1);
  EXPECT_EQ(all.harmonics.size(), all.size() * all.harmonicsPerGaussian());
}

TEST(JoinedScene, SaysWhereCapturesDisagreeAboutTheLowPass) {
  const Scene surfels{square(-1.0f, 0.1f, kRed)}, usual = asGaussianScene(*surfels.surfels());
  GaussianCloud gaussians = *usual.gaussians();
  gaussians.preserves_light = true;
  const Scene preserving{std::move(gaussians)};
  EXPECT_FALSE(lowPassRemark(usual, "a", usual, "b"));
  EXPECT_FALSE(lowPassRemark(surfels, "a", preserving, "b"));
  EXPECT_FALSE(lowPassRemark(preserving, "a", surfels, "b"));
  EXPECT_EQ(lowPassRemark(preserving, "a.spz", usual, "b.ply"),
            "a.spz and b.ply were trained with different low-passes: both are rendered with that "
            "of a.spz, which preserves light, so small Gaussians of b.ply look fainter than alone");
  EXPECT_TRUE(joined(preserving, usual, "b").gaussians()->preserves_light);
  EXPECT_NE(lowPassRemark(usual, "a", preserving, "b")
                ->find("does not preserve light, so small "
                       "Gaussians of b look stronger"),
            std::string::npos);
  EXPECT_FALSE(joined(usual, preserving, "b").gaussians()->preserves_light);
}

TEST(JoinedScene, PartsAreObjectsAndBodiesKeepApart) {
  SurfelCloud first = square(-1.0f, 0.1f, kRed), second = square(-2.0f, 0.1f, kGreen);
  first.bodies.of_surfel.assign(first.size(), 1);
  second.bodies.of_surfel.assign(second.size(), 1);
  completeBodies(first);
  completeBodies(second);
  const std::size_t had = first.size();
  const Scene joint = joined({first}, {second}, "green");
  const SurfelCloud& all = *joint.surfels();
  EXPECT_EQ(all.objects.names, (std::vector<std::string>{"", "green"}));
  EXPECT_EQ(all.objects.of[had - 1], 0);
  EXPECT_EQ(all.objects.of[had], 1);
  EXPECT_EQ(all.bodies.of_surfel[had - 1], 1);
  EXPECT_EQ(all.bodies.of_surfel[had], 2);
  ASSERT_EQ(all.bodies.boxes.size(), 3u);
  EXPECT_LT(all.bodies.boxes[2].high_m.z, -1.9f);
}

TEST(JoinedScene, FlatGaussiansCoverWhatTheirSurfelsCover) {
  for (const float blur : {0.0f, 4.0f}) {
    const Frame volume = render(asGaussianScene(square(-1.0f, 0.6f, kRed)), blur);
    float least = 1.0f;
    for (const glm::vec4& pixel : volume.rgba) {
      least = std::min(least, pixel.a);
      EXPECT_NEAR(pixel.r, kRed.r, 0.02f);
    }
    EXPECT_GT(least, 0.99f);
  }
}

TEST(JoinedScene, AGaussianWallHidesAMeshBehindItAndNotOneBeforeIt) {
  const Scene wall = asGaussianScene(square(-2.0f, 0.8f, kGreen));
  for (const float blur : {0.0f, 3.0f}) {
    const glm::vec4 before =
        render(joined(wall, {square(-1.0f, 0.1f, kRed)}, "a"), blur).at(40, 30);
    EXPECT_NEAR(before.r, kRed.r, 0.03f);
    EXPECT_NEAR(before.g, kRed.g, 0.03f);
    const glm::vec4 behind =
        render(joined(wall, {square(-3.0f, 0.1f, kRed)}, "a"), blur).at(40, 30);
    EXPECT_NEAR(behind.r, kGreen.r, 0.03f);
    EXPECT_NEAR(behind.g, kGreen.g, 0.03f);
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
