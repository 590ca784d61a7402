#include "render/methods/quality_level.h"

#include <gtest/gtest.h>

#include "render/methods/method.h"

namespace foci {
namespace FOCI_FILE {

TEST(QualityLevel, ItsTextIsReadBack) {
  for (int n = 1; n <= static_cast<int>(kQualityLevels); ++n) {
    const auto level = qualityLevelNumbered(n);
    ASSERT_TRUE(level);
    EXPECT_EQ(textOf(*level), "auto:" + std::to_string(n));
    EXPECT_EQ(qualityLevelFrom(textOf(*level)), level);
    EXPECT_FALSE(expectedMethod(textOf(*level)));
  }
}

// Records of earlier versions hold these numbers.
TEST(QualityLevel, ItsNumbersStayTheSame) {
  EXPECT_EQ(textOf(QualityLevel::sharp), "auto:1");
  EXPECT_EQ(textOf(QualityLevel::whole_aperture), "auto:3");
  EXPECT_EQ(textOf(QualityLevel::fine), "auto:5");
  EXPECT_EQ(textOf(QualityLevel::softest), "auto:8");
  EXPECT_EQ(textOf(QualityLevel::thorough), "auto:9");
}

TEST(QualityLevel, OtherTextIsNoLevel) {
  for (const char* text : {"", "auto", "auto:", "auto:0", "auto:10", "auto:3x", "auto:-1",
                           "autumn:3", "sweep-lod:3", "3"}) {
    EXPECT_EQ(qualityLevelFrom(text), std::nullopt) << text;
  }
  EXPECT_EQ(qualityLevelNumbered(0), std::nullopt);
  EXPECT_EQ(qualityLevelNumbered(10), std::nullopt);
}

}  // namespace FOCI_FILE
}  // namespace foci
