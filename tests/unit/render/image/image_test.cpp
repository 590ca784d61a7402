#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "base/input_error.h"
#include "render/image/image_file.h"
#include "render/image/srgb.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

TEST(Srgb, RoundTripsEveryCodeValue) {
  Frame frame;
  frame.size_px = {256, 1};
  for (int code = 0; code < 256; ++code) {
    const float linear = linearFromSrgb(static_cast<float>(code) / 255.0f);
    frame.rgba.emplace_back(linear, linear, linear, 1.0f);
  }
  const auto rgb = codesOf(frame);
  for (int code = 0; code < 256; ++code) EXPECT_EQ(rgb[3 * code], code);
}

TEST(Srgb, ClampsAndSwallowsNan) {
  Frame frame;
  frame.size_px = {3, 1};
  frame.rgba = {glm::vec4(-1.0f), glm::vec4(7.0f), glm::vec4(std::nanf(""))};
  const auto rgb = codesOf(frame);
  EXPECT_EQ(rgb[0], 0);
  EXPECT_EQ(rgb[3], 255);
  EXPECT_EQ(rgb[6], 0);
}

TEST(CodesOf, APowersDisplayEmitsWhatWasMeant) {
  Frame frame;
  frame.size_px = {1000, 1};
  for (int i = 0; i < 1000; ++i) frame.rgba.emplace_back(static_cast<float>(i) / 999.0f);
  for (const double gamma : {1.0, 1.8, 2.2, 4.0}) {
    const auto rgb = codesOf(frame, gamma);
    for (std::size_t i = 0; i < 1000; ++i) {
      const double exact = 255.0 * std::pow(static_cast<double>(frame.rgba[i].x), 1.0 / gamma);
      constexpr double kNearest = 0.5 + 0.02;  // and what the table's steps leave
      EXPECT_NEAR(rgb[3 * i], exact, kNearest) << gamma << " at " << i;
    }
  }
}

TEST(MeanLuminance, IsThatOfTheMean) {
  Frame frame;
  frame.size_px = {2, 2};
  frame.rgba = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {5, 5, 5, 1}};
  constexpr double kFloat = 1e-6;
  EXPECT_NEAR(meanLuminance(frame), (0.2126 + 0.7152 + 0.0722 + 1.0) / 4.0, kFloat);
  EXPECT_EQ(meanLuminance(Frame{}), 0.0);
}

TEST(ImageFile, PfmHoldsLinearFloatsBottomRowFirst) {
  Frame frame;
  frame.size_px = {2, 2};
  frame.rgba = {{0.1f, 0.2f, 0.3f, 1.0f},
                {1.0f, 2.0f, 3.0f, 1.0f},
                {4.0f, 5.0f, 6.0f, 1.0f},
                {7.0f, 8.0f, 9.0f, 1.0f}};
  const auto file = std::filesystem::path(testing::TempDir()) / "foci_image_test.pfm";
  writeImage(file, frame);
  std::ifstream in(file, std::ios::binary);
  std::string kind;
  int width = 0, height = 0;
  float scale = 0.0f;
  in >> kind >> width >> height >> scale;
  in.get();
  EXPECT_EQ(kind, "PF");
  EXPECT_LT(scale, 0.0f);  // little endian
  float values[12];
  in.read(reinterpret_cast<char*>(values), sizeof values);
  ASSERT_TRUE(in);
  EXPECT_FLOAT_EQ(values[0] / std::abs(scale), 4.0f);
  EXPECT_FLOAT_EQ(values[2], 6.0f);
  EXPECT_FLOAT_EQ(values[6], 0.1f);
  std::filesystem::remove(file);
}

// OpenCV reads what foci writes.
TEST(ImageFile, ExrHoldsLinearFloats) {
  Frame frame;
  frame.size_px = {37, 5};
  std::mt19937 random(3);
  std::normal_distribution<float> value(0.0f, 2.0f);
  for (int i = 0; i < 37 * 5; ++i) {
    const float smooth = 0.01f * static_cast<float>(i / 37);  // rows of noise, and one that packs
    frame.rgba.emplace_back(i < 74 ? value(random) : smooth, i < 111 ? value(random) : 1.0f, smooth,
                            1.0f);
  }
  const TemporaryFolder folder;
  const std::string color = (folder.path() / "a.exr").string();
  const std::string map = (folder.path() / "b.exr").string();
  writeImage(color, frame);
  std::vector<float> reds;
  for (const glm::vec4& rgba : frame.rgba) reds.push_back(rgba.r);
  writeMap(map, frame.size_px, reds);
  const cv::Mat bgr = cv::imread(color, cv::IMREAD_UNCHANGED);
  const cv::Mat grey = cv::imread(map, cv::IMREAD_UNCHANGED);
  ASSERT_EQ(bgr.size(), cv::Size(37, 5));
  ASSERT_EQ(bgr.type(), CV_32FC3);
  ASSERT_EQ(grey.size(), cv::Size(37, 5));
  ASSERT_EQ(grey.type(), CV_32FC1);
  for (int i = 0; i < 37 * 5; ++i) {
    const glm::vec4& rgba = frame.rgba[static_cast<std::size_t>(i)];
    EXPECT_EQ(bgr.at<cv::Vec3f>(i / 37, i % 37), cv::Vec3f(rgba.b, rgba.g, rgba.r)) << i;
    EXPECT_EQ(grey.at<float>(i / 37, i % 37), rgba.r) << i;
  }
}

TEST(ImageFile, UnknownExtensionIsRefused) {
  EXPECT_THROW(checkImageExtension("image.gif"), InputError);
  EXPECT_THROW(checkImageExtension("image"), InputError);
  EXPECT_NO_THROW(checkImageExtension("image.exr"));
}

}  // namespace FOCI_FILE
}  // namespace foci
