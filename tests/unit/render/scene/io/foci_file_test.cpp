#include "render/scene/io/foci_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

class FociFileTest : public testing::Test {
 protected:
  FociFileTest() {
    path_ = std::filesystem::temp_directory_path() /
            ("foci_file_test_" + std::to_string(getpid()) + "_" +
             testing::UnitTest::GetInstance()->current_test_info()->name() + ".foci");
  }
  ~FociFileTest() override { std::filesystem::remove(path_); }

  std::string written(const SurfelCloud& cloud) {
    writeSceneFile(path_, {{cloud}});
    std::ifstream in(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  /// The one line of the refusal, without the path; "" where the file was accepted.
  std::string refusal(const std::string& content) {
    std::ofstream(path_, std::ios::binary) << content;
    try {
      readSceneFile(path_);
    } catch (const InputError& error) {
      const std::string what = error.what();
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      EXPECT_EQ(what.find(path_.string()), 0u) << what;
      return what.substr(path_.string().size());
    }
    return "";
  }

  std::filesystem::path path_;
};

SurfelCloud few(bool with_opacity) {
  SurfelCloud cloud;
  for (int i = 0; i < 3; ++i) {
    const auto x = static_cast<float>(i);
    appendSurfel(cloud, {x, 0.1f * x, -1.0f}, {0.6f, 0.0f, 0.8f}, 0.01f + 0.001f * x, 0.002f,
                 {0.1f * x, 0.5f, 2.0f}, with_opacity ? 0.1f * x : 1.0f);
  }
  cloud.oriented = with_opacity;
  return cloud;
}

TEST_F(FociFileTest, BringsBackTheOrigin) {
  for (const SurfelOrigin& origin : {SurfelOrigin{}, SurfelOrigin{.mesh = true},
                                     SurfelOrigin{.plain_colors = true, .up_axis = 0},
                                     SurfelOrigin{.mesh = true, .plain_colors = true, .up_axis = 2},
                                     SurfelOrigin{.up_axis = 1, .y_is_down = true}}) {
    writeSceneFile(path_, {{few(true)}, origin});
    EXPECT_EQ(readSceneFile(path_).origin, origin);
  }
}

TEST_F(FociFileTest, BringsBackWhatWasWritten) {
  for (const bool with_opacity : {false, true}) {
    const SurfelCloud cloud = few(with_opacity);
    writeSceneFile(path_, {{cloud}});
    EXPECT_TRUE(isSceneFile(path_));
    const auto back = std::get<SurfelCloud>(readSceneFile(path_).scene.splats);
    EXPECT_EQ(back.position_m, cloud.position_m);
    EXPECT_EQ(back.axis_u_m, cloud.axis_u_m);
    EXPECT_EQ(back.axis_v_m, cloud.axis_v_m);
    EXPECT_EQ(back.color, cloud.color);
    EXPECT_EQ(back.area_m2, cloud.area_m2);
    EXPECT_EQ(back.opacity, cloud.opacity);
    EXPECT_EQ(back.oriented, cloud.oriented);
  }
}

TEST_F(FociFileTest, RefusesTruncationAtEveryByte) {
  const std::string whole = written(few(true));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_NE(refusal(whole.substr(0, size)), "") << size << " bytes of " << whole.size();
  }
  EXPECT_NE(refusal(whole + '\0').find("too long"), std::string::npos);
}

TEST_F(FociFileTest, RefusesEveryAlteredByte) {
  const std::string whole = written(few(true));
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string altered = whole;
    altered[at] = static_cast<char>(altered[at] ^ (1 << at % 8));
    EXPECT_NE(refusal(altered), "") << "byte " << at;
  }
}

/// A hundred surfels on a wave, of two bodies and three objects.
SurfelCloud wave() {
  SurfelCloud cloud;
  for (int i = 0; i < 100; ++i) {
    const float x = 0.01f * static_cast<float>(i * 37 % 100);
    appendSurfel(cloud, {x, 0.1f * std::sin(9.0f * x), -1.0f - x * x}, {0.6f, 0.0f, 0.8f}, 0.006f,
                 1e-4f, {x, 0.5f, 1.0f - x});
    cloud.bodies.of_surfel.push_back(i % 3 == 0 ? 2 : 1);
    cloud.objects.of.push_back(static_cast<std::uint16_t>(i % 4));
  }
  cloud.oriented = true;
  cloud.objects.names = {"", "a", "b", "c"};
  completeBodies(cloud);
  return cloud;
}

template <typename T>
bool sameBytes(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

TEST_F(FociFileTest, BringsBackTheTreeWithBodiesAndObjects) {
  const SurfelCloud sorted = withTree(wave());
  const std::string whole = written(wave());
  EXPECT_EQ(whole[8], 4);  // the version
  const auto read = std::get<SurfelCloud>(readSceneFile(path_).scene.splats);
  EXPECT_EQ(read.position_m, sorted.position_m);
  EXPECT_EQ(read.bodies.of_surfel, sorted.bodies.of_surfel);
  ASSERT_EQ(read.bodies.boxes.size(), 3u);
  EXPECT_EQ(read.bodies.boxes[2].low_m, sorted.bodies.boxes[2].low_m);
  EXPECT_EQ(read.objects.of, sorted.objects.of);
  EXPECT_EQ(read.objects.names, sorted.objects.names);
  ASSERT_TRUE(builtTree(read));
  EXPECT_EQ(builtTree(read)->levels(), builtTree(sorted)->levels());
  EXPECT_TRUE(sameBytes(builtTree(read)->nodes(), builtTree(sorted)->nodes()));
  EXPECT_TRUE(sameBytes(builtTree(read)->coarseness(), builtTree(sorted)->coarseness()));
  EXPECT_TRUE(sameBytes(builtTree(read)->facing(), builtTree(sorted)->facing()));
  EXPECT_EQ(builtTree(read)->surfels().color, sorted.color);
  for (std::size_t at = 8; at < whole.size(); at += 61) {
    std::string altered = whole;
    altered[at] = static_cast<char>(altered[at] ^ (1 << at % 8));
    EXPECT_NE(refusal(altered), "") << "byte " << at;
  }
}

TEST_F(FociFileTest, ASceneFromAFileIsWrittenAgainAsItWas) {
  const std::string first = written(wave());
  const PreparedScene read = readSceneFile(path_);
  const TemporaryFolder folder;
  writeSceneFile(folder.path() / "again.foci", read);
  EXPECT_EQ(folder.read("again.foci"), first);
}

TEST_F(FociFileTest, RefusesSurfelsWithoutATree) {
  SurfelCloud cloud = wave();
  writeFoci(path_, {.version = 1, .count = cloud.size()},
            {bytesOf(cloud.position_m), bytesOf(cloud.axis_u_m), bytesOf(cloud.axis_v_m),
             bytesOf(cloud.color), bytesOf(cloud.area_m2)});
  EXPECT_THROW(readSceneFile(path_), InputError);
}

/// Held against the surfels below each node.
void expectTreeOf(const SurfelCloud& cloud) {
  const MomentTree& tree = *builtTree(cloud);
  for (int level = 0; level < tree.levels(); ++level) {
    for (std::size_t j = 0; j < std::size_t{1} << level; ++j) {
      const LodNode& node = tree.nodes()[(std::size_t{1} << level) + j];
      const auto [begin, end] = tree.range(level, j);
      glm::dvec3 mean(0.0);
      double area = 0.0;
      for (std::size_t i = begin; i < end; ++i) {
        mean += double{cloud.area_m2[i]} * glm::dvec3(cloud.position_m[i]);
        area += cloud.area_m2[i];
        EXPECT_LE(glm::distance(node.position_m, cloud.position_m[i]), node.radius_m);
      }
      EXPECT_LT(glm::distance(glm::dvec3(node.position_m), mean / area), 1e-6);
    }
  }
}

TEST_F(FociFileTest, PartsMakeOneTree) {
  constexpr int kLevel = 3;
  constexpr std::size_t kPart = 50;
  const auto part = [](std::size_t j) {
    SurfelCloud cloud;
    for (std::size_t i = 0; i < kPart; ++i) {
      const float x = static_cast<float>(j) + static_cast<float>(i * 17 % kPart) / kPart;
      appendSurfel(cloud, {x, 0.2f * std::sin(3.0f * x), -2.0f}, {0.0f, 0.0f, 1.0f}, 0.01f, 4e-4f,
                   {0.5f, 0.1f * x, 0.2f});
    }
    return cloud;
  };
  SurfelFileWriter writer(path_, kPart << kLevel, kLevel, {}, {.up_axis = 1});
  for (const std::size_t j : {3, 0, 1, 2, 7, 6, 5, 4}) writer.add(j, MomentTree(part(j)));
  writer.finish();
  const PreparedScene read = readSceneFile(path_);
  EXPECT_EQ(read.origin.up_axis, 1);
  ASSERT_EQ(read.scene.size(), kPart << kLevel);
  expectTreeOf(*read.scene.surfels());
}

TEST_F(FociFileTest, ALargeSceneIsCheckedOnRequestOnly) {
  std::string altered = written(wave());
  altered[100] = static_cast<char>(altered[100] ^ 1);
  std::ofstream(path_, std::ios::binary) << altered;
  EXPECT_THROW(readSceneFile(path_), InputError);
  EXPECT_THROW(readSceneFile(path_, kCheckAll_B), InputError);
  const auto read = std::get<SurfelCloud>(readSceneFile(path_, 100).scene.splats);
  EXPECT_EQ(read.size(), 100u);
  // No number that the file may hold leads beyond the boxes.
  EXPECT_EQ(read.bodies.boxes.size(), 65536u);
}

TEST_F(FociFileTest, RefusesSwappedBytes) {
  const std::string whole = written(few(true));
  for (std::size_t at = 64; at + 16 <= whole.size(); at += 4) {
    std::string altered = whole;
    std::swap_ranges(altered.begin() + at, altered.begin() + at + 8, altered.begin() + at + 8);
    EXPECT_EQ(refusal(altered) == "", altered == whole) << "byte " << at;
  }
}

TEST_F(FociFileTest, SaysWhatIsWrong) {
  const std::string whole = written(few(true));
  std::string later = whole;
  later[8] = 5;
  EXPECT_EQ(refusal(later),
            ": is of version 5: this program reads versions 2 and 4; foci prepare "
            "makes it again");
  std::string as_text = whole;
  as_text.erase(4, 1);
  EXPECT_EQ(refusal(as_text), ": was altered, as by a transfer as text");
  EXPECT_EQ(refusal(""), ": is not a .foci scene");
  EXPECT_EQ(refusal("ply\nformat ascii 1.0\n"), ": is not a .foci scene");
  EXPECT_EQ(refusal(whole.substr(0, 100)),
            ": is cut short: 100 bytes of " + std::to_string(whole.size()));
  std::filesystem::remove(path_);
  EXPECT_FALSE(isSceneFile(path_));
  EXPECT_THROW(readSceneFile(path_), InputError);
  EXPECT_THROW(readSceneFile(path_.parent_path()), InputError);
}

TEST_F(FociFileTest, RefusesSurfelsThatAreNotSoundThoughTheChecksumIs) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto refused = [&](const auto& spoil) {
    SurfelCloud cloud = few(true);
    const MomentTree tree(cloud);
    spoil(cloud);
    return refusal(written(surfelsOf(std::make_shared<const MomentTree>(
        cloud, TreeNodes{tree.nodes(), tree.coarseness(), tree.facing()}, nullptr))));
  };
  EXPECT_EQ(refused([&](SurfelCloud& c) { c.position_m[2].y = nan; }), ": surfel 2 is not sound");
  EXPECT_NE(refused([&](SurfelCloud& c) { c.axis_u_m[0] = glm::vec3(0.0f); }), "");
  EXPECT_NE(refused([&](SurfelCloud& c) { c.axis_u_m[0] = c.axis_v_m[0]; }), "");
  EXPECT_NE(refused([&](SurfelCloud& c) { c.area_m2[2] = 0.0f; }), "");
  EXPECT_NE(refused([&](SurfelCloud& c) { c.area_m2[2] = HUGE_VALF; }), "");
  EXPECT_NE(refused([&](SurfelCloud& c) { c.color[2].z = -1.0f; }), "");
  EXPECT_NE(refused([&](SurfelCloud& c) { c.opacity[2] = 1.5f; }), "");
  EXPECT_EQ(refused([](SurfelCloud&) {}), "");
}

}  // namespace FOCI_FILE
}  // namespace foci
