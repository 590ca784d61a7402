#include "render/methods/quality_level.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace foci {
namespace FOCI_FILE {

constexpr std::array<float, 3> kRelative{16.0f, 4.0f, 1.0f};
constexpr QualityLevel kSlow{0}, kMedium{1}, kQuick{2};

TEST(TimeBudget, PredictsALevelFromTheOthers) {
  TimeBudget budget(kRelative);
  EXPECT_TRUE(std::isinf(budget.expected_ms(kSlow)));
  budget.took(kQuick, 3.0f, false);
  EXPECT_FLOAT_EQ(budget.expected_ms(kSlow), 48.0f);
  budget.took(kMedium, 6.0f, false);
  EXPECT_FLOAT_EQ(budget.expected_ms(kSlow), 24.0f);  // from the medium level, which is most alike
}

TEST(TimeBudget, TheHopefulBeginWithTheBestLevel) {
  TimeBudget budget(kRelative, true);
  EXPECT_TRUE(budget.fits(kSlow, 1.0f));
  budget.took(kSlow, 20.0f, false);
  EXPECT_FALSE(budget.fits(kSlow, 10.0f));
  EXPECT_TRUE(budget.fits(kMedium, 10.0f));
}

TEST(TimeBudget, AnotherLevelNeedsAReserve) {
  TimeBudget budget(kRelative);
  budget.took(kMedium, 9.9f, false);
  EXPECT_TRUE(budget.fits(kMedium, 10.0f));
  budget.took(kQuick, 1.0f, false);
  EXPECT_FALSE(budget.fits(kMedium, 10.0f));
  EXPECT_TRUE(budget.fits(kQuick, 10.0f));
}

TEST(TimeBudget, OneSlowFrameDoesNotRuleALevelOut) {
  TimeBudget budget(kRelative);
  for (int i = 0; i < 10; ++i) budget.took(kSlow, 8.0f, false);
  budget.took(kSlow, 500.0f, false);
  EXPECT_TRUE(budget.fits(kSlow, 10.0f));
  for (int i = 0; i < 5; ++i) budget.took(kSlow, 500.0f, false);
  EXPECT_FALSE(budget.fits(kSlow, 10.0f));
}

TEST(TimeBudget, TriesAgainSoonerWhereTheViewMoves) {
  const auto framesUntilFits = [](bool moved) {
    TimeBudget budget(kRelative);
    budget.took(kSlow, 20.0f, false);
    int frames = 0;
    while (!budget.fits(kSlow, 10.0f)) budget.took(kQuick, 1.0f, moved), ++frames;
    return frames;
  };
  EXPECT_LT(50 * framesUntilFits(true), framesUntilFits(false));
}

}  // namespace FOCI_FILE
}  // namespace foci
