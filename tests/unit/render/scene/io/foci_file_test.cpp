#include "render/scene/io/foci_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include "base/input_error.h"

namespace foci {
namespace {

class FociFileTest : public testing::Test {
 protected:
  FociFileTest() {
    path_ = std::filesystem::temp_directory_path() /
            ("foci_file_test_" + std::to_string(getpid()) + "_" +
             testing::UnitTest::GetInstance()->current_test_info()->name() + ".foci");
  }
  ~FociFileTest() override { std::filesystem::remove(path_); }

  std::string written(const SurfelCloud& cloud) {
    writeSceneFile(path_, {cloud});
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
  for (const SurfelOrigin& origin :
       {SurfelOrigin{}, SurfelOrigin{.mesh = true},
        SurfelOrigin{.plain_colors = true, .up_axis = 0},
        SurfelOrigin{.mesh = true, .plain_colors = true, .up_axis = 2}}) {
    writeSceneFile(path_, {few(true), origin});
    EXPECT_EQ(readSceneFile(path_).origin, origin);
  }
}

TEST_F(FociFileTest, BringsBackWhatWasWritten) {
  for (const bool with_opacity : {false, true}) {
    const SurfelCloud cloud = few(with_opacity);
    writeSceneFile(path_, {cloud});
    EXPECT_TRUE(isSceneFile(path_));
    const SurfelCloud back = readSceneFile(path_).cloud;
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

TEST_F(FociFileTest, KeepsClosedBodies) {
  SurfelCloud cloud = few(false);
  cloud.bodies.of_surfel = {0, 2, 1};
  completeBodies(cloud);
  const std::string whole = written(cloud);
  EXPECT_EQ(whole[8], 3);                   // the version
  EXPECT_EQ(written(few(false)).at(8), 1);  // earlier programs read it
  writeSceneFile(path_, {cloud});
  const SurfelCloud read = readSceneFile(path_).cloud;
  EXPECT_EQ(read.bodies.of_surfel, cloud.bodies.of_surfel);
  ASSERT_EQ(read.bodies.boxes.size(), 3u);
  EXPECT_EQ(read.bodies.boxes[2].low_m, cloud.bodies.boxes[2].low_m);
  for (std::size_t at = 8; at < whole.size(); ++at) {
    std::string altered = whole;
    altered[at] = static_cast<char>(altered[at] ^ (1 << at % 8));
    EXPECT_NE(refusal(altered), "") << "byte " << at;
  }
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
  later[8] = 4;
  EXPECT_EQ(refusal(later), ": is of version 4: this program reads versions 1 to 3");
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
    spoil(cloud);
    return refusal(written(cloud));
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

}  // namespace
}  // namespace foci
