#include "base/image_codec.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace foci {
namespace FOCI_FILE {

cv::Mat gradient(int type) {
  cv::Mat image(13, 37, type);
  cv::randu(image, 0, CV_MAT_DEPTH(type) == CV_16U ? 65536 : 256);
  cv::GaussianBlur(image, image, {5, 5}, 2.0);
  return image;
}

/// What foci and OpenCV make of the same bytes, which OpenCV has written.
void expectEqualToOpenCv(const char* extension, int type) {
  SCOPED_TRACE(std::string(extension) + " " + std::to_string(type));
  std::vector<unsigned char> bytes;
  cv::imencode(extension, gradient(type), bytes);
  const auto decoded = decodeImage(bytes);
  ASSERT_TRUE(decoded);
  cv::Mat expected = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  expected.convertTo(expected, CV_8U, expected.depth() == CV_16U ? 1.0 / 257.0 : 1.0);
  const int channels = expected.channels();
  cv::cvtColor(expected, expected,
               channels == 1   ? cv::COLOR_GRAY2RGBA
               : channels == 3 ? cv::COLOR_BGR2RGBA
                               : cv::COLOR_BGRA2RGBA);
  ASSERT_EQ(decoded->columns, expected.cols);
  ASSERT_EQ(decoded->rows, expected.rows);
  EXPECT_EQ(decoded->rgba, std::vector<std::uint8_t>(expected.datastart, expected.dataend));
}

TEST(ImageCodec, ReadsWhatOpenCvReads) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3, CV_16UC4}) {
    expectEqualToOpenCv(".png", type);
  }
  for (const int type : {CV_8UC1, CV_8UC3}) expectEqualToOpenCv(".jpg", type);
  for (const int type : {CV_8UC3, CV_8UC4}) expectEqualToOpenCv(".webp", type);
}

TEST(ImageCodec, WritesWhatOpenCvReads) {
  const cv::Mat rgb = gradient(CV_8UC3), grey = gradient(CV_8UC1);
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  const cv::Mat read = cv::imdecode(encodePng(37, 13, 3, rgb.data), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(cv::norm(read, bgr, cv::NORM_INF), 0.0);
  const cv::Mat one = cv::imdecode(encodePng(37, 13, 1, grey.data), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(cv::norm(one, grey, cv::NORM_INF), 0.0);
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", bgr, jpeg, {cv::IMWRITE_JPEG_QUALITY, 80});
  EXPECT_EQ(encodeJpeg(37, 13, rgb.data, 80), jpeg);
}

TEST(ImageCodec, RefusesBrokenAndLargeImages) {
  std::vector<unsigned char> png;
  cv::imencode(".png", gradient(CV_8UC3), png);
  for (std::size_t size = 0; size + 12 < png.size(); size += 7) {  // up to the chunk IEND
    EXPECT_FALSE(decodeImage(std::span(png).first(size))) << size;
  }
  EXPECT_FALSE(decodeImage(png, 37 * 13 - 1));
  EXPECT_TRUE(decodeImage(png, 37 * 13));
  std::vector<unsigned char> jpeg, webp;
  cv::imencode(".jpg", gradient(CV_8UC3), jpeg);
  cv::imencode(".webp", gradient(CV_8UC3), webp);
  EXPECT_FALSE(decodeImage(std::span(jpeg).first(40)));
  EXPECT_FALSE(decodeImage(std::span(webp).first(40)));
  EXPECT_FALSE(decodeImage(jpeg, 100));
  EXPECT_FALSE(decodeImage(webp, 100));
}

}  // namespace FOCI_FILE
}  // namespace foci
