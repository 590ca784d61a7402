#include "render/scene/io/mesh_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

class MeshCompanions : public testing::Test {
 protected:
  std::set<std::string> namesOf(const std::string& mesh) const {
    std::set<std::string> names;
    for (const auto& file : meshCompanions(folder_.path() / mesh)) names.insert(file.filename());
    return names;
  }

  const TemporaryFolder folder_;
};

TEST_F(MeshCompanions, OfAnObjAreMaterialsAndTheirTextures) {
  for (const char* name : {"one.mtl", "my wood.png", "b.png", "c.png", "other.png"}) {
    folder_.write(name, "");
  }
  folder_.write("one.mtl",
                "newmtl m\r\n map_Kd my wood.png\r\nmap_Ks -s 1 1 1 b.png\nbump .\\c.png\n");
  folder_.write("m.obj", "mtllib one.mtl\nmtllib absent.mtl\nv 0 0 0\nusemtl other.png\n");
  EXPECT_EQ(namesOf("m.obj"), (std::set<std::string>{"one.mtl", "my wood.png", "b.png", "c.png"}));
}

TEST_F(MeshCompanions, OfAGltfAreBuffersAndImages) {
  for (const char* name : {"a b.bin", "c.png", "other.png"}) folder_.write(name, "");
  folder_.write("m.gltf", R"({"buffers":[{"uri":"a%20b.bin"},{"uri":"data:,x"},{},4],)"
                          R"("images":[{"uri":"c.png"},{"uri":"absent.png"},{"uri":7}],)"
                          R"("extras":[{"uri":"other.png"}]})");
  EXPECT_EQ(namesOf("m.gltf"), (std::set<std::string>{"a b.bin", "c.png"}));
}

TEST_F(MeshCompanions, OfWhatCannotBeReadAreNone) {
  folder_.write("broken.gltf", "{\"buffers\":");
  folder_.write("points.ply", "ply\n");
  for (const char* name : {"broken.gltf", "points.ply", "absent.obj", "absent.glb"}) {
    EXPECT_TRUE(namesOf(name).empty()) << name;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
