#include "render/scene/io/ply.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "base/input_error.h"

namespace foci {
namespace FOCI_FILE {

constexpr float kSrgbByte = 0.5f / 255.0f * 2.3f;  // half a step of 8-bit sRGB where it is steepest

class PlyTest : public testing::Test {
 protected:
  PlyTest() {
    path_ = std::filesystem::temp_directory_path() /
            ("foci_ply_test_" + std::to_string(getpid()) + "_" +
             testing::UnitTest::GetInstance()->current_test_info()->name() + ".ply");
  }
  ~PlyTest() override { std::filesystem::remove(path_); }

  PointCloud read(const std::string& content) {
    std::ofstream(path_, std::ios::binary) << content;
    return readPly(path_);
  }

  /// The one line of the refusal, without the path; "" where the file was accepted.
  std::string refusal(const std::string& content) {
    try {
      read(content);
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

template <typename T>
void put(std::string& out, T value, bool big) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if (big != (std::endian::native == std::endian::big)) std::reverse(raw.begin(), raw.end());
  out.append(raw.data(), raw.size());
}

/// Three points with shuffled properties of many types, lists within, an element before and one
/// after.
std::string shuffledBinary(bool big) {
  std::string out =
      "ply\nformat binary_" + std::string(big ? "big" : "little") +
      "_endian 1.0\ncomment shuffled\nelement camera 2\nproperty list uchar short tag\n"
      "property double f\nelement vertex 3\nproperty ushort green\nproperty double z\n"
      "property list uint uchar skipped\nproperty short x\nproperty uchar alpha\n"
      "property float nz\nproperty ushort red\nproperty float ny\nproperty char quality\n"
      "property float nx\nproperty float y\nproperty float radius\nproperty ushort blue\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < 2; ++i) {
    put<std::uint8_t>(out, static_cast<std::uint8_t>(i * 2), big);
    for (int k = 0; k < i * 2; ++k) put<std::int16_t>(out, 7, big);
    put<double>(out, 1.5, big);
  }
  for (int i = 0; i < 3; ++i) {
    put<std::uint16_t>(out, 65535, big);
    put<double>(out, 3.0 + i, big);
    put<std::uint32_t>(out, static_cast<std::uint32_t>(i), big);
    for (int k = 0; k < i; ++k) put<std::uint8_t>(out, 9, big);
    put<std::int16_t>(out, static_cast<std::int16_t>(-1 - i), big);
    put<std::uint8_t>(out, 51, big);
    put<float>(out, 0.0f, big);
    put<std::uint16_t>(out, 0, big);
    put<float>(out, 2.0f, big);
    put<std::int8_t>(out, 1, big);
    put<float>(out, 0.0f, big);
    put<float>(out, 2.25f, big);
    put<float>(out, 0.125f, big);
    put<std::uint16_t>(out, 0, big);
  }
  put<std::uint8_t>(out, 3, big);
  for (int k = 0; k < 3; ++k) put<std::int32_t>(out, k, big);
  return out;
}

void expectShuffled(const PointCloud& points) {
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points.position_m[2], glm::vec3(-3.0f, 2.25f, 5.0f));
  EXPECT_EQ(points.normal[1], glm::vec3(0.0f, 1.0f, 0.0f));
  EXPECT_EQ(points.color[0], glm::vec3(0.0f, 1.0f, 0.0f));
  EXPECT_FLOAT_EQ(points.opacity[0], 0.2f);
  EXPECT_EQ(points.radius_m[0], 0.125f);
  EXPECT_EQ(points.dropped, 0u);
}

TEST_F(PlyTest, ReadsShuffledLittleEndian) { expectShuffled(read(shuffledBinary(false))); }
TEST_F(PlyTest, ReadsShuffledBigEndian) { expectShuffled(read(shuffledBinary(true))); }

TEST_F(PlyTest, ReadsShuffledAscii) {
  expectShuffled(read(
      "ply\r\nformat ascii 1.0\r\nelement camera 1\r\nproperty list uchar short tag\r\n"
      "element vertex 3\r\nproperty ushort g\r\nproperty double z\r\n"
      "property list uint uchar skipped\r\nproperty short x\r\nproperty uchar a\r\n"
      "property float nz\r\nproperty ushort r\r\nproperty float ny\r\nproperty float nx\r\n"
      "property float y\r\nproperty float radius\r\nproperty ushort b\r\nend_header\r\n"
      "2 1 1\r\n65535 3 0 -1 51 0 0 2 0 2.25 0.125 0\r\n"
      "65535 4e0 1 9 -2 51 0 0 2 0 2.25 .125 0\r\n  65535 5 2 9 9 -3 51\t0 0 +2 0 2.25 0.125 0 "));
}

TEST_F(PlyTest, ReadsNamesInCapitals) {
  const std::string start = "ply\nformat ascii 1.0\nelement vertex 1\n";
  const PointCloud points = read(
      start +
      "property float X\nproperty float Y\nproperty float Z\nproperty float NX\nproperty float Ny\n"
      "property float NZ\nproperty uchar Red\nproperty uchar GREEN\nproperty uchar Blue\n"
      "end_header\n1 2 3 0 0 1 255 0 255\n");
  EXPECT_EQ(points.position_m[0], glm::vec3(1, 2, 3));
  EXPECT_EQ(points.normal[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(points.color[0], glm::vec3(1, 0, 1));
  // Where both are there, the name in lower case counts.
  const PointCloud both = read(start +
                               "property float X\nproperty float x\nproperty float y\n"
                               "property float z\nend_header\n9 1 2 3\n");
  EXPECT_EQ(both.position_m[0], glm::vec3(1, 2, 3));
}

TEST_F(PlyTest, RemarksPointsThatAreNotSeen) {
  const std::string start =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty "
      "float z\n";
  const std::string color = "property ushort red\nproperty ushort green\nproperty ushort blue\n";
  const PointCloud dark = read(start + color + "end_header\n0 0 0 200 0 0\n1 0 0 0 50 0\n");
  ASSERT_EQ(dark.remarks.size(), 1u);
  EXPECT_NE(dark.remarks[0].find("nearly black"), std::string::npos);
  const PointCloud clear = read(start + "property uchar alpha\nend_header\n0 0 0 0\n1 0 0 0\n");
  ASSERT_EQ(clear.remarks.size(), 1u);
  EXPECT_NE(clear.remarks[0].find("alpha of all points is 0, or 1 of 255: shown opaque"),
            std::string::npos);
  EXPECT_TRUE(read(start + "property uchar alpha\nend_header\n0 0 0 0\n1 0 0 9\n").remarks.empty());
}

TEST_F(PlyTest, OpacitiesOfAnyTypeMayBeBytes) {
  const auto opacity = [&](const std::string& type, const std::string& first,
                           const std::string& second) {
    return read(
               "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
               "property float z\nproperty " +
               type + " alpha\nend_header\n0 0 0 " + first + "\n1 0 0 " + second + "\n")
        .opacity;
  };
  for (const char* type : {"uchar", "int", "ushort", "float"}) {
    EXPECT_TRUE(opacity(type, "255", "255").empty()) << type;
    EXPECT_FLOAT_EQ(opacity(type, "51", "255").at(0), 0.2f) << type;
  }
  EXPECT_FLOAT_EQ(opacity("float", "0.2", "1").at(0), 0.2f);
  EXPECT_FLOAT_EQ(opacity("ushort", "13107", "65535").at(0), 0.2f);
  EXPECT_TRUE(opacity("uchar", "1", "1").empty());  // 1.0 as an integer: opaque
}

TEST_F(PlyTest, AnElementWithoutItemsNeedsNoProperties) {
  EXPECT_EQ(read("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                 "property float z\nelement face 0\nend_header\n1 2 3\n")
                .position_m.at(0),
            glm::vec3(1, 2, 3));
}

TEST_F(PlyTest, LabelsThatAreNoneLeaveThePoints) {
  const auto labels = [&](const std::string& first) {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 1002\nproperty float x\nproperty float y\n"
        "property float z\nproperty float scalar_Label\nend_header\n0 0 0 " +
        first + "\n";
    for (int i = 1; i < 1002; ++i) text += "1 0 0 " + std::to_string(i % 1000) + "\n";
    return read(text);
  };
  const PointCloud some = labels("nan");
  EXPECT_TRUE(some.remarks.empty());
  ASSERT_EQ(some.objects.of.size(), 1002u);
  EXPECT_EQ(some.objects.of[0], 0u);
  EXPECT_EQ(some.objects.names.at(some.objects.of[1]), "1");
  for (const char* first : {"0.5", "1000"}) {
    const PointCloud none = labels(first);
    EXPECT_TRUE(none.objects.of.empty() && none.objects.names.empty());
    EXPECT_EQ(none.size(), 1002u);
    ASSERT_EQ(none.remarks.size(), 1u);
    EXPECT_NE(none.remarks[0].find("its points are no objects"), std::string::npos);
  }
}

TEST_F(PlyTest, RemarksDetailThatFloatsLose) {
  const auto remarks = [&](const std::string& type, const std::string& east) {
    std::string text = "ply\nformat ascii 1.0\nelement vertex 2\n";
    for (const char* axis : {"x", "y", "z"}) text += "property " + type + " " + axis + "\n";
    return read(text + "end_header\n" + east + "00 0 0\n" + east + "02 0 0\n").remarks;
  };
  ASSERT_EQ(remarks("float", "54123").size(), 1u);
  EXPECT_NE(remarks("float", "54123")[0].find("floats lose their detail"), std::string::npos);
  EXPECT_TRUE(remarks("float", "").empty());
  EXPECT_EQ(remarks("double", "54123")[0].find("floats lose"), std::string::npos);
}

TEST_F(PlyTest, FollowsTheStandardOfColours) {
  const PointCloud points = read(
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "property float diffuse_red\nproperty float diffuse_green\nproperty float diffuse_blue\n"
      "end_header\n0 0 0 0.5 1 0.04\n1 0 0 0 0 0\n");
  EXPECT_NEAR(points.color[0].x, 0.2140f, 5e-5f);
  EXPECT_EQ(points.color[0].y, 1.0f);
  EXPECT_NEAR(points.color[0].z, 0.04f / 12.92f, 1e-7f);
}

TEST_F(PlyTest, ColoursOfAnyTypeMayBeBytes) {
  const auto colors = [&](const std::string& type, const std::string& first) {
    std::string text = "ply\nformat ascii 1.0\nelement vertex 2\n";
    for (const char* name : {"x", "y", "z"}) text += "property float " + std::string(name) + "\n";
    for (const char* name : {"red", "green", "blue"})
      text += "property " + type + " " + name + "\n";
    return text + "end_header\n0 0 0 " + first + "\n1 0 0 0 0 0\n";
  };
  const PointCloud bytes = read(colors("uchar", "200 120 60"));
  EXPECT_TRUE(bytes.remarks.empty());
  for (const char* type : {"short", "ushort", "int", "uint", "float", "double"}) {
    const PointCloud points = read(colors(type, "200 120 60"));
    EXPECT_EQ(points.color, bytes.color) << type;
    EXPECT_EQ(points.remarks.size(), 1u) << type;
  }
  EXPECT_EQ(read(colors("ushort", "65535 0 0")).color[0], glm::vec3(1, 0, 0));
  EXPECT_NE(refusal(colors("float", "1.5 0 0")).find("expected 0 to 1 or 0 to 255"),
            std::string::npos);
  EXPECT_NE(refusal(colors("float", "300 0 0")).find("vertex 1 has the colour 300"),
            std::string::npos);
}

TEST_F(PlyTest, VerticesMayTakeSeveralLines) {
  const std::string start =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty "
      "float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  const PointCloud points = read(start + "0 0 0 \n255 0 0 \n1 0 0 \n0 255 0 \n");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points.color[1], glm::vec3(0, 1, 0));
  EXPECT_NE(refusal(start + "0 0 0 \n255 0 0 1\n1 0 0\n255 0 0\n").find(":11: too few"),
            std::string::npos);
}

TEST_F(PlyTest, AByteOrderMarkIsSkipped) {
  EXPECT_EQ(read("\xef\xbb\xbfply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                 "property float y\nproperty float z\nend_header\n1 2 3\n")
                .position_m[0],
            glm::vec3(1, 2, 3));
}

TEST_F(PlyTest, IsReadBackAsWritten) {
  PointCloud cloud;
  for (int i = 0; i < 1000; ++i) {
    const auto t = static_cast<float>(i) / 999.0f;
    cloud.position_m.emplace_back(t, -1e5f * t, 1e-7f * t);
    cloud.normal.push_back(glm::normalize(glm::vec3(1.0f, t, -t)));
    cloud.color.emplace_back(t, 1.0f - t, 0.5f);
    cloud.radius_m.push_back(0.001f + t);
    cloud.opacity.push_back(t);
  }
  writePly(path_, cloud);
  const PointCloud back = readPly(path_);
  EXPECT_EQ(back.position_m, cloud.position_m);
  EXPECT_EQ(back.radius_m, cloud.radius_m);
  EXPECT_EQ(back.opacity, cloud.opacity);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_LT(glm::length(back.normal[i] - cloud.normal[i]), 1e-6f);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(back.color[i][c], cloud.color[i][c], kSrgbByte);
  }
}

TEST_F(PlyTest, DropsAndCountsPointsThatAreNowhere) {
  const PointCloud points = read(
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty float radius\nend_header\n"
      "0 0 0 nan 0 1 1\n1 nan 0 0 0 1 1\n2 0 0 0 0 0 -1\n3 0 inf 0 0 1 1\n4 1e300 0 0 0 1 1\n");
  EXPECT_EQ(points.dropped, 3u);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points.normal[0], glm::vec3(0.0f));  // to be estimated
  EXPECT_EQ(points.normal[1], glm::vec3(0.0f));
  EXPECT_EQ(points.radius_m[1], 0.0f);
}

TEST_F(PlyTest, RefusesWhatIsNoPointCloud) {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string ascii = "ply\nformat ascii 1.0\n",
                    binary = "ply\nformat binary_little_endian 1.0\n";
  const auto expect = [&](const std::string& content, const std::string& part) {
    const std::string line = refusal(content);
    EXPECT_NE(line.find(part), std::string::npos) << "\"" << line << "\" lacks \"" << part << "\"";
  };
  expect("", "empty");
  expect("solid stl\n", ":1: not a PLY");
  expect("ply\n", "end_header");
  expect("ply\nformat ascii 1.0\n", "end_header");
  expect("ply\nelement vertex 1\n" + xyz + "end_header\n0 0 0\n", "no format");
  expect("ply\nformat base64 1.0\n", ":2:");
  expect(ascii + "element vertex\n", ":3:");
  expect(ascii + "element vertex -1\n", "whole number");
  expect(ascii + "element vertex 1e9\n", "whole number");
  expect(ascii + "element vertex 99999999999999999999999\n", "whole number");
  expect(ascii + "element vertex 1\nproperty quad x\n", ":4: property type \"quad\"");
  expect(ascii + "element vertex 1\nproperty list float int x\n", "counted by a float");
  expect(ascii + "property float x\n", ":3:");
  expect(ascii + "element vertex 1\nproperty float x\nend_header\n0\n", "x, y and z");
  expect(ascii + "element face 1\nproperty float x\nend_header\n0\n", "no element vertex");
  expect(ascii + "element vertex 1\n" + xyz + "property float x\nend_header\n0 0 0 0\n", "twice");
  expect(ascii +
             "element vertex 1\nproperty list uchar float x\nproperty float y\nproperty float z\n"
             "end_header\n1 0 0 0\n",
         "is a list");
  expect(ascii + "element vertex 0\n" + xyz + "end_header\n", "no points");
  expect(ascii + "element vertex 2\n" + xyz + "end_header\nnan 0 0\n0 nan 0\n",
         "none of its points");
  expect(ascii + "element vertex 2\n" + xyz + "end_header\n0 0 0\n1.00 1.00\n", ":9: too few");
  expect(ascii + "element vertex 1\n" + xyz + "end_header\n0 0 0 4\n", ":8: too many");
  expect(ascii + "element vertex 1\n" + xyz + "end_header\n0 zero 0\n", ":8: expected a number");
  expect(ascii + "element vertex 3\n" + xyz + "end_header\n0.00000 0.00000 0.00000\n",
         "after 1 of 3");
  expect(ascii + "element vertex 1\n" + xyz + "property uchar alpha\nend_header\n0 0 0 300\n",
         "vertex 1 has the opacity 300");
  expect(binary + "element vertex 4000000000000000000\n" + xyz + "end_header\nabcdefghijkl",
         "room for at most 1");
  expect(binary + "element vertex 18446744073709551615\n" + xyz + "end_header\nabcdefghijkl",
         "room for at most 1");
  expect(binary + "element vertex 2\n" + xyz + "end_header\nabcdefghijkl", "room for at most 1");
  expect(binary + "element e 1\nproperty list uint int l\nelement vertex 1\n" + xyz +
             "end_header\n\xff\xff\xff\xff" + "abcdefghijklm",
         "list l");
  expect(binary + "element e 3\nelement vertex 1\n" + xyz + "end_header\nabcdefghijkl",
         "no properties");
}

TEST_F(PlyTest, RefusesWhatIsNoFile) {
  EXPECT_THROW(readPly(path_), InputError);
  EXPECT_THROW(readPly(std::filesystem::temp_directory_path()), InputError);
  EXPECT_THROW(readPly("/dev/zero"), InputError);
}

TEST_F(PlyTest, RefusesTruncationAnywhere) {
  const std::string whole = shuffledBinary(false);
  const std::size_t needed = whole.rfind(std::string("\x03\0\0", 3));  // faces are not needed
  ASSERT_NE(needed, std::string::npos);
  const std::size_t body = whole.find("end_header");
  // The body's records repeat themselves, at a length that the step does not divide.
  for (std::size_t size = 0; size < needed; size += size < body ? 1 : 37) {
    EXPECT_NE(refusal(whole.substr(0, size)), "") << size << " bytes of " << needed;
  }
}

TEST_F(PlyTest, IntensityIsGreyWithoutColours) {
  std::string points;
  for (int i = 0; i <= 100; ++i) points += std::to_string(i) + " 0 0 " + std::to_string(i) + "\n";
  const auto header = [](const char* name) {
    return std::string(
               "ply\nformat ascii 1.0\nelement vertex 101\nproperty float x\n"
               "property float y\nproperty float z\nproperty float ") +
           name + "\nend_header\n";
  };
  for (const char* name : {"intensity", "scalar_Intensity", "reflectivity"}) {
    const PointCloud cloud = read(header(name) + points);
    // From 1 to 99 as sRGB code values: 50 is the code 0.5.
    EXPECT_EQ(cloud.color[0], glm::vec3(0.0f));
    EXPECT_EQ(cloud.color[100], glm::vec3(1.0f));
    EXPECT_NEAR(cloud.color[50].x, 0.2140f, kSrgbByte);
  }
  EXPECT_NEAR(read(header("quality") + points).color[100].x, 0.2140f, kSrgbByte);
}

TEST(ReadPly, ReadsTheLion) {
  const char* folder = std::getenv("FOCI_DATA");
  const std::filesystem::path data = folder != nullptr ? folder : FOCI_SOURCE_DIR "/../shared/data";
  if (!std::filesystem::exists(data / "scans/lion.ply")) GTEST_SKIP() << "no lion.ply in " << data;
  const PointCloud lion = readPly(data / "scans/lion.ply");
  EXPECT_EQ(lion.size(), 341989u);
  EXPECT_EQ(lion.normal.size(), lion.size());
  EXPECT_EQ(lion.dropped, 0u);
  for (const glm::vec3& n : lion.normal) EXPECT_NEAR(glm::length(n), 1.0f, 1e-5f);
}

}  // namespace FOCI_FILE
}  // namespace foci
