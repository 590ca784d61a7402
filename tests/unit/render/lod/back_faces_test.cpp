#include "render/lod/back_faces.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <utility>

#include "render/image/metrics.h"
#include "render/lod/moment_tree.h"
#include "render/methods/method.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/mesh/sample_mesh.h"
#include "tests/unit/render/mesh_shapes.h"

namespace foci {
namespace FOCI_FILE {

constexpr float kPi = 3.14159265f;

/// A torus about the y axis, of radii 0.2 and 0.08 m.
SurfelCloud torus() {
  constexpr int kAround = 64, kAcross = 32;
  TriangleMesh mesh;
  const auto corner = [](int i, int j) {
    const float a = 2.0f * kPi * static_cast<float>(i % kAround) / kAround;
    const float b = 2.0f * kPi * static_cast<float>(j % kAcross) / kAcross;
    const float r = 0.2f + 0.08f * std::cos(b);
    return glm::vec3(r * std::sin(a), 0.08f * std::sin(b), r * std::cos(a));
  };
  for (int i = 0; i < kAround; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const glm::vec3 a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1),
                      d = corner(i, j + 1);
      for (const glm::vec3& each : {a, b, c, a, c, d}) mesh.corners_m.push_back(each);
    }
  }
  return surfelsFromPoints(
      sampleMesh(finishedMesh(std::move(mesh), {0.6f, 0.4f, 0.2f}), "torus", {.points = 40'000}));
}

const SurfelCloud& theTorus() {
  static const SurfelCloud cloud = torus();
  return cloud;
}

View viewFrom(const glm::vec3& eye_m, const glm::vec3& target_m) {
  return viewOfCamera(eyeFromWorld(eye_m, target_m, {0.1f, 1.0f, 0.0f}), {160, 120}, 0.7);
}

Frame render(const SurfelCloud& cloud, const char* method, const View& view, float blur_px_per_D) {
  RenderSettings settings;
  settings.defocus = {.radius_px_per_D = glm::vec2(blur_px_per_D), .focus_D = 1.4f};
  settings.lighting.background = {0.9f, 0.9f, 0.9f};
  Frame frame;
  makeMethod(method, cloud)->render(view, settings, frame);
  return frame;
}

TEST(BackFaces, AllSurfelsOfAClosedMeshAreOnItsBody) {
  const ClosedBodies& bodies = theTorus().bodies;
  EXPECT_EQ(bodies.of_surfel, std::vector<std::uint16_t>(theTorus().size(), 1));
  ASSERT_EQ(bodies.boxes.size(), 2u);
  EXPECT_LT(glm::length(bodies.boxes[1].high_m - glm::vec3(0.28f, 0.08f, 0.28f)), 0.02f);
}

TEST(BackFaces, ABodyWithATransparentSurfelIsOpen) {
  SurfelCloud cloud = theTorus();
  cloud.opacity.assign(cloud.size(), 1.0f);
  cloud.opacity[7] = 0.99f;
  completeBodies(cloud);
  EXPECT_TRUE(cloud.bodies.of_surfel.empty());
  EXPECT_TRUE(cloud.bodies.boxes.empty());
}

TEST(BackFaces, ABodyIsSeenFromOutsideBeyondTheNearPlaneAndTheLens) {
  View view = viewFrom({0.0f, 0.0f, 0.5f}, glm::vec3(0.0f));
  const auto outside = [&](float z) {
    view = viewFrom({0.0f, 0.0f, z}, {0.0f, 0.0f, -1.0f});
    return bodiesFromOutside(theTorus().bodies, view, {.radius_px_per_D = 0.002f * view.focal_px});
  };
  const float face_m = theTorus().bodies.boxes[1].high_m.z;
  EXPECT_FLOAT_EQ(lensRadius_m(view, {.radius_px_per_D = 0.002f * view.focal_px}), 0.002f);
  EXPECT_EQ(outside(0.5f)[1], 1);
  EXPECT_EQ(outside(0.5f)[0], 0);
  EXPECT_EQ(outside(face_m + 0.011f)[1], 0);  // the near plane is 0.01 m away
  EXPECT_EQ(outside(0.2f)[1], 0);
}

// What a node says of its side holds for each surfel below it, from every point of the lens.
TEST(BackFaces, ANodesSideHoldsForItsSurfels) {
  const MomentTree tree(theTorus());
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  constexpr float kLens_m = 0.004f;
  std::size_t backs = 0, fronts = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const glm::vec3 eye_m =
        0.6f * glm::normalize(glm::vec3{unit(random), unit(random), unit(random)});
    for (int level = 4; level < tree.levels(); ++level) {
      for (std::size_t j = 0; j < std::size_t{1} << level; ++j) {
        const std::size_t i = (std::size_t{1} << level) + j;
        const LodNode& node = tree.nodes()[i];
        const FacingSide side = sideOf(tree.facing()[i], unpackNormal(node.normal),
                                       node.position_m - eye_m, node.radius_m, kLens_m);
        if (side == FacingSide::both) continue;
        (side == FacingSide::backs ? backs : fronts) += 1;
        const auto [begin, end] = tree.range(level, j);
        for (std::size_t s = begin; s < end; ++s) {
          const glm::vec3 normal =
              glm::normalize(glm::cross(tree.surfels().axis_u_m[s], tree.surfels().axis_v_m[s]));
          const float behind_m = glm::dot(normal, tree.surfels().position_m[s] - eye_m);
          if (side == FacingSide::backs) {
            ASSERT_GT(behind_m, kLens_m);
          } else {
            ASSERT_LT(behind_m, -kLens_m);
          }
        }
      }
    }
  }
  EXPECT_GT(backs, 10'000u);
  EXPECT_GT(fronts, 10'000u);
}

TEST(BackFaces, HiddenOnesAreNotRenderedAndDoNotShow) {
  SurfelCloud open = theTorus();
  open.bodies = {};
  const View view = viewFrom({0.1f, 0.45f, 0.55f}, glm::vec3(0.0f));
  for (const char* method : {"pinhole", "sweep", "sweep-lod:7"}) {
    const float blur = std::string(method) == "pinhole" ? 0.0f : 6.0f;
    const Frame all = render(open, method, view, blur);
    const Frame fronts = render(theTorus(), method, view, blur);
    EXPECT_GT(psnr_dB(all, fronts), 30.0) << method;
    double coverage = 0.0, before = 0.0;
    for (std::size_t p = 0; p < all.rgba.size(); ++p) {
      before += all.rgba[p].a;
      coverage += fronts.rgba[p].a;
    }
    EXPECT_NEAR(coverage / before, 1.0, 0.03) << method;  // outlines no longer count twice
  }
  RenderSettings settings;
  Frame frame;
  const auto splats = [&](const SurfelCloud& cloud) {
    return makeMethod("sweep", cloud)->render(view, settings, frame).splats;
  };
  EXPECT_LT(splats(theTorus()), 0.6 * static_cast<double>(splats(open)));
}

// From within its box, as between the arms of a chair, a body is rendered whole.
TEST(BackFaces, FromWithinTheBoxNothingChanges) {
  SurfelCloud open = theTorus();
  open.bodies = {};
  for (const glm::vec3& eye_m : {glm::vec3(0.2f, 0.0f, 0.0f), glm::vec3(0.0f)}) {
    const View view = viewFrom(eye_m, eye_m + glm::vec3(0.2f, 0.05f, 0.3f));
    for (const char* method : {"pinhole", "sweep-lod:7"}) {
      EXPECT_EQ(render(open, method, view, 3.0f).rgba, render(theTorus(), method, view, 3.0f).rgba);
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
