#include "base/text.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace foci {
namespace FOCI_FILE {

TEST(ParseNumber, TakesFiniteNumbersThatFillTheText) {
  EXPECT_EQ(parseNumber("1.5"), 1.5);
  EXPECT_EQ(parseNumber("+2"), 2.0);
  EXPECT_EQ(parseNumber("-.5e1"), -5.0);
  for (const char* text : {"", "+", "+-2", " 1", "1 ", "1px", "1,5", "inf", "nan", "1e999"}) {
    EXPECT_FALSE(parseNumber(text)) << text;
  }
}

TEST(ParseInteger, TakesIntegersThatFillTheTextAndFit) {
  EXPECT_EQ(parseInteger<int>("-17"), -17);
  EXPECT_EQ(parseInteger<std::uint64_t>("18446744073709551615"), UINT64_MAX);
  for (const char* text : {"", "+1", "1.0", "1 ", "2147483648"}) {
    EXPECT_FALSE(parseInteger<int>(text)) << text;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
