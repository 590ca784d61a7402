#include "base/text.h"

#include <gtest/gtest.h>

#include <cmath>

namespace foci {
namespace FOCI_FILE {

TEST(Words, StandBetweenBlanksOrOtherCharacters) {
  using Words = std::vector<std::string_view>;
  EXPECT_EQ(wordsOf(" a\tbc \r"), (Words{"a", "bc"}));
  EXPECT_EQ(wordsOf("a b;c;;", ";"), (Words{"a b", "c"}));
  EXPECT_TRUE(wordsOf(" \t").empty());
  EXPECT_EQ(lowered("PLY \xc4"), "ply \xc4");
}

TEST(Words, NumbersFillTheWord) {
  EXPECT_EQ(numberOf("+1.5e2"), 150.0);
  EXPECT_TRUE(std::isnan(*numberOf("nan")));
  EXPECT_EQ(numberOf("1e999"), HUGE_VAL);
  EXPECT_EQ(numberOf("1e-999"), 0.0);
  for (const char* word : {"", "1x", "x", "1 ", "0,5"}) EXPECT_FALSE(numberOf(word)) << word;
}

}  // namespace FOCI_FILE
}  // namespace foci
