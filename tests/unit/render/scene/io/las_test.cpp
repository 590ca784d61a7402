#include "render/scene/io/point_formats.h"

#include <gtest/gtest.h>

#include <algorithm>
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
namespace FOCI_FILE {

struct LasPoint {
  std::array<std::int32_t, 3> steps;
  std::uint16_t intensity = 0;
  std::array<std::uint16_t, 3> color{};
  std::array<std::uint8_t, 2> flags_and_class{};  // formats 0 to 5 have both in the first
};

/// A record of variable length: number and content.
struct LasRecord {
  std::uint16_t number;
  std::string content;
};

template <typename T>
std::string rawBytes(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), sizeof(T) * values.size()};
}

/// GeoKeys, each of key, location, count and value.
LasRecord geoKeys(const std::vector<std::array<std::uint16_t, 4>>& keys) {
  std::vector<std::uint16_t> all = {1, 1, 0, static_cast<std::uint16_t>(keys.size())};
  for (const auto& key : keys) all.insert(all.end(), key.begin(), key.end());
  return {34735, rawBytes(all)};
}

struct LasFile {
  unsigned char minor = 2, format = 2;
  std::uint16_t record_bytes = 26, color_at = 20;
  std::vector<LasPoint> points;
  std::array<double, 3> scale{0.001, 0.001, 0.001}, offset{0.0, 0.0, 0.0};
  std::vector<LasRecord> records{};
  bool late = false;  // the records come behind the points

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
    const auto append = [&](std::size_t head) {
      for (const LasRecord& record : records) {
        const std::size_t at = all.size();
        all.resize(at + head);
        all.replace(at + 2, 15, "LASF_Projection");
        put(at + 18, record.number);
        put(at + 20, static_cast<std::uint16_t>(record.content.size()));
        all += record.content;
      }
    };
    if (!late) {
      append(54);
      put(100, static_cast<std::uint32_t>(records.size()));
      put(96, static_cast<std::uint32_t>(all.size()));
    }
    for (const LasPoint& point : points) {
      const std::size_t at = all.size();
      all.resize(at + record_bytes);
      put(at, point.steps);
      put(at + 12, point.intensity);
      put(at + 15, point.flags_and_class);
      if (color_at != 0) put(at + color_at, point.color);
    }
    if (late) {
      put(235, static_cast<std::uint64_t>(all.size()));
      put(243, static_cast<std::uint32_t>(records.size()));
      append(60);
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

TEST_F(Las, LeavesOutNoiseAndWithheldPoints) {
  using Flags = std::array<std::uint8_t, 2>;
  const auto left = [&](unsigned char format, std::uint16_t bytes, const Flags& flags) {
    LasFile file{.format = format, .record_bytes = bytes, .color_at = 0, .points = kTwo};
    file.points[0].flags_and_class = flags;
    const PointCloud points = read(file);
    EXPECT_EQ(points.remarks.size(), 2 - points.size());
    EXPECT_FLOAT_EQ(points.position_m.back().x, 1.001f);
    return points.size();
  };
  constexpr Flags kOld[] = {{7}, {128 | 2}, {32 | 7}}, kOldKept[] = {{18}, {32 | 2}, {2, 7}};
  constexpr Flags kNew[] = {{0, 7}, {0, 18}, {4, 2}}, kNewKept[] = {{128, 2}, {3, 6}, {0, 2}};
  for (const Flags& flags : kOld) EXPECT_EQ(left(0, 20, flags), 1u);
  for (const Flags& flags : kOldKept) EXPECT_EQ(left(0, 20, flags), 2u);
  for (const Flags& flags : kNew) EXPECT_EQ(left(6, 30, flags), 1u);
  for (const Flags& flags : kNewKept) EXPECT_EQ(left(6, 30, flags), 2u);
  LasFile noise{.points = kTwo};
  for (LasPoint& point : noise.points) point.flags_and_class = {7};
  EXPECT_EQ(read(noise).size(), 2u) << "of noise alone";
  noise.points[1].flags_and_class = {2};
  noise.minor = 0;
  EXPECT_EQ(read(noise).size(), 2u) << "with classes of the user's own";
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

constexpr double kUsFoot_m = 1200.0 / 3937.0;

TEST_F(Las, UnitsAreThoseOfItsGeoKeys) {
  const auto unit = [&](const std::vector<std::array<std::uint16_t, 4>>& keys,
                        const std::vector<LasRecord>& more = {}) {
    std::vector<LasRecord> records = more;
    records.push_back(geoKeys(keys));
    return read({.points = kTwo, .records = records}).unit_m.value();
  };
  EXPECT_DOUBLE_EQ(unit({{1024, 0, 1, 1}, {3076, 0, 1, 9003}, {4099, 0, 1, 9003}}), kUsFoot_m);
  EXPECT_DOUBLE_EQ(unit({{1024, 0, 1, 1}, {3076, 0, 1, 9002}}), 0.3048);
  EXPECT_DOUBLE_EQ(unit({{1024, 0, 1, 1}, {3076, 0, 1, 9001}}), 1.0);
  EXPECT_DOUBLE_EQ(unit({}), 1.0);
  // A unit of its own, and one that stands in the name of the system only.
  EXPECT_DOUBLE_EQ(
      unit({{3076, 0, 1, 32767}, {3077, 34736, 1, 1}}, {{34736, rawBytes<double>({9.0, 0.5})}}),
      0.5);
  EXPECT_DOUBLE_EQ(unit({{3073, 34737, 26, 0}}, {{34737, "NAD83 / Ohio South (ftUS)|"}}),
                   kUsFoot_m);
  const PointCloud unknown = read({.points = kTwo, .records = {geoKeys({{3072, 0, 1, 2263}})}});
  ASSERT_EQ(unknown.remarks.size(), 1u);
  EXPECT_NE(unknown.remarks[0].find("EPSG:2263"), std::string::npos);
  EXPECT_TRUE(read({.points = kTwo, .records = {geoKeys({{3072, 0, 1, 32632}})}}).remarks.empty());
}

TEST_F(Las, UnitsAreThoseOfItsText) {
  // Quotes are primes, which become quotes below.
  std::string one =
      "COMPD_CS['a, b',PROJCS['NAD83 / Ohio (ftUS)',GEOGCS['NAD83',DATUM['N',SPHEROID['GRS 1980',"
      "6378137,298.257]],UNIT['degree',0.0174532925199433]],PROJECTION['Lambert'],PARAMETER['x',0],"
      "UNIT['US survey foot',0.304800609601219]],VERT_CS['v',VERT_DATUM['d',2005],UNIT['foot',"
      "0.3048]]]";
  std::string two =
      "COMPOUNDCRS['c',PROJCRS['p',BASEGEOGCRS['b',ANGLEUNIT['degree',0.0174532925199433]],"
      "CONVERSION['m',PARAMETER['e',0,LENGTHUNIT['metre',1]]],CS[Cartesian,2],"
      "AXIS['(E)',east,ORDER[1],LENGTHUNIT['foot',0.3048]],"
      "AXIS['(N)',north,ORDER[2],LENGTHUNIT['foot',0.3048]]],"
      "VERTCRS['v',CS[vertical,1],AXIS['h',up,LENGTHUNIT['foot',0.3048]]]]";
  for (std::string* const text : {&one, &two}) std::replace(text->begin(), text->end(), '\'', '"');
  for (const bool late : {false, true}) {
    const PointCloud first =
        read({.minor = 4, .points = kTwo, .records = {{2112, one}}, .late = late});
    EXPECT_NEAR(first.unit_m.value(), kUsFoot_m, 1e-9);
    EXPECT_NEAR(first.position_m[0].z, 3.0 * 0.3048 / kUsFoot_m, 1e-6);  // other feet
    ASSERT_EQ(first.remarks.size(), 1u);
    EXPECT_NE(first.remarks[0].find("heights are in units of 0.3048 m"), std::string::npos);
    const PointCloud second =
        read({.minor = 4, .points = kTwo, .records = {{2112, two}}, .late = late});
    EXPECT_EQ(second.unit_m, 0.3048);
    EXPECT_TRUE(second.remarks.empty());
  }
  for (std::size_t length = 0; length < one.size(); ++length) {  // damaged: taken for metres
    const PointCloud cut = read({.points = kTwo, .records = {{2112, one.substr(0, length)}}});
    EXPECT_EQ(cut.unit_m, 1.0);
  }
}

TEST_F(Las, LongitudesBecomeMetres) {
  // At 60 degrees north, a degree is 55.80 km to the east and 111.41 km to the north (WGS 84).
  const std::vector<LasPoint> three = {{.steps = {100000000, 600000000, 5000}},
                                       {.steps = {100010000, 600000000, 5000}},
                                       {.steps = {100000000, 600010000, 7000}}};
  const LasFile file{.points = three,
                     .scale = {1e-7, 1e-7, 0.001},
                     .records = {geoKeys({{1024, 0, 1, 2}, {2048, 0, 1, 4326}})}};
  const PointCloud points = read(file);
  EXPECT_EQ(points.unit_m, 1.0);
  EXPECT_NEAR(points.position_m[1].x - points.position_m[0].x, 55.80, 0.01);
  EXPECT_NEAR(points.position_m[2].y - points.position_m[0].y, 111.41, 0.01);
  EXPECT_NEAR(points.position_m[2].z - points.position_m[0].z, 2.0, 1e-5);
  ASSERT_FALSE(points.remarks.empty());
  EXPECT_NE(points.remarks[0].find("longitude and latitude in degrees: shown in metres"),
            std::string::npos);
}

TEST_F(Las, IntensityIsGreyWhereAllColoursAreBlack) {
  std::vector<LasPoint> black = kTwo;
  for (LasPoint& point : black) point.color = {0, 0, 0};
  const PointCloud points = read({.points = black});
  EXPECT_EQ(points.color[0], glm::vec3(0.0f));
  EXPECT_EQ(points.color[1], glm::vec3(1.0f));
  EXPECT_EQ(points.remarks, std::vector<std::string>{"all colours are 0: intensity is shown as "
                                                     "grey"});
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

}  // namespace FOCI_FILE
}  // namespace foci
