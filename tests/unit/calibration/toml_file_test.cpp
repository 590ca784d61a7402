#include "calibration/toml_file.h"

#include <gtest/gtest.h>

#include "base/input_error.h"

namespace foci {
namespace {

std::string refusal(const std::string& text) {
  try {
    parseToml(text, "x");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(TomlFile, TakesEveryCharacterOfUnicode) {
  for (const char* name :
       {"a", "\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xee\x80\x80", "\xef\xbf\xbf",
        "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf", "\\\"\xc3\xa9\\\\"}) {
    EXPECT_EQ(refusal("\n\"" + std::string(name) + "\" = 1 # " + name), "") << name;
  }
}

// toml11 itself would read beyond its buffer to report them.
TEST(TomlFile, RefusesWhatIsNotUtf8) {
  for (const char* name :
       {"\x80", "\xbf", "\xc1\xbf", "\xc3", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xe2\x82",
        "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff", "a\\\x9e"}) {
    for (const char* quote : {"'", "\""}) {
      EXPECT_EQ(refusal("\n" + std::string(quote) + name + quote + " = 1"),
                "x:2: a byte that is not UTF-8: not TOML")
          << name;
    }
  }
  EXPECT_EQ(refusal("a = 1 # \xff"), "x:1: a byte that is not UTF-8: not TOML");
}

TEST(TomlFile, CountsNestingOutsideTextsAndComments) {
  const std::string brackets(40, '['), dots = "a" + std::string(40, '.');
  EXPECT_EQ(refusal("a = '" + brackets + "' # " + brackets + dots), "");
  EXPECT_EQ(refusal("a = \"\\\"" + brackets + dots + "\""), "");
  std::string numbers = "a = [1.5";
  for (int i = 0; i < 2000; ++i) numbers += ", 1.5";
  EXPECT_EQ(refusal(numbers + "]"), "");
  EXPECT_EQ(refusal("\na = " + brackets), "x:2: nested too deeply");
  EXPECT_EQ(refusal("a" + std::string(17, '.') + "b = 1"), "x:1: nested too deeply");
}

}  // namespace
}  // namespace foci
