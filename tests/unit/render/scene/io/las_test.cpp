#include "render/scene/io/las.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "render/image/srgb.h"
#include "render/scene/io/open_scene.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace {

struct LasPoint {
  std::array<std::int32_t, 3> steps;
  std::uint16_t intensity = 0;
  std::array<std::uint16_t, 3> color{};
};

struct LasFile {
  unsigned char minor = 2, format = 2;
  std::uint16_t record_bytes = 26, color_at = 20;
  std::vector<LasPoint> points;
  std::array<double, 3> scale{0.001, 0.001, 0.001}, offset{0.0, 0.0, 0.0};

  std::string bytes() const {
    const std::size_t header = minor == 4 ? 375 : minor == 3 ? 235 : 227;
    std::string all(header, '\0');
    const auto put = [&](std::size_t at, const auto& value) {
      std::memcpy(all.data() + at, &value, sizeof(value));
    };
    all.replace(0, 4, "LASF");
    put(24, static_cast<unsigned char>(1));
    put(25, minor);
    put(94, static_cast<std::uint16_t>(header));
    put(96, static_cast<std::uint32_t>(header));
    put(104, format);
    put(105, record_bytes);
    if (minor == 4) {
      put(247, static_cast<std::uint64_t>(points.size()));
    } else {
      put(107, static_cast<std::uint32_t>(points.size()));
    }
    put(131, scale);
    put(155, offset);
    for (const LasPoint& point : points) {
      const std::size_t at = all.size();
      all.resize(at + record_bytes);
      put(at, point.steps);
      put(at + 12, point.intensity);
      if (color_at != 0) put(at + color_at, point.color);
    }
    return all;
  }
};

class Las : public testing::Test {
 protected:
  PointCloud read(const LasFile& file) { return readBytes(file.bytes()); }
  PointCloud readBytes(const std::string& bytes) { return readLas(scratch.write("p.las", bytes)); }
  std::string refusal(const std::string& bytes) {
    try {
      readBytes(bytes);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const TemporaryFolder scratch;
};

const std::vector<LasPoint> kTwo = {
    {.steps = {1000, 2000, 3000}, .intensity = 10, .color = {65535, 0, 32768}},
    {.steps = {1001, 2000, 3000}, .intensity = 90, .color = {0, 65535, 0}}};

TEST_F(Las, TakesPositionsAndColours) {
  const PointCloud points = read({.points = kTwo});
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points.position_m[0], glm::vec3(1, 2, 3));
  EXPECT_FLOAT_EQ(points.position_m[1].x, 1.001f);
  EXPECT_FLOAT_EQ(points.color[0].x, 1.0f);
  EXPECT_FLOAT_EQ(points.color[0].z, linearFromSrgb(32768.0f / 65535.0f));
  EXPECT_TRUE(points.remarks.empty());
}

TEST_F(Las, TakesEveryVersionAndPointFormatWithColours) {
  const auto expectColors = [&](unsigned char minor, unsigned char format, std::uint16_t bytes,
                                std::uint16_t color_at) {
    const PointCloud points = read({.minor = minor,
                                    .format = format,
                                    .record_bytes = bytes,
                                    .color_at = color_at,
                                    .points = kTwo});
    EXPECT_FLOAT_EQ(points.color.at(1).y, 1.0f) << int{format};
    EXPECT_FLOAT_EQ(points.color.at(1).x, 0.0f) << int{format};
  };
  expectColors(2, 3, 34, 28);
  expectColors(3, 5, 63, 28);
  expectColors(4, 7, 36, 30);
  expectColors(4, 8, 38, 30);
  expectColors(4, 10, 67, 30);
  expectColors(2, 2, 40, 20);  // with bytes of its own behind each point
}

TEST_F(Las, ColoursOfEightBitsAreSeenAsSuch) {
  std::vector<LasPoint> dark = kTwo;
  dark[0].color = {255, 0, 128};
  dark[1].color = {0, 255, 0};
  EXPECT_FLOAT_EQ(read({.points = dark}).color[0].x, 1.0f);
}

TEST_F(Las, IntensityIsGreyWhereThereAreNoColours) {
  const PointCloud points = read({.format = 1, .record_bytes = 28, .color_at = 0, .points = kTwo});
  EXPECT_EQ(points.color[0], glm::vec3(0.0f));
  EXPECT_EQ(points.color[1], glm::vec3(1.0f));
}

TEST_F(Las, MapCoordinatesKeepTheirMillimetres) {
  const PointCloud points = read({.points = kTwo, .offset = {482000.0, 5412000.0, 0.0}});
  EXPECT_NEAR(points.position_m[1].x - points.position_m[0].x, 0.001f, 1e-4f);
  ASSERT_EQ(points.remarks.size(), 1u);
}

TEST_F(Las, OpensByItsContent) {
  EXPECT_EQ(openPoints(readScene(scratch.write("scan.bin", LasFile{.points = kTwo}.bytes())), 2.0)
                .points.position_m[0],
            glm::vec3(2, 4, 6));
  EXPECT_TRUE(isScene(scratch.path() / "scan.bin"));
}

TEST_F(Las, RefusesWhatItCannotRead) {
  const LasFile good{.points = kTwo};
  const std::string bytes = good.bytes();
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    ASSERT_NE(refusal(bytes.substr(0, length)), "") << length;
  }
  const auto changed = [&](std::size_t at, auto value) {
    std::string text = bytes;
    std::memcpy(text.data() + at, &value, sizeof(value));
    return refusal(text);
  };
  EXPECT_NE(changed(104, static_cast<unsigned char>(2 | 0x80)).find("laszip -i"),
            std::string::npos);
  EXPECT_NE(changed(104, static_cast<unsigned char>(11)).find("expected 0 to 10"),
            std::string::npos);
  EXPECT_NE(changed(25, static_cast<unsigned char>(7)).find("expected version"), std::string::npos);
  EXPECT_NE(changed(105, std::uint16_t{4}).find("needs 26"), std::string::npos);
  EXPECT_NE(changed(107, std::uint32_t{0xffffffff}).find("room for at most 2"), std::string::npos);
  EXPECT_NE(changed(107, std::uint32_t{0}).find("has no points"), std::string::npos);
  EXPECT_NE(changed(96, std::uint32_t{100}).find("not behind its header"), std::string::npos);
  EXPECT_NE(changed(155, std::numeric_limits<double>::quiet_NaN()).find("finite position"),
            std::string::npos);
}

}  // namespace
}  // namespace foci
