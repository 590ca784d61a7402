// PCD in its three forms, with the values of one point cloud.
#include "render/scene/io/point_formats.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>

#include "base/input_error.h"
#include "render/image/srgb.h"
#include "render/scene/io/open_scene.h"
#include "tests/temporary_folder.h"
#include "tests/unit/render/scene/io/gaussian_files.h"

namespace foci {
namespace FOCI_FILE {

/// Two points: (1, 2, 3) red, and (-1, 0.5, 4) of colour (0, 128, 255), with normals along z.
constexpr std::uint32_t kRed = 0xffff0000, kBlue = 0xff0080ff;

std::string headerOf(const char* data, const char* color_type, int points = 2) {
  const std::string n = std::to_string(points);
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
         "FIELDS x y z rgb _ normal_x normal_y normal_z\nSIZE 4 4 4 4 1 4 4 4\nTYPE F F F " +
         std::string(color_type) + " U F F F\nCOUNT 1 1 1 1 3 1 1 1\nWIDTH " + n +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA " + data + "\n";
}

std::string records() {
  std::string bytes;
  put(bytes, 1.0f, 2.0f, 3.0f, kRed);
  bytes += "abc";
  put(bytes, 0.0f, 0.0f, 1.0f, -1.0f, 0.5f, 4.0f, kBlue);
  bytes += "abc";
  put(bytes, 0.0f, 0.0f, -1.0f);
  return bytes;
}

/// The same by field, as LZF with literals only, but for the last 8 bytes, which repeat others.
std::string packedFields() {
  std::string fields;
  put(fields, 1.0f, -1.0f, 2.0f, 0.5f, 3.0f, 4.0f, kRed, kBlue);
  fields += "abcabc";
  put(fields, 0.0f, 0.0f, 0.0f, 0.0f, 1.0f, -1.0f);
  std::string packed;
  for (std::size_t at = 0; at < fields.size(); at += 16) {
    const std::string part = fields.substr(at, 16);
    packed += static_cast<char>(part.size() - 1);
    packed += part;
  }
  std::string out;
  put(out, static_cast<std::uint32_t>(packed.size()), static_cast<std::uint32_t>(fields.size()));
  return out + packed;
}

class Pcd : public testing::Test {
 protected:
  PointCloud read(const std::string& bytes) { return readPcd(scratch.write("a.pcd", bytes)); }
  std::string refusal(const std::string& bytes) {
    try {
      read(bytes);
    } catch (const InputError& error) {
      return error.what();
    }
    return "read";
  }
  static bool has(const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  }
  const TemporaryFolder scratch;
};

TEST_F(Pcd, EveryFormHasTheSameValues) {
  const std::string ascii = headerOf("ascii", "U") + "1 2 3 " + std::to_string(kRed) +
                            " 97 98 99 0 0 1\n-1 0.5 4 " + std::to_string(kBlue) +
                            " 97 98 99 0 0 -1\n";
  for (const std::string& bytes :
       {ascii, headerOf("binary", "F") + records(), headerOf("binary", "U") + records(),
        headerOf("binary_compressed", "F") + packedFields()}) {
    const PointCloud points = read(bytes);
    ASSERT_EQ(points.size(), 2u);
    EXPECT_EQ(points.position_m[0], glm::vec3(1, 2, 3));
    EXPECT_EQ(points.position_m[1], glm::vec3(-1, 0.5f, 4));
    EXPECT_FLOAT_EQ(points.color[0].r, 1.0f);
    EXPECT_FLOAT_EQ(points.color[0].g, 0.0f);
    EXPECT_FLOAT_EQ(points.color[1].g, linearFromSrgb(128.0f / 255.0f));
    EXPECT_FLOAT_EQ(points.color[1].b, 1.0f);
    EXPECT_EQ(points.normal.at(1), glm::vec3(0, 0, -1));
    EXPECT_TRUE(points.remarks.empty());
  }
}

TEST_F(Pcd, APackedColourAsAFloatIsItsBits) {
  // 4.2108e+06 as PCL writes it: the bits of the float are 0x004a8080.
  const PointCloud points = read(
      "VERSION .7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 1\nHEIGHT 1\n"
      "POINTS 1\nDATA ascii\n0 0 0 4.2108e+06\n");
  const float value = 4.2108e+06f;
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, 4);
  EXPECT_FLOAT_EQ(points.color[0].r,
                  linearFromSrgb(static_cast<float>(bits >> 16u & 0xffu) / 255.0f));
}

TEST_F(Pcd, LzfCopiesWhatCameBefore) {
  // x of 8 equal points: 4 literals, then 28 bytes from 4 bytes back (length 28 = 7 + 19 + 2).
  std::string packed = "\3";
  put(packed, 1.5f);
  packed += "\xe0\x13";
  packed += '\3';
  std::string rest = packed + packed;  // y, z alike
  packed += rest;
  std::string bytes =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 8\nHEIGHT 1\n"
      "POINTS 8\nDATA binary_compressed\n";
  put(bytes, static_cast<std::uint32_t>(packed.size()), std::uint32_t{96});
  const PointCloud points = read(bytes + packed);
  ASSERT_EQ(points.size(), 8u);
  EXPECT_EQ(points.position_m[7], glm::vec3(1.5f));
}

TEST_F(Pcd, NamesOfFieldsMayHaveCapitals) {
  EXPECT_EQ(read("VERSION 0.7\nFIELDS X Y Z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\n"
                 "HEIGHT 1\nPOINTS 1\nDATA ascii\n1 2 3\n")
                .position_m.at(0),
            glm::vec3(1, 2, 3));
  EXPECT_EQ(read("VERSION 0.7\nFIELDS x y z X\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 1\n"
                 "HEIGHT 1\nPOINTS 1\nDATA ascii\n1 2 3 4\n")
                .position_m.at(0),
            glm::vec3(1, 2, 3));
}

TEST_F(Pcd, OpensByItsContent) {
  const auto path = scratch.write("scan.bin", headerOf("binary", "F") + records());
  EXPECT_TRUE(isScene(path));
  const SceneFacts facts = factsOf(readScene(path));
  EXPECT_EQ(nameOf(facts), "PCD points");
  EXPECT_TRUE(facts.has_normals);
}

TEST_F(Pcd, RefusesWhatIsDamaged) {
  const std::string good = headerOf("binary_compressed", "F") + packedFields();
  for (std::size_t length = 0; length < good.size(); ++length) {
    ASSERT_NE(refusal(good.substr(0, length)), "read") << length;
  }
  EXPECT_TRUE(has(refusal(headerOf("binary", "F", 9) + records()), "more than the file has room"));
  EXPECT_TRUE(has(refusal(headerOf("zip", "F") + records()), "expected ascii, binary or"));
  EXPECT_TRUE(has(refusal(headerOf("binary", "Q") + records()), "expected F, U or I"));
  EXPECT_TRUE(
      has(refusal(headerOf("ascii", "U") + "1 2 3 4 5 6 7 8 9 10\n1 2 3\n"), "too few values"));
  EXPECT_TRUE(has(refusal("VERSION 0.7\nDATA ascii\n"), "no line FIELDS"));
  std::string moved = headerOf("binary", "F") + records();
  moved.replace(moved.find("VIEWPOINT 0"), 11, "VIEWPOINT 7");
  EXPECT_EQ(read(moved).remarks.size(), 1u);
}

}  // namespace FOCI_FILE
}  // namespace foci
