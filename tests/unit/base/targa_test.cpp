#include "base/image_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <span>
#include <string_view>
#include <vector>

namespace foci {
namespace FOCI_FILE {

using Bytes = std::vector<unsigned char>;

constexpr unsigned char kFromTop = 0x20;

/// A header as the specification lists its fields, for 2 x 2 pixels, then the data.
Bytes targa(int kind, int bits, int descriptor, const Bytes& data,
            const Bytes& palette_fields = {}) {
  Bytes bytes(18, 0);
  bytes[2] = static_cast<unsigned char>(kind);
  std::copy(palette_fields.begin(), palette_fields.end(), bytes.begin() + 3);
  if (!palette_fields.empty()) bytes[1] = 1;
  bytes[12] = bytes[14] = 2;
  bytes[16] = static_cast<unsigned char>(bits);
  bytes[17] = static_cast<unsigned char>(descriptor);
  bytes.insert(bytes.end(), data.begin(), data.end());
  return bytes;
}

void expectPixels(const Bytes& bytes, const std::vector<std::uint8_t>& rgba) {
  const auto image = decodeTarga(bytes, 4);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->columns, 2);
  EXPECT_EQ(image->rows, 2);
  EXPECT_EQ(image->rgba, rgba);
}

TEST(Targa, ReadsRowsFromTheBottomOrTheTop) {
  const Bytes bgr{3, 2, 1, 6, 5, 4, 9, 8, 7, 12, 11, 10};
  expectPixels(targa(2, 24, 0, bgr), {7, 8, 9, 255, 10, 11, 12, 255, 1, 2, 3, 255, 4, 5, 6, 255});
  expectPixels(targa(2, 24, kFromTop, bgr),
               {1, 2, 3, 255, 4, 5, 6, 255, 7, 8, 9, 255, 10, 11, 12, 255});
  expectPixels(targa(2, 24, kFromTop | 0x10, bgr),
               {4, 5, 6, 255, 1, 2, 3, 255, 10, 11, 12, 255, 7, 8, 9, 255});
}

TEST(Targa, ReadsRunLengthsThatCrossRows) {
  expectPixels(targa(10, 32, kFromTop | 8, {0x82, 3, 2, 1, 99, 0x00, 6, 5, 4, 7}),
               {1, 2, 3, 99, 1, 2, 3, 99, 1, 2, 3, 99, 4, 5, 6, 7});
  // Without bits of alpha, the fourth byte is anything.
  expectPixels(targa(10, 32, kFromTop, {0x82, 3, 2, 1, 99, 0x00, 6, 5, 4, 7}),
               {1, 2, 3, 255, 1, 2, 3, 255, 1, 2, 3, 255, 4, 5, 6, 255});
}

TEST(Targa, ReadsGreyPalettesAndSixteenBits) {
  expectPixels(targa(3, 8, kFromTop, {0, 1, 2, 255}),
               {0, 0, 0, 255, 1, 1, 1, 255, 2, 2, 2, 255, 255, 255, 255, 255});
  // Colours 5 and 6 of 24 bits.
  const Bytes fields{5, 0, 2, 0, 24};
  expectPixels(targa(1, 8, kFromTop, {3, 2, 1, 6, 5, 4, 5, 6, 6, 5}, fields),
               {1, 2, 3, 255, 4, 5, 6, 255, 4, 5, 6, 255, 1, 2, 3, 255});
  EXPECT_FALSE(decodeTarga(targa(1, 8, kFromTop, {3, 2, 1, 6, 5, 4, 5, 6, 7, 5}, fields), 4));
  // Red, green and blue, full; then black, whose highest bit alone is set.
  const Bytes words{0x00, 0x7c, 0xe0, 0x03, 0x1f, 0x00, 0x00, 0x80};
  expectPixels(targa(2, 16, kFromTop, words),
               {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 0, 0, 0, 255});
  expectPixels(targa(2, 16, kFromTop | 1, words),
               {255, 0, 0, 0, 0, 255, 0, 0, 0, 0, 255, 0, 0, 0, 0, 255});
}

TEST(Targa, TakesAlphaAsItsExtensionSays) {
  const Bytes bgra{3, 2, 1, 0, 6, 5, 4, 0, 9, 8, 7, 0, 12, 11, 10, 0};
  const auto stating = [&](int alpha_type) {
    Bytes bytes = targa(2, 32, kFromTop | 8, bgra);
    const auto extension = static_cast<unsigned char>(bytes.size());
    bytes.resize(bytes.size() + 495, 0);
    bytes.back() = static_cast<unsigned char>(alpha_type);
    const Bytes footer{extension, 0, 0, 0, 0, 0, 0, 0};
    bytes.insert(bytes.end(), footer.begin(), footer.end());
    for (const char c : std::string_view("TRUEVISION-XFILE.\0", 18)) {
      bytes.push_back(static_cast<unsigned char>(c));
    }
    return bytes;
  };
  expectPixels(stating(3), {1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 0, 10, 11, 12, 0});
  for (const int nothing : {0, 1, 2}) {
    expectPixels(stating(nothing), {1, 2, 3, 255, 4, 5, 6, 255, 7, 8, 9, 255, 10, 11, 12, 255});
  }
  EXPECT_FALSE(decodeTarga(stating(4), 4));  // colours multiplied by alpha
}

TEST(Targa, RefusesOtherBytes) {
  const Bytes whole = targa(2, 24, 0, {3, 2, 1, 6, 5, 4, 9, 8, 7, 12, 11, 10});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(decodeTarga(std::span(whole).first(size), 4)) << size;
  }
  EXPECT_TRUE(decodeTarga(whole, 4));
  EXPECT_FALSE(decodeTarga(whole, 3));
  EXPECT_FALSE(decodeTarga(targa(2, 24, 0x40, Bytes(16)), 4));  // interleaved
  EXPECT_FALSE(decodeTarga(targa(2, 8, 0, Bytes(16)), 4));
  EXPECT_FALSE(decodeTarga(targa(4, 24, 0, Bytes(16)), 4));
  EXPECT_FALSE(decodeTarga(targa(1, 8, 0, Bytes(16)), 4));  // no palette
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {  // nothing is read beyond the end
    Bytes bytes = targa(1 + i % 3 + 8 * (i % 2), 8, 0, Bytes(24), {0, 0, 3, 0, 24});
    for (int k = 0; k < 4; ++k) bytes[random() % bytes.size()] = random() & 0xff;
    (void)decodeTarga(bytes, 1000);
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
