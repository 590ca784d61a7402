// What a case tells other renderers, read as they read it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "app/evaluation/chart/cases.h"
#include "app/evaluation/scene_in_view.h"
#include "app/graphics/image.h"
#include "base/input_error.h"
#include "render/image/image_file.h"
#include "render/image/srgb.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/gaussian_cloud.h"
#include "render/scene/io/gaussian_formats.h"
#include "render/scene/io/gltf_document.h"
#include "render/scene/io/mesh_formats.h"
#include "render/scene/io/ply.h"
#include "render/scene/principal_axes.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kFloat_px = 1e-3;  // floats of positions and poses, at hundreds of pixels

View tiltedView() {
  return viewOfCamera(eyeFromWorld({1.0f, 2.0f, 3.0f}, {0.2f, 0.1f, -0.4f}, {0.1f, 1.0f, 0.0f}),
                      {320, 180}, 0.7);
}

constexpr double kShift_px = 0.3;  // a phase correlation of so small an image

constexpr glm::dvec3 kPoint(0.3, 0.4, -0.1);

glm::dvec2 expected_px() {
  const View view = tiltedView();
  return project(view, glm::vec3(view.eye_from_world * glm::vec4(kPoint, 1.0)));
}

TEST(CameraFiles, TransformsJsonIsWorldFromAnOpenGlCamera) {
  const auto json = nlohmann::json::parse(nerfTransforms(tiltedView(), "a.png", "b.ply"));
  const auto rows = json["frames"][0]["transform_matrix"];
  glm::dmat4 world_from_camera;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) world_from_camera[j][i] = rows[i][j];
  }
  const glm::dvec3 p(glm::inverse(world_from_camera) * glm::dvec4(kPoint, 1.0));
  ASSERT_LT(p.z, 0.0);  // before a camera that looks along -z
  const double x = json["fl_x"].get<double>() * p.x / -p.z + json["cx"].get<double>();
  const double y = json["fl_y"].get<double>() * -p.y / -p.z + json["cy"].get<double>();
  EXPECT_NEAR(x, expected_px().x, kFloat_px);
  EXPECT_NEAR(y, expected_px().y, kFloat_px);
  // Loaders of NeRFs without fl_x take the field of view, and the middle of the image.
  const double focal_px =
      0.5 * json["w"].get<int>() / std::tan(0.5 * json["camera_angle_x"].get<double>());
  EXPECT_NEAR(focal_px, json["fl_x"].get<double>(), kFloat_px);
  EXPECT_EQ(json["cx"], 160.0);
}

TEST(CameraFiles, ColmapLooksAlongZWithYDown) {
  SurfelCloud cloud;
  appendSurfel(cloud, glm::vec3(kPoint), {0, 0, 1}, 0.1f, 0.01f,
               glm::vec3(1.0f, 0.0f, linearFromSrgb(0.5f)));
  const ColmapModel model = colmapModel(tiltedView(), "a.png", {cloud});
  std::istringstream cameras(model.cameras.substr(model.cameras.find("\n1 ") + 1));
  std::string id, kind, name;
  double w, h, fx, fy, cx, cy;
  cameras >> id >> kind >> w >> h >> fx >> fy >> cx >> cy;
  EXPECT_EQ(kind, "PINHOLE");
  std::istringstream images(model.images.substr(model.images.find("\n1 ") + 1));
  glm::dquat q;
  glm::dvec3 t;
  images >> id >> q.w >> q.x >> q.y >> q.z >> t.x >> t.y >> t.z >> id >> name;
  EXPECT_EQ(name, "a.png");
  const glm::dvec3 p = q * kPoint + t;
  ASSERT_GT(p.z, 0.0);
  EXPECT_NEAR(fx * p.x / p.z + cx, expected_px().x, kFloat_px);
  EXPECT_NEAR(fy * p.y / p.z + cy, expected_px().y, kFloat_px);
  EXPECT_NE(model.points3D.find(" 255 0 128 0\n"), std::string::npos) << model.points3D;
}

TEST(PrincipalAxes, MakeTheMatrixAgain) {
  const glm::dmat3 a(4.0, 1.0, 0.5, 1.0, 3.0, -0.2, 0.5, -0.2, 2.0);
  const PrincipalAxes all = principalAxes(a);
  EXPECT_NEAR(glm::determinant(all.axes), 1.0, 1e-12);
  const glm::dmat3 back =
      all.axes * glm::dmat3(all.variance.x, 0, 0, 0, all.variance.y, 0, 0, 0, all.variance.z) *
      glm::transpose(all.axes);
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(back[i / 3][i % 3], a[i / 3][i % 3], 1e-12);
}

TEST(SceneFiles, PointsGiveTheSurfelsBack) {
  const TemporaryFolder folder;
  SurfelCloud cloud;
  appendSurfel(cloud, {1, 2, 3}, {0, 0.6f, 0.8f}, 0.25f, 0.1f, glm::vec3(0.2f, 0.4f, 1.0f), 0.5f);
  writePoints(folder.path() / "a.ply", cloud);
  const PointCloud read = readPly(folder.path() / "a.ply");
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read.position_m[0], glm::vec3(1, 2, 3));
  EXPECT_NEAR(glm::distance(read.normal[0], {0, 0.6f, 0.8f}), 0.0f, 1e-6f);
  EXPECT_NEAR(read.radius_m[0] * kSigmaPerRadius, 0.25f, 1e-6f);
  EXPECT_EQ(read.opacity[0], 0.5f);
  EXPECT_NEAR(read.color[0].g, 0.4f, 4e-3f);  // 8 bits of sRGB
}

TEST(SceneFiles, GaussiansGiveCovarianceAndHarmonicsBack) {
  const TemporaryFolder folder;
  GaussianCloud cloud;
  cloud.position_m = {{1, 2, 3}};
  cloud.covariance_m2 = {
      {.xx = 0.4f, .xy = 0.1f, .xz = 0.05f, .yy = 0.3f, .yz = -0.02f, .zz = 0.2f}};
  cloud.opacity = {0.7f};
  cloud.color = {{0.9f, 0.5f, 0.1f}};
  cloud.degree = 1;
  cloud.harmonics = {1, 20, 300, -4, 50, -600, 7, 80, 900};
  cloud.preserves_light = true;
  writeGaussians(folder.path() / "a.ply", {cloud});
  const GaussianCloud read = readGaussianPly(folder.path() / "a.ply").cloud;
  ASSERT_EQ(read.size(), 1u);
  const Covariance3 &v = read.covariance_m2[0], &w = cloud.covariance_m2[0];
  for (const auto& [a, b] : {std::pair(v.xx, w.xx),
                             {v.xy, w.xy},
                             {v.xz, w.xz},
                             {v.yy, w.yy},
                             {v.yz, w.yz},
                             {v.zz, w.zz}}) {
    EXPECT_NEAR(a, b, 1e-5f);
  }
  EXPECT_NEAR(read.opacity[0], 0.7f, 1e-6f);
  EXPECT_NEAR(glm::distance(read.color[0], cloud.color[0]), 0.0f, 1e-6f);
  EXPECT_EQ(read.harmonics, cloud.harmonics);
  EXPECT_TRUE(read.preserves_light);
}

TEST(SceneFiles, ASurfelIsAFlatGaussianOfItsSizeAndColour) {
  const TemporaryFolder folder;
  SurfelCloud cloud;
  appendSurfel(cloud, {1, 2, 3}, {0, 0, 1}, 0.25f, 0.1f, glm::vec3(0.2f));
  writeGaussians(folder.path() / "a.ply", {cloud});
  const GaussianCloud read = readGaussianPly(folder.path() / "a.ply").cloud;
  ASSERT_EQ(read.size(), 1u);
  EXPECT_NEAR(read.covariance_m2[0].xx, 0.0625f, 1e-5f);
  EXPECT_NEAR(read.covariance_m2[0].yy, 0.0625f, 1e-5f);
  EXPECT_LT(read.covariance_m2[0].zz, 1e-5f);
  EXPECT_NEAR(read.color[0].r, srgbFromLinear(0.2f), 1e-5f);
  EXPECT_GT(read.opacity[0], 0.98f);
}

TEST(SceneFiles, AGlbGivesTheMeshBack) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = makeBallMesh(0.25f);
  writeGlb(folder.path() / "a.glb", mesh);
  const TriangleMesh read = readGltfMesh(GltfDocument(folder.path() / "a.glb")).mesh;
  ASSERT_EQ(read.size(), mesh.size());
  EXPECT_EQ(read.corners_m, mesh.corners_m);
  for (std::size_t i = 0; i < mesh.uv.size(); ++i) {
    ASSERT_NEAR(glm::distance(read.uv[i], mesh.uv[i]), 0.0f, 1e-6f);
  }
  ASSERT_TRUE(read.materials.at(0).texture);
  EXPECT_EQ(read.materials[0].texture->pixels(), mesh.materials[0].texture->pixels());
  EXPECT_TRUE(read.materials[0].unlit);
}

/// Smooth colours of random waves: no symmetry, and no detail finer than three pixels.
Frame waves(unsigned seed, const glm::vec2& moved_px = glm::vec2(0.0f)) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> of(-1.0f, 1.0f);
  Frame frame;
  frame.resize({64, 48});
  frame.rgba.assign(frame.rgba.size(), glm::vec4(0.3f, 0.3f, 0.3f, 1.0f));
  for (int wave = 0; wave < 200; ++wave) {
    // in braces, which every compiler evaluates in this order
    const glm::vec2 per_px{2.0f * of(random), 2.0f * of(random)};
    const glm::vec3 rgb = 0.02f * glm::vec3{of(random), of(random), of(random)} + 0.013f;
    const float phase = 3.0f * of(random);
    for (std::size_t i = 0; i < frame.rgba.size(); ++i) {
      const glm::vec2 at(static_cast<float>(i % 64), static_cast<float>(i / 64));
      frame.rgba[i] += glm::vec4(rgb * std::sin(glm::dot(per_px, at - moved_px) + phase), 0.0f);
    }
  }
  return frame;
}

TEST(CameraFault, NamesWhatWentWrong) {
  const Frame right = waves(1);
  EXPECT_EQ(cameraFault(right, right), "");
  const auto changed = [&](const auto& at) {
    Frame frame = right;
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) frame.rgba[static_cast<std::size_t>(y * 64 + x)] = at(x, y);
    }
    return cameraFault(frame, right);
  };
  EXPECT_EQ(changed([&](int x, int y) { return right.at(63 - x, y); }),
            "is mirrored left to right");
  EXPECT_EQ(changed([&](int x, int y) { return right.at(x, 47 - y); }),
            "is mirrored top to bottom");
  EXPECT_EQ(changed([&](int x, int y) { return right.at(63 - x, 47 - y); }), "is upside down");
  const auto mapped = [&](float (*curve)(float)) {
    return changed([&](int x, int y) {
      const glm::vec4& p = right.at(x, y);
      return glm::vec4(curve(p.r), curve(p.g), curve(p.b), 1.0f);
    });
  };
  EXPECT_TRUE(mapped(srgbFromLinear).starts_with("is too bright"));
  EXPECT_TRUE(mapped(linearFromSrgb).starts_with("is too dark"));
  for (const glm::vec2 moved_px : {glm::vec2(0.5f, 0.5f), glm::vec2(-3.0f, 2.0f)}) {
    const std::string fault = cameraFault(waves(1, moved_px), right);
    double x = 0.0, y = 0.0;
    ASSERT_EQ(
        std::sscanf(fault.c_str(), "is shifted by %lf px to the right and %lf px down", &x, &y), 2)
        << fault;
    EXPECT_NEAR(x, moved_px.x, kShift_px);
    EXPECT_NEAR(y, moved_px.y, kShift_px);
  }
  EXPECT_TRUE(cameraFault(waves(2), right).starts_with("shows another view"));
}

TEST(CameraFault, AllowsWhatRenderersDifferIn) {
  Frame other = waves(1, {0.05f, 0.0f});
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0.0f, 0.03f);
  for (glm::vec4& pixel : other.rgba) pixel = 1.03f * pixel + noise(random);
  EXPECT_EQ(cameraFault(other, waves(1)), "");
}

TEST(ReadImage, GivesWrittenImagesBack) {
  const TemporaryFolder folder;
  Frame frame = waves(1);
  frame.rgba[5] = {2.5f, -0.25f, 0.0f, 1.0f};
  writeImage(folder.path() / "a.exr", frame);
  EXPECT_EQ(readImage(folder.path() / "a.exr").rgba, frame.rgba);
  writeImage(folder.path() / "a.png", frame);
  const Frame read = readImage(folder.path() / "a.png");
  ASSERT_EQ(read.size_px, frame.size_px);
  const glm::vec4 shown = glm::clamp(frame.rgba[70], 0.0f, 1.0f);
  EXPECT_NEAR(glm::distance(read.rgba[70], shown), 0.0f, 0.01f);  // 8 bits
  EXPECT_EQ(read.rgba[5], glm::vec4(1.0f, 0.0f, 0.0f, 1.0f));
  writeMap(folder.path() / "b.exr", frame.size_px, std::vector<float>(frame.rgba.size(), 3.5f));
  EXPECT_EQ(readImage(folder.path() / "b.exr").rgba[9], glm::vec4(3.5f, 3.5f, 3.5f, 1.0f));
}

TEST(ReadImage, RefusesOtherFilesInOneLine) {
  const TemporaryFolder folder;
  folder.write("a.exr", "no image");
  folder.write("a.png", "\x89PNG");
  folder.write("a.jpg", "");
  Frame nan = waves(1);
  nan.rgba[7].g = std::nanf("");
  writeImage(folder.path() / "nan.exr", nan);
  for (const char* name : {"a.exr", "a.png", "a.jpg", "none.png", "nan.exr", "."}) {
    EXPECT_THROW(readImage(folder.path() / name), InputError) << name;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
