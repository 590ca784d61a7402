#include <gtest/gtest.h>

#include <glm/gtc/quaternion.hpp>

#include "app/replay/report_charts.h"

namespace foci {
namespace FOCI_FILE {

const std::vector<Change> kPupils = {{.time_s = 1.0, .key = "observer.pupil_mm", .toml = "2"},
                                     {.time_s = 2.0, .key = "observer.pupil_mm", .toml = "4"},
                                     {.time_s = 3.0, .key = "observer.pupil_mm", .toml = "8"},
                                     {.time_s = 3.5, .key = "focus.fixed_D", .toml = "1.5"},
                                     {.time_s = 9.0, .key = "observer.pupil_mm", .toml = "3"}};
const std::vector<TraceMarker> kMarkers = {{0.5, "before"}, {2.5, "a < b"}, {3.0, "stop"}};

TEST(RunChanges, ThoseBeforeTheFirstFrameAreInForceAndLaterOnesAreListed) {
  const RunChanges run = changesOfRun(Study{}, kPupils, kMarkers, 1.0, 4.0);
  EXPECT_EQ(run.start.observer.pupil_mm, 2.0);
  ASSERT_EQ(run.changes.size(), 3u);
  EXPECT_EQ(run.changes[0].from, "2");
  EXPECT_EQ(run.changes[0].to, "4");
  EXPECT_EQ(run.changes[2].from, "null");
  EXPECT_EQ(run.markers.size(), 2u);
  EXPECT_EQ(valuesOf(run.changes, "observer.pupil_mm"), (std::vector<std::string>{"2", "4", "8"}));
  EXPECT_EQ(changesText(run.changes),
            "observer.pupil_mm 2, then 4, then 8; focus.fixed_D absent, then 1.5");
}

TEST(RunChanges, AValueSetAgainIsNoChange) {
  const std::vector<Change> same = {{.time_s = 1.0, .key = "observer.pupil_mm", .toml = "5"},
                                    {.time_s = 2.0, .key = "observer.pupil_mm", .toml = "5.0"}};
  EXPECT_EQ(changesOfRun(Study{}, same, {}, 0.0, 4.0).changes.size(), 1u);
}

TEST(RunChanges, ManyValuesAreCounted) {
  std::vector<Change> moves;
  for (int i = 1; i <= 40; ++i) {
    moves.push_back(
        {.time_s = 0.1 * i, .key = "observer.pupil_mm", .toml = std::to_string(2 + 0.1 * i)});
  }
  const RunChanges run = changesOfRun(Study{}, moves, {}, 0.0, 10.0);
  EXPECT_EQ(changesText(run.changes), "observer.pupil_mm 40 times");
}

TEST(RunChanges, MarksAreInOrderOfTimeAndTheTableIsEscaped) {
  const auto marks = marksOf(changesOfRun(Study{}, kPupils, kMarkers, 1.0, 4.0));
  ASSERT_EQ(marks.size(), 5u);
  EXPECT_TRUE(marks[0].is_change);
  EXPECT_EQ(marks[1].text, "a < b");
  EXPECT_EQ(marks[0].text, "observer.pupil_mm: 2 to 4");
  const std::string table = marksTable(marks);
  EXPECT_NE(table.find("a &lt; b"), std::string::npos);
  EXPECT_EQ(table.find("a < b"), std::string::npos);
  EXPECT_EQ(marksTable({}), "");
}

ChartRow fixating(double time_s, const glm::dvec2& gaze_px) {
  return {.time_s = time_s,
          .gaze_x_px = gaze_px.x,
          .gaze_y_px = gaze_px.y,
          .surface_D = 1.0,
          .target_D = 1.0,
          .focus_D = 1.0,
          .pupil_mm = 4.0,
          .render_ms = 7.0,
          .state = GazeState::fixation};
}

TEST(ReportCharts, MarkTheTimeAxisAndSpeakToScreenReaders) {
  std::vector<ChartRow> rows;
  for (int i = 0; i < 100; ++i) {
    rows.push_back(fixating(1.0 + 0.03 * i, {10.0 + i, 50.0}));
    rows.back().focus_D = 0.01 * i;
  }
  const auto marks = marksOf(changesOfRun(Study{}, kPupils, kMarkers, 1.0, 4.0));
  const auto svg = chartsSvg(rows, {640, 480}, marks).image;
  if (!svg) GTEST_SKIP() << "gnuplot is absent";
  EXPECT_NE(svg->find("role=\"img\" aria-label=\"Gaze, focus, pupil and render time over time\""),
            std::string::npos);
  EXPECT_EQ(svg->find("Gnuplot"), std::string::npos);
  // Axes and words have the page's colour of text, in the light and in the dark.
  EXPECT_NE(svg->find("stroke='var(--ink)'"), std::string::npos);
  EXPECT_NE(svg->find("fill=\"var(--ink)\""), std::string::npos);
  EXPECT_EQ(svg->find("(1,2,3)"), std::string::npos);
  EXPECT_NE(svg->find("2 event markers and 3 changes of settings"), std::string::npos);
  EXPECT_NE(svg->find("horizontal 10 to 109 px"), std::string::npos);
  const auto plain = chartsSvg(rows, {640, 480}, {}).image;
  // Dashed lines for the changes: a path in each of the four panels.
  const auto dashes = [](const std::string& text) {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find("stroke-dasharray", at)) != text.npos; ++at) ++count;
    return count;
  };
  EXPECT_GE(dashes(*svg), dashes(*plain) + 4);
}

TEST(ReportCharts, ShowPausesOfTheRecordingApartFromDataLoss) {
  std::vector<ChartRow> rows;
  for (int i = 0; i < 100; ++i) {
    rows.push_back(fixating(0.1 * i, {10.0, 50.0}));
    if (i >= 40 && i < 60) rows.back().state = GazeState::lost;
  }
  // gnuplot pads the numbers of a colour with blanks.
  const std::string lost = "rgb(201,  74,  74)", pause = "rgb( 74, 163, 184)";
  const auto has = [](const std::string& svg, const std::string& color) {
    return svg.find(color) != std::string::npos;
  };
  const auto loss = chartsSvg(rows, {640, 480}, {}).image;
  if (!loss) GTEST_SKIP() << "gnuplot is absent";
  const auto paused = chartsSvg(rows, {640, 480}, {}, {{3.95, 6.05}}).image;
  EXPECT_TRUE(has(*loss, lost));
  EXPECT_FALSE(has(*loss, pause));
  EXPECT_FALSE(has(*paused, lost));
  EXPECT_TRUE(has(*paused, pause));
}

TEST(ReportCharts, OfAHeadsetHaveAnglesOfTheHeadAndVergence) {
  std::vector<ChartRow> rows;
  for (int i = 0; i <= 90; ++i) {
    // To the right by 270 degrees: the azimuth does not jump at 180.
    rows.push_back(fixating(0.1 * i, {320.0, 240.0}));
    rows.back().vergence_D = 0.5;
    rows.back().world_from_eye = glm::angleAxis(glm::radians(-3.0 * i), glm::dvec3(0, 1, 0));
  }
  const Screen display{.size_px = {640, 480}, .size_m = {0.4, 0.3}, .distance_m = 0.2};
  const auto svg = chartsSvg(rows, {640, 480}, {}, {}, HeadsetAxes{display, {0, 1, 0}}).image;
  if (!svg) GTEST_SKIP() << "gnuplot is absent";
  for (const char* part :
       {"gaze in head, deg", "head, deg", "tilt to the right", "vergence of both eyes", "> 250<"}) {
    EXPECT_NE(svg->find(part), std::string::npos) << part;
  }
  EXPECT_EQ(svg->find(">-150<"), std::string::npos);
  EXPECT_EQ(chartsSvg(rows, {640, 480}, {}).image->find("head, deg"), std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci
