#include "render/scene/io/scene_facts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "base/input_error.h"
#include "render/image/srgb.h"
#include "render/scene/io/foci_file.h"
#include "render/scene/io/open_scene.h"
#include "render/scene/mesh/sample_mesh.h"
#include "tests/temporary_folder.h"
#include "tests/unit/render/scene/io/read_mesh.h"

namespace foci {
namespace FOCI_FILE {

/// A quad of 2 x 1 units in the xy plane, with centimetres as units and z upwards.
constexpr const char* kQuadFbx = R"(; FBX 7.4.0 project file
FBXHeaderExtension:  {
	FBXHeaderVersion: 1003
	FBXVersion: 7400
}
GlobalSettings:  {
	Version: 1000
	Properties70:  {
		P: "UpAxis", "int", "Integer", "",2
		P: "UnitScaleFactor", "double", "Number", "",1
	}
}
Objects:  {
	Geometry: 100, "Geometry::quad", "Mesh" {
		Vertices: *12 {
			a: 0,0,0,2,0,0,2,1,0,0,1,0
		}
		PolygonVertexIndex: *4 {
			a: 0,1,2,-4
		}
		GeometryVersion: 124
	}
	Model: 200, "Model::quad", "Mesh" {
		Version: 232
	}
}
Connections:  {
	C: "OO",200,0
	C: "OO",100,200
}
)";

SceneFacts factsIn(const std::filesystem::path& path) { return factsOf(readScene(path)); }

class Facts : public testing::Test {
 protected:
  const TemporaryFolder scratch;
};

TEST_F(Facts, OfAMeshAreItsTrianglesMaterialsAndCorners) {
  cv::imwrite((scratch.path() / "planks.png").string(), cv::Mat(4, 4, CV_8UC3, cv::Scalar(9)));
  scratch.write("q.mtl",
                "newmtl wood\nmap_Kd planks.png\nnewmtl glass\nKd 1 1 1\nd 0.25\nnewmtl tin\n"
                "map_Kd lost.png\n");
  const SceneFacts facts = factsIn(scratch.write(
      "q.obj",
      "mtllib q.mtl\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 5\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
      "vn 0 0 1\nusemtl wood\nf 1/1/1 2/2/1 3/3/1 4/4/1\nusemtl glass\nf 1/1/1 2/2/1 3/3/1\n"
      "usemtl tin\nf 1/1/1 2/2/1 4/4/1\n"));
  EXPECT_EQ(facts.kind, SceneKind::obj);
  EXPECT_EQ(facts.triangles, 4u);
  EXPECT_TRUE(facts.has_normals && facts.has_colors && facts.isMesh());
  EXPECT_EQ(facts.opacity, glm::vec2(0.25f, 1.0f));
  EXPECT_FALSE(facts.unit_m || facts.up_axis);
  const auto materialNamed = [&](const std::string& name) {
    for (const MaterialFacts& material : facts.materials) {
      if (material.name == name) return material;
    }
    ADD_FAILURE() << name;
    return MaterialFacts{};
  };
  ASSERT_EQ(materialNamed("wood").textures.size(), 1u);
  EXPECT_TRUE(materialNamed("wood").textures[0].found);
  EXPECT_FALSE(materialNamed("tin").textures.at(0).found);
  EXPECT_FLOAT_EQ(materialNamed("glass").opacity, 0.25f);
  float high = 0.0f;
  for (const glm::vec3& p : facts.position) high = std::max(high, p.z);
  EXPECT_EQ(high, 5.0f);
}

TEST_F(Facts, OfFbxStateUnitsAndUpAxis) {
#ifndef FOCI_FBX
  GTEST_SKIP() << "built without Assimp";
#endif
  const auto file = scratch.write("q.fbx", kQuadFbx);
  const SceneFacts facts = factsIn(file);
  EXPECT_EQ(facts.kind, SceneKind::fbx);
  EXPECT_EQ(facts.triangles, 2u);
  EXPECT_EQ(facts.unit_m, 0.01);
  EXPECT_EQ(facts.up_axis, 2);
  const PointCloud points = sampleMesh(readMesh(file).mesh, file, {.points = 400});
  ASSERT_GT(points.size(), 300u);
  for (const glm::vec3& p : points.position_m) {
    ASSERT_TRUE(p.x >= -1e-4f && p.x <= 2.0001f && p.y >= -1e-4f && p.y <= 1.0001f)
        << p.x << " " << p.y << " " << p.z;
  }
}

constexpr const char* kMaterialLayerFbx = R"(LayerElementMaterial: 0 {
MappingInformationType: "AllSame"
ReferenceInformationType: "IndexToDirect"
Materials: *1 {
a: 0
}
}
Layer: 0 {
LayerElement:  {
Type: "LayerElementMaterial"
TypedIndex: 0
}
}
)";
constexpr const char* kMaterialFbx = R"(Material: 300, "Material::m", "" {
ShadingModel: "unknown"
Properties70:  {
P: "COLOR", "Vector3D", "Vector", "",1,0,0
}
}
Texture: 400, "Texture::t", "" {
RelativeFilename: "t.png"
}
)";

TEST_F(Facts, OfAnFbxHavePhysicallyBasedColours) {
#ifndef FOCI_FBX
  GTEST_SKIP() << "built without Assimp";
#endif
  cv::imwrite((scratch.path() / "t.png").string(), cv::Mat(4, 4, CV_8UC3, cv::Scalar(255, 0, 0)));
  const auto colorOf = [&](const std::string& property, const std::string& map,
                           const std::string& creator = "") {
    std::string text = kQuadFbx, material = kMaterialFbx;
    material.replace(material.find("COLOR"), 5, property);
    if (!creator.empty()) {
      material.replace(material.find("1,0,0"), 5, "0.5,0,0");
      text.insert(text.find("\tFBXVersion"), "\tCreator: \"" + creator + "\"\n");
    }
    text.insert(text.find("\t}\n\tModel: 200"), kMaterialLayerFbx);
    text.insert(text.find("\tModel: 200"), material);
    text.insert(text.find("\tC: \"OO\",200,0"),
                "C: \"OO\",300,200\nC: \"OP\",400,300, \"" + map + "\"\n");
    return colorAt(readMesh(scratch.write("p.fbx", text)).mesh, {0, glm::vec2(0.25f)}, 0.0f).color;
  };
  EXPECT_EQ(colorOf("Maya|baseColor", "Bump"), glm::vec3(1, 0, 0));
  EXPECT_EQ(colorOf("Maya|baseColor", "Maya|baseColor"), glm::vec3(0, 0, 1));
  EXPECT_EQ(colorOf("3dsMax|Parameters|base_color", "3dsMax|Parameters|base_color_map"),
            glm::vec3(0, 0, 1));
  constexpr const char* kBlender = "Blender (stable FBX IO) - 3.4.1 - 4.37.1";
  EXPECT_FLOAT_EQ(colorOf("DiffuseColor", "Bump", "Maya").x, linearFromSrgb(0.5f));
  EXPECT_FLOAT_EQ(colorOf("DiffuseColor", "Bump", kBlender).x, 0.5f);
}

TEST_F(Facts, OfAPlyOfBlenderHaveItsUpAxis) {
  const auto up = [&](const std::string& comment) {
    return factsIn(scratch.write("m.ply", "ply\nformat ascii 1.0\ncomment " + comment +
                                              "\nelement vertex 3\nproperty float x\n"
                                              "property float y\nproperty float z\nelement face 1\n"
                                              "property list uchar int vertex_indices\nend_header\n"
                                              "0 0 0\n1 0 0\n0 1 1\n3 0 1 2\n"))
        .up_axis;
  };
  EXPECT_EQ(up("Created by Blender 3.4.1 - www.blender.org"), 2);
  EXPECT_EQ(up("Created in Blender version 4.2.0"), 2);
  EXPECT_EQ(up("VCGLIB generated"), std::nullopt);
}

constexpr const char* kSkinFbx = R"(Deformer: 500, "Deformer::", "Skin" {
}
Deformer: 501, "SubDeformer::", "Cluster" {
Indexes: *4 {
a: 0,1,2,3
}
Weights: *4 {
a: 1,1,1,1
}
Transform: *16 {
a: 1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1
}
TransformLink: *16 {
a: 1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1
}
}
Model: 600, "Model::bone", "LimbNode" {
Properties70:  {
P: "Lcl Translation", "Lcl Translation", "", "A",5,0,0
}
}
)";

TEST_F(Facts, OfAnFbxHaveThePoseOfTheBones) {
#ifndef FOCI_FBX
  GTEST_SKIP() << "built without Assimp";
#endif
  std::string text = kQuadFbx;
  text.insert(text.find("\tModel: 200"), kSkinFbx);
  text.insert(text.find("\tC: \"OO\",200,0"),
              "C: \"OO\",600,0\nC: \"OO\",500,100\nC: \"OO\",501,500\nC: \"OO\",600,501\n");
  const TriangleMesh mesh = readMesh(scratch.write("s.fbx", text)).mesh;
  ASSERT_EQ(mesh.size(), 2u);
  for (const glm::vec3& p : mesh.corners_m) EXPECT_TRUE(p.x >= 5.0f && p.x <= 7.0f) << p.x;
}

TEST_F(Facts, OfPointsAndPreparedScenes) {
  const SceneFacts facts =
      factsIn(scratch.write("p.xyz", "0 0 0 255 0 0\n1 2 3 0 0 255\nnan 0 0 0 0 0\n"));
  EXPECT_EQ(facts.kind, SceneKind::text_points);
  EXPECT_EQ(facts.points, 2u);
  EXPECT_EQ(facts.dropped, 1u);
  EXPECT_TRUE(facts.has_colors);
  EXPECT_FALSE(facts.has_normals || facts.isMesh());

  SurfelCloud cloud;
  appendSurfel(cloud, {1.0f, 2.0f, 3.0f}, {0.0f, 0.0f, 1.0f}, 0.1f, 0.02f, glm::vec3(0.5f), 0.5f);
  writeSceneFile(scratch.path() / "scene.foci", {cloud});
  const SceneFacts prepared = factsIn(scratch.path() / "scene.foci");
  EXPECT_EQ(prepared.surfels, 1u);
  EXPECT_EQ(prepared.unit_m, 1.0);
  EXPECT_EQ(prepared.opacity, glm::vec2(0.5f));
  EXPECT_EQ(prepared.position.at(0), glm::vec3(1, 2, 3));
  EXPECT_TRUE(prepared.has_colors && !prepared.up_axis && !prepared.samples_of_mesh);

  writeSceneFile(scratch.path() / "mesh.foci",
                 {cloud, {.mesh = true, .plain_colors = true, .up_axis = 1}});
  const SceneFacts plain = factsIn(scratch.path() / "mesh.foci");
  EXPECT_TRUE(plain.samples_of_mesh && !plain.has_colors && !plain.material_colors);
  EXPECT_EQ(plain.up_axis, 1);
}

TEST_F(Facts, OfNothingAreRefused) {
  EXPECT_THROW(factsIn(scratch.path() / "absent.obj"), InputError);
  EXPECT_THROW(factsIn(scratch.write("empty.obj", "")), InputError);
  EXPECT_THROW(factsIn(scratch.write("texture.obj", "vt 0 0\nvt 1 0\n")), InputError);
  EXPECT_THROW(factsIn(scratch.write("broken.fbx", "Kaydara FBX Binary  ")), InputError);
}

}  // namespace FOCI_FILE
}  // namespace foci
