#include "base/text.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/number.h"

namespace foci {
namespace {

TEST(Decimal, NeverHasANegativeZero) {
  EXPECT_EQ(decimal(-0.0004, 3), "0.000");
  EXPECT_EQ(decimal(-0.0006, 3), "-0.001");
  EXPECT_EQ(decimalOrInf(HUGE_VAL, 1), "inf");
}

TEST(ExactText, ReadsBackAsTheSameNumber) {
  for (const double value : {0.1, 1.0 / 3.0, -1e300, 5e-324}) {
    EXPECT_EQ(parseNumber(exactText(value)), value);
  }
  EXPECT_EQ(exactText(-HUGE_VAL), "-inf");
  EXPECT_EQ(exactText(NAN), "nan");
}

TEST(Trimmed, RemovesBlanksAtBothEnds) {
  EXPECT_EQ(trimmed(" \ta b\r"), "a b");
  EXPECT_EQ(trimmed("  "), "");
  EXPECT_EQ(trimmed(""), "");
}

TEST(Shown, IsShortAndPrintable) {
  EXPECT_EQ(shown("a\nb\xff"), "\"a?b?\"");
  EXPECT_EQ(shown(std::string(50, 'x')), '"' + std::string(40, 'x') + "...\"");
}

TEST(QuotedText, EscapesForJsonAndToml) {
  EXPECT_EQ(quotedText("a\"b\\c\n"), R"("a\"b\\c\u000a")");
}

}  // namespace
}  // namespace foci
