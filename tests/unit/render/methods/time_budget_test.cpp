#include "render/methods/time_budget.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace foci {
namespace {

constexpr std::array<float, 3> kLikely{16.0f, 4.0f, 1.0f};

TEST(TimeBudget, ExpectsOfTheUnknownWhatTheKnownTells) {
  TimeBudget budget(kLikely);
  EXPECT_TRUE(std::isinf(budget.expected_ms(0)));
  budget.took(2, 3.0f, false);
  EXPECT_FLOAT_EQ(budget.expected_ms(0), 48.0f);
  budget.took(1, 6.0f, false);
  EXPECT_FLOAT_EQ(budget.expected_ms(0), 24.0f);  // the nearest alike
}

TEST(TimeBudget, AnotherWayMustFitWell) {
  TimeBudget budget(kLikely);
  budget.took(1, 9.9f, false);
  EXPECT_TRUE(budget.fits(1, 10.0f));
  budget.took(2, 1.0f, false);
  EXPECT_FALSE(budget.fits(1, 10.0f));
  EXPECT_TRUE(budget.fits(2, 10.0f));
}

TEST(TimeBudget, OneHiccupIsNotTheWay) {
  TimeBudget budget(kLikely);
  for (int i = 0; i < 10; ++i) budget.took(0, 8.0f, false);
  budget.took(0, 500.0f, false);
  EXPECT_TRUE(budget.fits(0, 10.0f));
  for (int i = 0; i < 5; ++i) budget.took(0, 500.0f, false);
  EXPECT_FALSE(budget.fits(0, 10.0f));
}

TEST(TimeBudget, TriesAgainSoonerWhereTheViewMoves) {
  const auto framesUntilFits = [](bool moved) {
    TimeBudget budget(kLikely);
    budget.took(0, 20.0f, false);
    int frames = 0;
    while (!budget.fits(0, 10.0f)) budget.took(2, 1.0f, moved), ++frames;
    return frames;
  };
  EXPECT_LT(50 * framesUntilFits(true), framesUntilFits(false));
}

}  // namespace
}  // namespace foci
