#include "calibration/toml_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <string>
#include <string_view>

#include "base/input_error.h"

namespace foci {
namespace FOCI_FILE {

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

/// A study's path on one line: toml11 alone takes a time with the square of its length.
std::string onOneLine(int elements) {
  std::string text = "a = [";
  for (int i = 0; i < elements; ++i) {
    text +=
        (i ? ", " : "") + std::string("{time_s = ") + std::to_string(i) + ", p = [1.5, 2.5, 3.5]}";
  }
  return text + "]";
}

TEST(TomlFile, ALongLineTakesATimeInProportionToItsLength) {
  const std::clock_t start = std::clock();
  const TomlDocument document = parseToml(onOneLine(20'000), "x");
  EXPECT_EQ(document.table().at("a").as_array().size(), 20'000u);
  // Seconds; with the square of the length it would be minutes.
  EXPECT_LT(std::clock() - start, 30 * CLOCKS_PER_SEC);
}

TEST(TomlFile, LinesOfErrorsAreThoseOfTheFile) {
  const std::string list = "\n" + onOneLine(2000) + "\nb = 1\n";
  const TomlDocument document = parseToml(list, "x");
  EXPECT_GT(document.lines.size(), 50u);
  EXPECT_EQ(document.lineOf(document.table().at("b")), 3);
  EXPECT_EQ(document.lineOf(document.table().at("a").as_array().back()), 2);
  EXPECT_TRUE(refusal(list + "c = [1, }\n").starts_with("x:4: ")) << refusal(list + "c = [1, }\n");
  EXPECT_TRUE(refusal(list + "\xff").starts_with("x:4: "));
}

TEST(TomlFile, LongTextsAreOneValueAndLongTablesInBracesAreRefused) {
  EXPECT_EQ(refusal("a = \"" + std::string(3 << 20, 'A') + "\"\nb = 1"), "");
  std::string table = "a = {k0 = 1";
  for (int i = 1; i < 5000; ++i) table += ", k" + std::to_string(i) + " = 1";
  EXPECT_NE(refusal(table + "}").find("16 KiB"), std::string::npos);
}

TEST(TomlFile, SaysWhatToDoAboutALineThatIsNotToml) {
  const auto last = [](const std::string& text) { return refusal("a = 1\n" + text); };
  EXPECT_EQ(last("b = 0,6"), "x:2: \"b = 0,6\": expected a decimal point");
  EXPECT_EQ(last("b = 4 mm # wide"), "x:2: \"b = 4 mm # wide\": expected a number without a unit");
  EXPECT_EQ(last("b = True"), "x:2: \"b = True\": expected true or false, in small letters");
  EXPECT_EQ(last("b=gallery"), "x:2: \"b=gallery\": expected quotes around a text");
  EXPECT_EQ(last("b = \"C:\\data\""),
            "x:2: \"b = \"C:\\data\"\": expected single quotes around a text with \\");
  for (const std::string number : {"4.", ".5", "-.5", "[1.5, 2.]"}) {
    EXPECT_EQ(last("b = " + number),
              "x:2: \"b = " + number + "\": expected a digit on both sides of the point");
  }
  EXPECT_EQ(last("b = \"no end"), "x:2: \"b = \"no end\": expected a quote at the end, too");
  EXPECT_EQ(last("b: 4"), "x:2: \"b: 4\": expected key = value, or a [table]");
  EXPECT_TRUE(last("a = 2").starts_with("x:2: \"a = 2\": ")) << last("a = 2");
}

TEST(TomlFile, AdvisesOnNothingElseThanTheMistake) {
  const std::string_view advices[] = {"expected", "quote", "decimal"};
  const auto advised = [&](const std::string& text) {
    const std::string why = refusal(text);
    EXPECT_NE(why, "") << text;
    return std::ranges::any_of(
        advices, [&](std::string_view advice) { return why.find(advice) != why.npos; });
  };
  for (const std::string value :
       {"true", "\"C:\\\\a\"", "0x1F", "inf", "1.5", "[1.5, 2.5]", "'a'", "\"a#1\"", "1e5"}) {
    const std::string line = "b = " + value + "\n";
    EXPECT_EQ(refusal(line), "") << line;
    EXPECT_NE(refusal(line + line).find("(\"b\") already exists"), std::string::npos)
        << refusal(line + line);
  }
  for (const std::string text : {"b = [1\n 2]", "b = [\n 1,\n 2 mm\n]", "b = [\n foo\n]",
                                 "b = [1, 2\nc = 3", "b = \"a#1\" \"b\"", "b = \"a\\\"b\" c"}) {
    EXPECT_FALSE(advised(text)) << text << ": " << refusal(text);
  }
  EXPECT_EQ(refusal("b = \"trial #1\\data\""),
            "x:1: \"b = \"trial #1\\data\"\": expected single quotes around a text with \\");
  EXPECT_EQ(refusal("b = None"), "x:1: \"b = None\": expected a value, or no such line");
}

TEST(TomlFile, NamesTheLineOfAStudyThatStartsAsYaml) {
  for (const std::string rest : {"[scene]\n", "a = 1\n"}) {
    EXPECT_EQ(refusal("title: demo\n" + rest),
              "x:1: \"title: demo\": expected key = value, or a [table]");
  }
}

TEST(TomlFile, NamesTheLanguageOfOtherProgramsFiles) {
  const auto other = [](const std::string& language) {
    return "x: " + language + ", not TOML: expected a study, or a file that foci calibrate writes";
  };
  EXPECT_EQ(refusal("image_width: 640\ncamera_matrix:\n  rows: 3\n"), other("YAML"));
  EXPECT_EQ(refusal("%YAML:1.0\n---\ncameraMatrix: !!opencv-matrix\n"), other("YAML"));
  EXPECT_EQ(refusal("<?xml version=\"1.0\"?><opencv_storage/>\n"), other("XML"));
  EXPECT_EQ(refusal("\n{\"camera_matrix\": [[500, 0, 320]]}\n"), other("JSON"));
}

}  // namespace FOCI_FILE
}  // namespace foci
