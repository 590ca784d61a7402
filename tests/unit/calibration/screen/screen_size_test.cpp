#include "calibration/screen/screen_size.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>

#include "base/input_error.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-12;
const double kSlope = std::tan(glm::radians(13.5));

TEST(BankCard, GivesTheDensity) {
  EXPECT_NEAR(pxPerMetreOfCard(342.4, {}).x, 4000.0, 1e-9);
  const glm::dvec2 oblong = pxPerMetreOfCard(342.4, 224.5);
  EXPECT_NEAR(oblong.y, 224.5 / 0.05398, 1e-9);
  EXPECT_THROW(pxPerMetreOfCard(342.4, 342.4), InputError);  // not a card
  EXPECT_THROW(pxPerMetreOfCard(1.0, {}), InputError);
  EXPECT_THROW(pxPerMetreOfCard(NAN, {}), InputError);
}

TEST(BlindSpot, RecoversTheDistanceFromBothDirections) {
  // The reaction time carries the dot on: outwards too far, inwards too near, by as much.
  std::vector<BlindSpotRun> runs;
  for (const double late_m : {0.004, 0.005, 0.006}) {
    runs.push_back({.offset_m = 0.6 * kSlope + late_m, .outwards = true});
    runs.push_back({.offset_m = 0.6 * kSlope - late_m, .outwards = false});
  }
  EXPECT_NEAR(distanceByBlindSpot(runs).distance_m, 0.6, kRounding);
}

TEST(BlindSpot, RefusesTheRunThatDisagrees) {
  std::vector<BlindSpotRun> runs(5, {.offset_m = 0.6 * kSlope, .outwards = true});
  runs[2].offset_m *= 1.4;
  const BlindSpotDistance found = distanceByBlindSpot(runs);
  EXPECT_NEAR(found.distance_m, 0.6, kRounding);
  ASSERT_EQ(found.refused.size(), 1u);
  EXPECT_EQ(found.refused[0], 2u);
}

TEST(BlindSpot, RefusesTooFewAndImpossibleRuns) {
  std::vector<BlindSpotRun> runs(2, {.offset_m = 0.14, .outwards = true});
  EXPECT_THROW(distanceByBlindSpot(runs), InputError);
  runs.assign(4, {.offset_m = 40.0, .outwards = true});
  EXPECT_THROW(distanceByBlindSpot(runs), InputError);
  runs[0].offset_m = -1.0;
  EXPECT_THROW(distanceByBlindSpot(runs), InputError);
}

TEST(FaceSize, HalfTheFaceIsTwiceAsFar) {
  EXPECT_NEAR(distanceByFace_m(100.0, 200.0, 0.5), 1.0, kRounding);
  EXPECT_THROW(distanceByFace_m(0.0, 200.0, 0.5), InputError);
  EXPECT_THROW(distanceByFace_m(1.0, 200.0, 0.5), InputError);
}

/// @param size_cm  absent: as the millimetres say
std::array<unsigned char, 128> edidOf(int width_mm, int height_mm, bool detailed,
                                      std::optional<glm::ivec2> size_cm = {}) {
  std::array<unsigned char, 128> edid{0, 255, 255, 255, 255, 255, 255, 0};
  edid[21] = static_cast<unsigned char>(size_cm ? size_cm->x : width_mm / 10);
  edid[22] = static_cast<unsigned char>(size_cm ? size_cm->y : height_mm / 10);
  if (detailed) {
    edid[54] = 1;
    edid[66] = static_cast<unsigned char>(width_mm & 255);
    edid[67] = static_cast<unsigned char>(height_mm & 255);
    edid[68] = static_cast<unsigned char>((width_mm >> 8) << 4 | height_mm >> 8);
  }
  const int sum = std::accumulate(edid.begin(), edid.end(), 0);
  edid[127] = static_cast<unsigned char>((256 - sum % 256) % 256);
  return edid;
}

TEST(Edid, StatesTheSizeInMillimetresOrElseCentimetres) {
  EXPECT_EQ(*edidSize(edidOf(531, 299, true)).size_m, glm::dvec2(0.531, 0.299));
  EXPECT_EQ(*edidSize(edidOf(531, 299, false)).size_m, glm::dvec2(0.53, 0.29));
  EXPECT_FALSE(edidSize(edidOf(0, 0, false)).size_m);
  auto broken = edidOf(531, 299, true);
  ++broken[30];
  EXPECT_THROW(edidSize(broken), InputError);
  EXPECT_THROW(edidSize(std::span(broken).first(100)), InputError);
}

TEST(Edid, DoubtsADetailedTimingThatIsARatioOrInCentimetres) {
  const glm::ivec2 size_cm(53, 30);
  EXPECT_EQ(edidSize(edidOf(531, 299, true, size_cm)).warning, "");
  for (const auto& timing_mm : {glm::ivec2(160, 90), glm::ivec2(53, 30), glm::ivec2(299, 531)}) {
    const EdidSize size = edidSize(edidOf(timing_mm.x, timing_mm.y, true, size_cm));
    EXPECT_EQ(*size.size_m, glm::dvec2(0.53, 0.3));
    EXPECT_NE(size.warning.find("53 x 30 cm"), std::string::npos) << size.warning;
  }
  EXPECT_EQ(*edidSize(edidOf(531, 299, true, glm::ivec2(16, 9))).size_m, glm::dvec2(0.531, 0.299));
  for (const int width_mm : {0, 160}) {
    const EdidSize ratio = edidSize(edidOf(width_mm, 90, true, glm::ivec2(16, 9)));
    EXPECT_EQ(*ratio.size_m, glm::dvec2(0.16, 0.09));
    EXPECT_NE(ratio.warning.find("16 x 9 cm"), std::string::npos) << ratio.warning;
  }
}

TEST(Edid, TakesMillimetresBesideRoundCentimetres) {
  const EdidSize size = edidSize(edidOf(597, 336, true, glm::ivec2(60, 32)));
  EXPECT_EQ(*size.size_m, glm::dvec2(0.597, 0.336));
  EXPECT_EQ(size.warning, "");
}

TEST(Edid, DoubtsThePlaceholderOfTvs) {
  for (const bool detailed : {false, true}) {
    const EdidSize size = edidSize(edidOf(1600, 900, detailed));
    EXPECT_EQ(*size.size_m, glm::dvec2(1.6, 0.9));
    EXPECT_NE(size.warning.find("160 x 90 cm"), std::string::npos) << size.warning;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
