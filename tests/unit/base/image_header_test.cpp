#include "base/image_codec.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <span>
#include <string>
#include <vector>

namespace foci {
namespace FOCI_FILE {

TEST(ImageHeader, StatesTheSizeOfWhatOpenCvWrites) {
  const cv::Mat image(37, 211, CV_8UC3, cv::Scalar(10, 200, 30));
  for (const char* extension : {".png", ".jpg", ".bmp", ".webp", ".tiff"}) {
    std::vector<unsigned char> bytes;
    ASSERT_TRUE(cv::imencode(extension, image, bytes)) << extension;
    const auto size = statedImageSize(bytes);
    ASSERT_TRUE(size) << extension;
    EXPECT_EQ(size->columns, 211u) << extension;
    EXPECT_EQ(size->rows, 37u) << extension;
    for (std::size_t length = 0; length < bytes.size();
         length += 1 + length / 64) {  // a short file is no fault
      statedImageSize(std::span(bytes).first(length));
    }
  }
}

TEST(ImageHeader, OtherBytesStateNothing) {
  const std::string text = "GIF89a and more bytes than any header has";
  EXPECT_FALSE(statedImageSize({reinterpret_cast<const unsigned char*>(text.data()), text.size()}));
  EXPECT_FALSE(statedImageSize({}));
}

}  // namespace FOCI_FILE
}  // namespace foci
