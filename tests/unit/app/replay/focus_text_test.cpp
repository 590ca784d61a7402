#include <gtest/gtest.h>

#include "app/replay/report.h"

namespace foci {
namespace FOCI_FILE {

TEST(FocusText, NamesWhatHidesTheBlur) {
  Study study;
  study.screen.size_px = {1920, 1080};
  study.screen.size_m = {0.53, 0.30};
  study.screen.distance_m = 0.6;
  ReportFacts facts;
  facts.summary.fixations = 2;
  facts.summary.pupil_mm = 4.0;
  facts.rows.resize(2);
  facts.rows[0].focus_D = 0.2;
  facts.rows[1].focus_D = 0.8;
  study.output.size_px = {960, 540};
  EXPECT_EQ(focusText(study, facts), "");
  study.output.size_px = {96, 54};
  EXPECT_EQ(focusText(study, facts),
            "focus varies by 0.60 D: no visible blur in frames of 96 x 54 px; set a larger "
            "output.size_px (screen: 1920 x 1080)");
  facts.rows.back().focus_D = 0.21;
  EXPECT_EQ(focusText(study, facts),
            "focus varies by 0.01 D: no visible blur; move nearer, or set a larger pupil");
}

}  // namespace FOCI_FILE
}  // namespace foci
