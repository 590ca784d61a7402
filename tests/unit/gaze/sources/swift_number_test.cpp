#include "gaze/sources/swift_number.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <string>

namespace foci {
namespace FOCI_FILE {

/// Parses `text` with bytes behind it that would change the number.
std::optional<double> parse(const std::string& text, const std::string& behind = "9.9.9999") {
  const std::string padded = text + behind;
  return swiftNumber(std::string_view(padded).substr(0, text.size()));
}

TEST(SwiftNumber, GivesTheNearestDouble) {
  std::mt19937_64 random(1);
  int taken = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::size_t length = 1 + random() % 15;
    std::string text;
    while (text.size() < length) text += static_cast<char>('0' + random() % 10);
    if (random() % 4 != 0) text[random() % length] = '.';
    if (random() % 3 == 0) text.insert(0, "-");
    const auto number = parse(text);
    if (!number) continue;
    ++taken;
    EXPECT_EQ(*number, std::strtod(text.c_str(), nullptr)) << text;
  }
  EXPECT_GT(taken, 10000);
}

TEST(SwiftNumber, TakesTheUsualFields) {
  EXPECT_EQ(parse("0"), 0.0);
  EXPECT_EQ(parse("-0.5"), -0.5);
  EXPECT_EQ(parse("7."), 7.0);
  EXPECT_EQ(parse(".25"), 0.25);
  EXPECT_EQ(parse("512.01"), 512.01);
  EXPECT_EQ(parse("71999.998"), 71999.998);
  EXPECT_EQ(parse("1216.218711"), 1216.218711);
  EXPECT_EQ(parse("491999899"), 491999899.0);
  EXPECT_EQ(parse("123456789012345"), 123456789012345.0);
}

TEST(SwiftNumber, RefusesAnyOtherText) {
  for (const char* text :
       {"", "-", ".", "-.", "--1", "+1", "1e5", "nan", "1,5", "1..2", "1.2.3", "a", "1 ", "/1",
        ":1", "1234567890123456", "1.23456789", "\xb0", "1\xff"}) {
    for (const char* behind : {"00000000", "........", "        "}) {
      EXPECT_FALSE(parse(text, behind)) << text;
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
