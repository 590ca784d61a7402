// Points and Gaussians of glTF against the values of the specification.
#include "render/scene/io/mesh_formats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "base/base64.h"
#include "base/input_error.h"
#include "render/scene/harmonics.h"
#include "render/scene/io/open_scene.h"
#include "tests/temporary_folder.h"
#include "tests/unit/render/scene/io/gaussian_files_ply.h"
#include "tests/unit/render/scene/io/gaussian_files_spz.h"

namespace foci {
namespace FOCI_FILE {

using Json = nlohmann::ordered_json;

/// A glTF as text, with its buffer in it.
class GltfText {
 public:
  /// @return the number of the view
  std::size_t addView(const std::string& bytes) {
    while (buffer_.size() % 4 != 0) buffer_ += '\0';
    views_.push_back({{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", bytes.size()}});
    buffer_ += bytes;
    return views_.size() - 1;
  }

  std::size_t addFloats(const std::vector<float>& values, const std::string& type) {
    const std::size_t each = type == "SCALAR" ? 1 : type == "VEC3" ? 3 : 4;
    std::string bytes(reinterpret_cast<const char*>(values.data()), 4 * values.size());
    accessors_.push_back({{"bufferView", addView(bytes)},
                          {"componentType", 5126},
                          {"count", values.size() / each},
                          {"type", type}});
    return accessors_.size() - 1;
  }

  Json primitives = Json::array();
  Json node = {{"mesh", 0}};

  std::string text() const {
    std::ostringstream uri;
    uri << "data:application/octet-stream;base64,";
    Base64 base64(uri);
    base64.add(reinterpret_cast<const std::uint8_t*>(buffer_.data()), buffer_.size());
    base64.finish();
    return Json({{"asset", {{"version", "2.0"}}},
                 {"buffers", {{{"byteLength", buffer_.size()}, {"uri", uri.str()}}}},
                 {"bufferViews", views_},
                 {"accessors", accessors_},
                 {"meshes", {{{"primitives", primitives}}}},
                 {"nodes", {node}},
                 {"scenes", {{{"nodes", {0}}}}},
                 {"scene", 0}})
        .dump();
  }

 private:
  std::string buffer_;
  Json views_ = Json::array(), accessors_ = Json::array();
};

/// The two Gaussians of the other formats, with linear scales and opacities.
void addGaussians(GltfText& gltf, int degree, const Json& extension) {
  const float dc[3] = {(kColor.r - 0.5f) / kHarmonic0, (kColor.g - 0.5f) / kHarmonic0,
                       (kColor.b - 0.5f) / kHarmonic0};
  const std::string name = "KHR_gaussian_splatting:";
  Json attributes = {
      {"POSITION", gltf.addFloats({kPosition.x, kPosition.y, kPosition.z, kPosition.x, kPosition.y,
                                   kPosition.z + 1.0f},
                                  "VEC3")},
      {name + "ROTATION", gltf.addFloats({0, 0, kHalf, kHalf, 0, 0, kHalf, kHalf}, "VEC4")},
      {name + "SCALE",
       gltf.addFloats({kSigma.x, kSigma.y, kSigma.z, kSigma.x, kSigma.y, kSigma.z}, "VEC3")},
      {name + "OPACITY", gltf.addFloats({kOpacity, kOpacity}, "SCALAR")},
      {name + "SH_DEGREE_0_COEF_0",
       gltf.addFloats({dc[0], dc[1], dc[2], dc[0], dc[1], dc[2]}, "VEC3")}};
  for (int l = 1, k = 0; l <= degree; ++l) {
    for (int order = 0; order <= 2 * l; ++order, ++k) {
      std::vector<float> values;
      for (int i = 0; i < 2; ++i) {
        for (int channel = 0; channel < 3; ++channel) values.push_back(coefficient(channel, k));
      }
      attributes[name + "SH_DEGREE_" + std::to_string(l) + "_COEF_" + std::to_string(order)] =
          gltf.addFloats(values, "VEC3");
    }
  }
  gltf.primitives.push_back({{"attributes", attributes},
                             {"mode", 0},
                             {"extensions", {{"KHR_gaussian_splatting", extension}}}});
}

const Json kEllipse = {{"kernel", "ellipse"}, {"colorSpace", "srgb_rec709_display"}};

class GltfPointsTest : public testing::Test {
 protected:
  GltfPoints read(const GltfText& gltf) {
    return readGltfPoints(GltfDocument(scratch.write("a.gltf", gltf.text())));
  }
  std::string refusal(const GltfText& gltf) {
    try {
      read(gltf);
    } catch (const InputError& error) {
      return error.what();
    }
    return "read";
  }
  const TemporaryFolder scratch;
};

TEST_F(GltfPointsTest, GaussiansHaveTheValuesOfTheirAttributes) {
  for (int degree = 0; degree <= 3; ++degree) {
    GltfText gltf;
    addGaussians(gltf, degree, kEllipse);
    const auto found = read(gltf);
    ASSERT_TRUE(found.gaussians && !found.points && !found.has_triangles);
    const GaussianFile& file = *found.gaussians;
    const GaussianCloud& cloud = file.cloud;
    ASSERT_EQ(cloud.size(), 2u);
    EXPECT_TRUE(file.y_is_up);
    EXPECT_EQ(file.unit_m, 1.0);
    EXPECT_EQ(cloud.position_m[0], kPosition);
    EXPECT_FLOAT_EQ(cloud.opacity[1], kOpacity);
    EXPECT_NEAR(cloud.color[0].r, kColor.r, 1e-6f);
    const Covariance3 expected = covarianceOf(kSigma, kRotation);
    EXPECT_NEAR(cloud.covariance_m2[0].xx, expected.xx, 1e-7f);
    EXPECT_NEAR(cloud.covariance_m2[0].xy, expected.xy, 1e-7f);
    EXPECT_NEAR(cloud.covariance_m2[0].zz, expected.zz, 1e-7f);
    ASSERT_EQ(cloud.degree, degree);
    for (std::size_t k = 0; k < cloud.harmonicsPerGaussian(); ++k) {
      EXPECT_NEAR(kHarmonicsStep * cloud.harmonics[k],
                  coefficient(static_cast<int>(k % 3), static_cast<int>(k / 3)), kHarmonicsStep);
    }
    EXPECT_TRUE(file.remarks.empty());
  }
}

TEST_F(GltfPointsTest, NodesPlaceGaussians) {
  GltfText gltf;
  addGaussians(gltf, 2, kEllipse);
  const GaussianCloud base = read(gltf).gaussians->cloud;
  // A quarter turn about y takes z to x and x to -z.
  gltf.node["rotation"] = {0.0, kHalf, 0.0, kHalf};
  gltf.node["translation"] = {10.0, 20.0, 30.0};
  gltf.node["scale"] = {2.0, 2.0, 2.0};
  const GaussianCloud cloud = read(gltf).gaussians->cloud;
  const auto turned = [](const glm::vec3& v) { return glm::vec3(v.z, v.y, -v.x); };
  EXPECT_LT(glm::distance(cloud.position_m[0], 2.0f * turned(kPosition) + glm::vec3(10, 20, 30)),
            1e-4f);
  EXPECT_NEAR(cloud.covariance_m2[0].xx, 4.0f * base.covariance_m2[0].zz, 1e-5f);
  EXPECT_NEAR(cloud.covariance_m2[0].zz, 4.0f * base.covariance_m2[0].xx, 1e-5f);
  const glm::vec3 d(0.48f, 0.6f, 0.64f);
  EXPECT_LT(glm::distance(colorOf(cloud, 0, turned(d)), colorOf(base, 0, d)), 5e-3f);
}

TEST_F(GltfPointsTest, GaussiansMayBePackedBySpz) {
  for (const char* name :
       {"KHR_gaussian_splatting_compression_spz", "KHR_gaussian_splatting_compression_spz_2"}) {
    GltfText gltf;
    const std::size_t view = gltf.addView(gzipped(spzFile(3, 1)));
    Json extension = kEllipse;
    extension["extensions"] = {{name, {{"bufferView", view}}}};
    gltf.primitives.push_back({{"attributes", Json::object()},
                               {"mode", 0},
                               {"extensions", {{"KHR_gaussian_splatting", extension}}}});
    const auto found = read(gltf);
    ASSERT_TRUE(found.gaussians);
    EXPECT_EQ(found.gaussians->cloud.degree, 1);
    EXPECT_LT(glm::distance(found.gaussians->cloud.position_m[0], kPosition), 1e-3f);
  }
}

TEST_F(GltfPointsTest, DraftsAndLinearColoursAreToldApart) {
  GltfText gltf;
  Json linear = kEllipse;
  linear["colorSpace"] = "lin_rec709_display";
  addGaussians(gltf, 0, linear);
  const GaussianFile file = *read(gltf).gaussians;
  EXPECT_NEAR(file.cloud.color[0].g, 0.735f, 1e-3f);  // sRGB of 0.5
  ASSERT_EQ(file.remarks.size(), 1u);
  EXPECT_NE(file.remarks[0].find("colours are linear"), std::string::npos);
}

TEST_F(GltfPointsTest, MissingAttributesAreNamed) {
  GltfText gltf;
  addGaussians(gltf, 1, kEllipse);
  for (const char* name :
       {"ROTATION", "SCALE", "OPACITY", "SH_DEGREE_0_COEF_0", "SH_DEGREE_1_COEF_1"}) {
    GltfText without = gltf;
    const std::string whole = std::string("KHR_gaussian_splatting:") + name;
    without.primitives[0]["attributes"].erase(whole);
    EXPECT_NE(refusal(without).find("expected the attribute " + whole), std::string::npos);
  }
  GltfText fewer = gltf;
  fewer.primitives[0]["attributes"]["KHR_gaussian_splatting:OPACITY"] =
      fewer.addFloats({1.0f}, "SCALAR");
  EXPECT_NE(refusal(fewer).find("cannot be read"), std::string::npos);
}

TEST_F(GltfPointsTest, PointsHaveLinearColours) {
  GltfText gltf;
  gltf.primitives.push_back(
      {{"attributes",
        {{"POSITION", gltf.addFloats({0, 0, 0, 1, 2, 3}, "VEC3")},
         {"COLOR_0", gltf.addFloats({1, 0, 0, 1, 0.25f, 0.5f, 1, 0.5f}, "VEC4")}}},
       {"mode", 0}});
  gltf.node["translation"] = {0.0, 1.0, 0.0};
  SceneFile scene = readScene(scratch.write("p.gltf", gltf.text()));
  const auto* const points = std::get_if<PointCloud>(&scene.content);
  ASSERT_NE(points, nullptr);
  EXPECT_EQ(points->position_m[1], glm::vec3(1, 3, 3));
  EXPECT_EQ(points->color[1], glm::vec3(0.25f, 0.5f, 1.0f));
  EXPECT_EQ(points->opacity[1], 0.5f);
  const SceneFacts facts = factsOf(scene);
  EXPECT_EQ(nameOf(facts), "glTF points");
  EXPECT_EQ(facts.unit_m, 1.0);
  EXPECT_EQ(facts.kind, SceneKind::gltf);
}

TEST_F(GltfPointsTest, TheirMaterialTintsPoints) {
  GltfText gltf;
  gltf.primitives.push_back(
      {{"attributes", {{"POSITION", gltf.addFloats({0, 0, 0, 1, 2, 3}, "VEC3")}}},
       {"mode", 0},
       {"material", 0}});
  const auto colorOf = [&] {
    Json whole = Json::parse(gltf.text());
    whole["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1.0, 0.5, 0.0, 1.0}}}}}};
    const SceneFile scene = readScene(scratch.write("p.gltf", whole.dump()));
    return std::get<PointCloud>(scene.content).color.at(0);
  };
  EXPECT_EQ(colorOf(), glm::vec3(1.0f, 0.5f, 0.0f));
  gltf.primitives[0]["attributes"]["COLOR_0"] = gltf.addFloats({0.5f, 0.5f, 0.5f, 1, 1, 1}, "VEC3");
  EXPECT_EQ(colorOf(), glm::vec3(0.5f, 0.25f, 0.0f));
}

TEST_F(GltfPointsTest, AMeshAndPointsBesideGaussiansAreInTheScene) {
  GltfText gltf;
  addGaussians(gltf, 0, kEllipse);
  gltf.primitives.push_back(
      {{"attributes", {{"POSITION", gltf.addFloats({5, 0, 0, 5, 1, 0, 5, 0, 1}, "VEC3")}}},
       {"mode", 0}});
  gltf.primitives.push_back(
      {{"attributes", {{"POSITION", gltf.addFloats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3")}}}});
  SceneFile scene = readScene(scratch.write("both.gltf", gltf.text()));
  const SceneFacts facts = factsOf(scene);
  EXPECT_EQ(facts.gaussians, 2u);
  EXPECT_EQ(facts.triangles, 1u);
  EXPECT_EQ(facts.points, 3u);
  EXPECT_TRUE(facts.remarks.empty());
  const OpenedScene opened = openScene(std::move(scene), 2.0, {});
  ASSERT_TRUE(opened.scene.gaussians());
  EXPECT_GT(opened.scene.gaussians()->size(), 100u);
  float farthest_m = 0.0f;
  for (const glm::vec3& p : opened.scene.gaussians()->position_m) {
    farthest_m = std::max(farthest_m, p.x);
  }
  EXPECT_EQ(farthest_m, 10.0f);
}

TEST_F(GltfPointsTest, LinesAloneAreRefusedAsLines) {
  GltfText gltf;
  gltf.primitives.push_back(
      {{"attributes", {{"POSITION", gltf.addFloats({0, 0, 0, 1, 0, 0}, "VEC3")}}}, {"mode", 1}});
  try {
    readScene(scratch.write("lines.gltf", gltf.text()));
    FAIL() << "read";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("holds lines"), std::string::npos) << error.what();
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
