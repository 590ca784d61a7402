// `foci replay` and `foci render`, as users run them.
#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::size_t kRenderMs = 13;  // the last column of frames.tsv, the only timing

std::set<std::string> filesIn(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
  return names;
}

/// A scene, a recording and a study of both.
class Replay : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("study.toml", smallStudy());
    folder.write("scene.ply", squarePly(24, 1.0));
    folder.write("trace.tsv", steadyTrace());
  }

  Outcome replay(const std::string& out, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"replay", "study.toml", "--out", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runFoci(arguments, folder.path());
  }

  TemporaryFolder folder;
};

TEST_F(Replay, WritesItsFilesAndNothingElse) {
  const Outcome outcome = replay("deep/out");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(filesIn(folder.path() / "deep/out"),
            (std::set<std::string>{".foci-outputs", "events.tsv", "fixations.tsv", "frames.tsv",
                                   "gaze3d.tsv", "manifest.json", "methods.md", "objects.tsv",
                                   "references.bib", "report.html", "saccades.tsv", "video.mp4"}));
  EXPECT_EQ(folder.read("deep/out/video.mp4").substr(4, 4), "ftyp");
  EXPECT_NE(folder.read("deep/out/video.mp4").find("avc1"), std::string::npos);
}

TEST_F(Replay, TabulatesEveryFrame) {
  ASSERT_EQ(replay("out").exit_code, 0);
  const auto rows = tableOf(folder.read("out/frames.tsv"));
  ASSERT_EQ(rows.size(), 7u);  // 0.6 s at 10 a second
  EXPECT_EQ(rows[0], (std::vector<std::string>{"frame",
                                               "time_s",
                                               "gaze_time_s",
                                               "gaze_x_px",
                                               "gaze_y_px",
                                               "gaze_state",
                                               "surface_distance_m",
                                               "target_D",
                                               "focus_D",
                                               "pupil_mm",
                                               "method",
                                               "splats",
                                               "fragments",
                                               "tolerance_error",
                                               "tolerance_met",
                                               "quality_level",
                                               "vergence_D",
                                               "vergence_error_D",
                                               "vergence_disagrees",
                                               "eye_x_m",
                                               "eye_y_m",
                                               "eye_z_m",
                                               "eye_qx",
                                               "eye_qy",
                                               "eye_qz",
                                               "eye_qw",
                                               "trial",
                                               "render_ms"}));
  EXPECT_EQ(rows[3][0], "2");
  EXPECT_EQ(rows[3][1], "0.200000");
  EXPECT_EQ(rows[3][2], "0.200000");
  EXPECT_EQ(rows[3][3], "320.00");
  EXPECT_EQ(rows[6][5], "fixation");
  constexpr double kPrinted = 6e-5;               // four digits
  EXPECT_NEAR(std::stod(rows[6][6]), 1.0, 1e-3);  // the square is flat, the cone is narrow
  EXPECT_NEAR(std::stod(rows[6][7]), 1.0 / std::stod(rows[6][6]), kPrinted);
  EXPECT_NEAR(std::stod(rows[6][8]), std::stod(rows[6][7]), 1e-3);
}

TEST_F(Replay, ReusesThePreviousFrameOfASteadyGaze) {
  ASSERT_EQ(replay("out").exit_code, 0);
  const auto rows = tableOf(folder.read("out/frames.tsv"));
  const Json summary = Json::parse(folder.read("out/manifest.json"))["summary"];
  const auto rendered = std::count_if(rows.begin() + 1, rows.end(),
                                      [](const auto& row) { return row.back() != "0.000"; });
  EXPECT_EQ(summary["frames_rendered"], rendered);
  EXPECT_NE(rows[1].back(), "0.000");
  EXPECT_EQ(rows[2].back(), "0.000");  // the gaze is steady
  const std::string report = folder.read("out/report.html");
  EXPECT_NE(report.find(std::to_string(rendered) + " of 6"), std::string::npos);
}

TEST_F(Replay, ReportsFramesAboveTheTolerance) {
  folder.write("strict.toml", smallStudy() + "\n[quality]\ntolerance = 0.1\n");
  folder.write("loose.toml", smallStudy() + "\n[quality]\ntolerance = 100\n");
  const Outcome strict = runFoci({"replay", "strict.toml", "--out", "strict"}, folder.path());
  ASSERT_EQ(strict.exit_code, 0) << strict.err;
  EXPECT_NE(strict.err.find("In 6 of 6 frames"), std::string::npos) << strict.err;
  EXPECT_NE(folder.read("strict/report.html").find("In 6 of 6 frames"), std::string::npos);
  const auto rows = tableOf(folder.read("strict/frames.tsv"));
  EXPECT_GT(std::stod(rows[1][13]), 0.1);

  const Outcome loose = runFoci({"replay", "loose.toml", "--out", "loose"}, folder.path());
  ASSERT_EQ(loose.exit_code, 0) << loose.err;
  EXPECT_EQ(loose.err.find("just-noticeable"), std::string::npos) << loose.err;
}

TEST_F(Replay, KeepsFocusDuringDataLoss) {
  std::string trace = "time_s\tx_px\ty_px\n";
  for (int i = 0; i < 100; ++i) {
    trace += std::to_string(0.01 * i) + (i > 30 ? "\tn/a\tn/a\n" : "\t320\t240\n");
  }
  folder.write("trace.tsv", trace);
  ASSERT_EQ(replay("out", {"--seconds", "0:0.9"}).exit_code, 0);
  const auto rows = tableOf(folder.read("out/frames.tsv"));
  const auto& last = rows.back();
  EXPECT_EQ(last[3], "n/a");
  EXPECT_EQ(last[4], "n/a");
  EXPECT_TRUE(last[5] == "lost" || last[5] == "blink") << last[5];
  EXPECT_NEAR(std::stod(last[8]), 1.0, 1e-3);
}

TEST_F(Replay, VideoDoesNotDependOnTheNumberOfCores) {
  cpu_set_t all, one;
  ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
  if (CPU_COUNT(&all) < 2) GTEST_SKIP() << "one core";
  CPU_ZERO(&one);
  for (int core = 0; CPU_COUNT(&one) == 0; ++core) {
    if (CPU_ISSET(core, &all)) CPU_SET(core, &one);
  }
  ASSERT_EQ(replay("many", {"--seconds", "0:0.5"}).exit_code, 0);
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);  // foci inherits it
  const int alone = replay("alone", {"--seconds", "0:0.5"}).exit_code;
  ASSERT_EQ(sched_setaffinity(0, sizeof all, &all), 0);
  ASSERT_EQ(alone, 0);
  EXPECT_TRUE(folder.read("many/video.mp4") == folder.read("alone/video.mp4"));
}

TEST_F(Replay, IsTheSameAtAnyNumberOfThreads) {
  std::vector<std::vector<std::vector<std::string>>> tables;
  std::set<std::string> frames, videos, events;
  for (const std::string threads : {"1", "2", "4"}) {
    const Outcome outcome = replay("out" + threads, {"--threads", threads, "--split", "--marker"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    auto table = tableOf(folder.read("out" + threads + "/frames.tsv"));
    for (auto& row : table) row.resize(kRenderMs);
    tables.push_back(table);
    frames.insert(Json::parse(folder.read("out" + threads + "/manifest.json"))["frames_sha256"]);
    videos.insert(folder.read("out" + threads + "/video.mp4"));
    events.insert(folder.read("out" + threads + "/events.tsv"));
  }
  EXPECT_EQ(tables[0], tables[1]);
  EXPECT_EQ(tables[0], tables[2]);
  EXPECT_EQ(frames.size(), 1u);
  EXPECT_EQ(videos.size(), 1u);
  EXPECT_EQ(events.size(), 1u);
}

/// The column pupil_mm of frames.tsv.
std::vector<double> pupilsOf(const std::string& table) {
  std::vector<double> pupils;
  for (const auto& row : tableOf(table)) {
    if (row[0] != "frame") pupils.push_back(std::stod(row[9]));
  }
  return pupils;
}

TEST_F(Replay, TakesThePupilFromTheRecording) {
  std::string trace = "time_s\tx_px\ty_px\tpupil_mm\n";
  for (int i = 0; i < 100; ++i) {
    const char* pupil = i < 20 ? "n/a" : i < 40 ? "3.25" : i < 50 ? "n/a" : "5.5";
    trace += std::to_string(0.01 * i) + "\t320\t240\t" + pupil + "\n";
  }
  folder.write("trace.tsv", trace);
  folder.write("study.toml", smallStudy() + "[observer]\npupil = \"recording\"\npupil_mm = 4.5\n");
  ASSERT_EQ(replay("out").exit_code, 0);
  EXPECT_EQ(pupilsOf(folder.read("out/frames.tsv")),
            (std::vector<double>{4.5, 4.5, 3.25, 3.25, 3.25, 5.5}));
  EXPECT_NE(folder.read("out/report.html").find("as recorded"), std::string::npos);
  // --pupil overrides the recording.
  ASSERT_EQ(replay("fixed", {"--pupil", "6"}).exit_code, 0);
  EXPECT_EQ(pupilsOf(folder.read("fixed/frames.tsv")), std::vector<double>(6, 6.0));
}

TEST_F(Replay, ThePupilFollowsTheLight) {
  std::vector<std::vector<double>> pupils;
  for (const std::string light : {"5", "120", "1000"}) {
    std::string study = smallStudy() + "[observer]\npupil = \"luminance\"\n";
    study.insert(study.find("[gaze]"), "luminance_cd_m2 = " + light + "\n");
    folder.write("study.toml", study);
    std::set<std::string> frames;
    for (const std::string threads : {"1", "3"}) {
      ASSERT_EQ(replay("out", {"--threads", threads}).exit_code, 0);
      frames.insert(Json::parse(folder.read("out/manifest.json"))["frames_sha256"]);
    }
    EXPECT_EQ(frames.size(), 1u);
    pupils.push_back(pupilsOf(folder.read("out/frames.tsv")));
    // The scene is static, so the pupil is constant except for blur at the edge of the image.
    EXPECT_NEAR(pupils.back().front(), pupils.back().back(), 0.1);
  }
  EXPECT_GT(pupils[0][0], pupils[1][0] + 0.5);
  EXPECT_GT(pupils[1][0], pupils[2][0] + 0.5);
  for (const auto& run : pupils) {
    EXPECT_GT(run[0], 2.0);
    EXPECT_LT(run[0], 8.0);
  }
}

TEST_F(Replay, PrintsItsSummaryAsJson) {
  const Outcome outcome = replay("out", {"--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json summary = Json::parse(outcome.out);
  EXPECT_EQ(summary["frames"], 6);
  EXPECT_DOUBLE_EQ(summary["duration_s"], 0.6);
  EXPECT_DOUBLE_EQ(summary["gaze_valid"], 1.0);
  EXPECT_EQ(summary["fixations"], 1);
  EXPECT_EQ(summary["saccades"], 0);
  EXPECT_GE(summary["frames_rendered"], 1);
  EXPECT_LE(summary["frames_rendered"], summary["frames"]);
  EXPECT_GT(summary["rendered_ms_median"], 0.0);
  EXPECT_GE(summary["rendered_ms_p95"], summary["rendered_ms_median"]);
  EXPECT_LE(summary["render_ms_median"], summary["rendered_ms_median"]);
  EXPECT_GE(summary["render_ms_p95"], summary["render_ms_median"]);
  EXPECT_GT(summary["splats"], 0);
  EXPECT_EQ(summary["out"], "out");
}

TEST_F(Replay, NamesItsInputsInTheManifest) {
  ASSERT_EQ(replay("out").exit_code, 0);
  const Json manifest = Json::parse(folder.read("out/manifest.json"));
  ASSERT_EQ(manifest["inputs"].size(), 3u);
  for (const Json& input : manifest["inputs"]) {
    EXPECT_EQ(input["sha256"].get<std::string>().size(), 64u);
  }
  EXPECT_EQ(manifest["configuration"]["output"]["size_px"], Json::parse("[96, 72]"));
  EXPECT_EQ(manifest["configuration"]["observer"]["pupil_mm"], 4.0);  // a default, resolved
  EXPECT_EQ(manifest["configuration"]["eye"]["path"], Json::array());
  EXPECT_EQ(manifest["seed"], 1);
}

TEST_F(Replay, MapsGazeFromTheRecordingsScreenByAngle) {
  // At half the distance, the same point of the screen has twice the tangent.
  std::string trace =
      "# screen_width_px=640 screen_height_px=480 screen_width_m=0.4 screen_height_m=0.3 "
      "viewing_distance_m=0.25\ntime_s\tx_px\ty_px\n";
  for (int i = 0; i < 100; ++i) trace += std::to_string(0.01 * i) + "\t400\t240\n";
  folder.write("trace.tsv", trace);
  ASSERT_EQ(replay("out").exit_code, 0);
  EXPECT_EQ(tableOf(folder.read("out/frames.tsv"))[3][3], "480.00");
}

TEST_F(Replay, WritesASelfContainedReportThatNamesSimulatedInput) {
  std::string study = smallStudy();
  study.replace(study.find("trace.tsv"), 9, "simulated");
  study.replace(study.find("[screen]"), study.find("[gaze]") - study.find("[screen]"), "");
  folder.write("study.toml", study);
  ASSERT_EQ(replay("out").exit_code, 0);
  const std::string report = folder.read("out/report.html");
  EXPECT_NE(report.find("data:video/mp4;base64,"), std::string::npos);
  EXPECT_NE(report.find("data:image/jpeg;base64,"), std::string::npos);
  EXPECT_EQ(report.find("src=\"http"), std::string::npos);
  EXPECT_NE(report.find("gaze is simulated"), std::string::npos);
  EXPECT_NE(report.find("names no screen"), std::string::npos);
}

TEST_F(Replay, EscapesOutsideTextInTheReport) {
  const std::string name = "<img src=x onerror=alert(1)>&\".tsv";
  folder.write(name, steadyTrace());
  ASSERT_EQ(replay("out", {"--trace", name}).exit_code, 0);
  EXPECT_EQ(folder.read("out/report.html").find("<img src=x"), std::string::npos);
}

TEST_F(Replay, OverwritesOnlyItsOwnFiles) {
  fs::create_directory(folder.path() / "out");
  folder.write("out/notes.txt", "mine");
  ASSERT_EQ(replay("out").exit_code, 0);
  ASSERT_EQ(replay("out").exit_code, 0);
  EXPECT_EQ(folder.read("out/notes.txt"), "mine");
  folder.write("out/frames.tsv", "mine");
  EXPECT_EQ(replay("out").exit_code, 2);
  EXPECT_EQ(folder.read("out/frames.tsv"), "mine");
  ASSERT_EQ(replay("out", {"--overwrite"}).exit_code, 0);
  EXPECT_EQ(tableOf(folder.read("out/frames.tsv")).size(), 7u);
  EXPECT_EQ(filesIn(folder.path() / "out").size(), 13u);  // eleven, notes and .foci-outputs
}

TEST_F(Replay, LeavesNothingWhenItCannotWrite) {
  folder.write("out", "a file stands where the folder should");
  const Outcome outcome = replay("out");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_EQ(folder.read("out"), "a file stands where the folder should");
}

TEST_F(Replay, LeavesNothingWhenTerminated) {
  // A closed terminal, and `timeout`, which signals twice at once.
  for (const std::vector<int>& signals :
       {std::vector{SIGTERM}, {SIGINT}, {SIGHUP}, {SIGTERM, SIGTERM}}) {
    const Outcome outcome = terminateFoci(
        {"replay", "study.toml", "--out", "out", "--size", "1280x960", "--seconds", "0:0.9"},
        folder.path(), folder.path() / "out", signals);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_FALSE(fs::exists(folder.path() / "out"));
  }
}

TEST_F(Replay, FollowsAMovingEye) {
  std::string study = smallStudy();
  const std::string still = "position_m = [0, 0, 0]\nlook_at_m = [0, 0, -1]\n";
  study.replace(study.find(still), still.size(),
                "path = [{ time_s = 0, position_m = [0, 0, 0], look_at_m = [0, 0, -1] },\n"
                "{ time_s = 0.5, position_m = [0, 0, 1], look_at_m = [0, 0, -1] }]\n");
  folder.write("study.toml", study);
  ASSERT_EQ(replay("out").exit_code, 0);
  const auto rows = tableOf(folder.read("out/frames.tsv"));
  EXPECT_NEAR(std::stod(rows[1][6]), 1.0, 1e-3);
  EXPECT_NEAR(std::stod(rows[6][6]), 2.0, 2e-3);
}

TEST_F(Replay, RunsWithoutGnuplot) {
  // An empty PATH hides gnuplot. The run succeeds; its report and standard error name the package.
  const Outcome outcome =
      runFoci({"replay", "study.toml", "--out", "out"}, folder.path(), {"PATH="});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("gnuplot-nox"), std::string::npos);
  EXPECT_NE(folder.read("out/report.html").find("gnuplot-nox"), std::string::npos);
}

TEST_F(Replay, RendersImagesInEveryFormat) {
  for (const std::string name : {"a.png", "a.pfm", "a.exr"}) {
    const Outcome outcome =
        runFoci({"render", "study.toml", "--out", name, "--gaze", "320,240", "--depth", "d.pfm"},
                folder.path());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_GT(fs::file_size(folder.path() / name), 200u);
  }
  EXPECT_TRUE(folder.read("a.pfm").starts_with("PF\n96 72\n"));
  EXPECT_TRUE(folder.read("d.pfm").starts_with("Pf\n96 72\n"));
}

TEST_F(Replay, RendersAnImageFocusedOnTheSurfaceUnderTheGaze) {
  const Outcome outcome = runFoci(
      {"render", "study.toml", "--out", "a.png", "--gaze", "320,240", "--json"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json summary = Json::parse(outcome.out);
  EXPECT_NEAR(summary["surface_distance_m"], 1.0, 1e-3);
  EXPECT_NEAR(summary["focus_D"], 1.0, 1e-3);
  const Json infinity = Json::parse(
      runFoci({"render", "study.toml", "--out", "a.png", "--focus", "inf", "--json"}, folder.path())
          .out);
  EXPECT_EQ(infinity["focus_D"], 0.0);
}

TEST(RealRecordings, AreReplayed) {
  const auto data = dataFolder();
  if (!data) GTEST_SKIP() << "no shared/data (set FOCI_DATA)";
  std::vector<fs::path> traces;
  for (const fs::path& folder : {*data / "gaze/labelled/andersson2017", *data / "gaze/vendors"}) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string name = entry.path().filename();
      if (name.starts_with("img_") || name.starts_with("video_") || name.ends_with(".asc")) {
        traces.push_back(fs::absolute(entry.path()));
      }
    }
  }
  ASSERT_GE(traces.size(), 16u);
  const TemporaryFolder folder;
  folder.write("study.toml", smallStudy());
  folder.write("scene.ply", squarePly(24, 1.0));
  for (const fs::path& trace : traces) {
    const std::string out = trace.stem();
    const Outcome outcome =
        runFoci({"replay", "study.toml", "--trace", trace, "--out", out, "--json"}, folder.path());
    ASSERT_EQ(outcome.exit_code, 0) << trace << ": " << outcome.err;
    EXPECT_GE(Json::parse(outcome.out)["frames"], 4) << trace;  // the shortest lasts 0.4 s
    std::size_t seen = 0;
    for (const auto& row : tableOf(folder.read(out + "/frames.tsv"))) seen += row[3] != "n/a";
    EXPECT_GT(seen, 1u) << trace;  // besides the header
  }
}

TEST(RealScan, IsReplayedUnderARealRecording) {
  const auto data = dataFolder();
  if (!data) GTEST_SKIP() << "no shared/data (set FOCI_DATA)";
  const TemporaryFolder folder;
  const Outcome outcome =
      runFoci({"replay", (fs::path(FOCI_SOURCE_DIR) / "configs/lion.toml").string(), "--scene",
               fs::absolute(*data / "scans/lion.ply").string(), "--trace",
               fs::absolute(*data / "gaze/labelled/andersson2017/img_UH21_img_Rome.tsv").string(),
               "--size", "192x108", "--seconds", "0:0.2", "--out", "out"},
              folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto last = tableOf(folder.read("out/frames.tsv")).back();
  EXPECT_GT(std::stod(last[6]), 3.0);  // the lion sits 4 to 6 m away
  EXPECT_LT(std::stod(last[6]), 7.0);
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
