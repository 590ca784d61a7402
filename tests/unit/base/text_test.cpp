#include "base/text.h"

#include <gtest/gtest.h>

#include <cmath>

namespace foci {
namespace FOCI_FILE {

TEST(Decimal, NeverHasANegativeZero) {
  EXPECT_EQ(decimal(-0.0004, 3), "0.000");
  EXPECT_EQ(decimal(-0.0006, 3), "-0.001");
  EXPECT_EQ(decimalOrInf(HUGE_VAL, 1), "inf");
}

TEST(Counted, HasOneOrMany) {
  EXPECT_EQ(counted(1, "point"), "1 point");
  EXPECT_EQ(counted(2000, "point"), "2,000 points");
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
  EXPECT_EQ(shown("M\xc3\xbcller"), "\"M\xc3\xbcller\"");
  EXPECT_EQ(shown("a\xe2\x80\xae\xc3"), "\"a??\"");  // a turn of the text; half a character
  EXPECT_EQ(shown(std::string(39, 'x') + "\xc3\xbc"), '"' + std::string(39, 'x') + "...\"");
}

TEST(Visible, ShowsControlCharactersAsEscapes) {
  EXPECT_EQ(visible("a\tb\nc\rd"), R"(a\tb\nc\rd)");
  EXPECT_EQ(visible(std::string("\x1b[2J\x07\x7f") + '\0'), R"(\x1b[2J\x07\x7f\x00)");
  EXPECT_EQ(visible("\xc2\x9b"), R"(\x9b)");  // a terminal takes this C1 character for ESC [
  EXPECT_EQ(visible("a\xe2\x80\xae"
                    "b\xe2\x80\xa8"),
            R"(a\u202eb\u2028)");
}

TEST(Visible, KeepsOtherTextAndShowsBytesThatAreNotUtf8) {
  for (const char* text : {"", "B\xc3\xa4r `'\"\\<&>$", "\xe2\x82\xac \xf0\x9f\x90\xab"}) {
    EXPECT_EQ(visible(text), text);
  }
  EXPECT_EQ(visible("\xff"
                    "a"),
            R"(\xffa)");
  EXPECT_EQ(visible("\xc3"), R"(\xc3)");
  EXPECT_EQ(visible("\xc0\xaf"), R"(\xc0\xaf)");          // too long for "/"
  EXPECT_EQ(visible("\xed\xa0\x80"), R"(\xed\xa0\x80)");  // half of a surrogate pair
  EXPECT_EQ(visible("\xf5\x80\x80\x80"), R"(\xf5\x80\x80\x80)");
}

TEST(QuotedText, EscapesForJsonAndToml) {
  EXPECT_EQ(quotedText("a\"b\\c\n"), R"("a\"b\\c\u000a")");
}

}  // namespace FOCI_FILE
}  // namespace foci
