// Recordings that need a description, or are cut off, as users meet them.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Fixations of half a second, at 100 Hz. @param header  with its line end, or ""
std::string table(const std::string& header, int first_number = 0) {
  std::string text = header;
  for (int i = 0; i < 200; ++i) {
    text += std::to_string(first_number + i) + "," + std::to_string(100 + 90 * (i / 50)) + "." +
            std::to_string(i % 7) + "," + std::to_string(200 + 40 * (i / 50)) + ".5\n";
  }
  return text;
}

const std::vector<std::string> kScreen = {"--screen-px", "640x480",      "--screen-m",
                                          "0.4x0.3",     "--distance-m", "0.6"};

std::vector<std::string> with(std::vector<std::string> arguments,
                              const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(Recordings, EventsTakeTheDescriptionThatTraceInfoTakes) {
  TemporaryFolder folder;
  folder.write("plain.csv", table(""));
  folder.write("study.toml",
               "[screen]\nsize_px = [640, 480]\nsize_m = [0.4, 0.3]\ndistance_m = 0.6\n"
               "[gaze]\ntime = \"#1\"\nx = \"#2\"\ny = \"#3\"\ntime_scale_s = 0.01\n");
  const auto foci = [&](const std::vector<std::string>& arguments) {
    return runFoci(arguments, folder.path());
  };
  const Outcome refused = foci(with({"events", "plain.csv"}, kScreen));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_TRUE(has(refused.err, "gaze.time = \"#1\"") && has(refused.err, "--study")) << refused.err;

  const std::vector<std::string> columns = {"--time",         "#1",  "--x", "#2", "--y", "#3",
                                            "--time-scale-s", "0.01"};
  const Outcome named = foci(with(with({"events", "plain.csv"}, kScreen), columns));
  EXPECT_EQ(named.exit_code, 0) << named.err;
  EXPECT_TRUE(has(named.err, "assumed: unit of the positions: px (gaze.units)")) << named.err;
  const Outcome studied = foci({"events", "plain.csv", "--study", "study.toml"});
  EXPECT_EQ(studied.exit_code, 0) << studied.err;
  EXPECT_EQ(studied.out, named.out);

  const Outcome info = foci({"trace", "info", "plain.csv", "--study", "study.toml", "--json"});
  const auto facts = nlohmann::json::parse(info.out);
  EXPECT_EQ(facts["screen_px"], nlohmann::json({640, 480})) << "the study's screen";
  EXPECT_EQ(facts["distance_m"], 0.6);
}

TEST(Recordings, EventsOfAStudyAreThoseOfItsReplay) {
  TemporaryFolder folder;
  std::string trace = "time_s\tx_px\ty_px\n";  // lost for 0.2 s, and a saccade of 7 degrees
  for (int i = 0; i < 300; ++i) {
    const std::string point = i >= 50 && i < 70 ? "n/a\tn/a" : i < 200 ? "300\t240" : "400\t240";
    trace +=
        std::to_string(0.01 * i) + "\t" + point + (i % 2 == 0 && point[0] != 'n' ? ".1\n" : "\n");
  }
  folder.write("trace.tsv", trace);
  folder.write("scene.ply", squarePly(8, 1.0));
  std::string study = smallStudy();
  study.replace(study.find("0.6]"), 4, "3]");
  const auto eventsAre = [&](const std::string& keys) {
    std::string keyed = study;
    folder.write("study.toml", keyed.insert(keyed.find("[output]"), keys));
    EXPECT_EQ(runFoci({"replay", "study.toml", "--out", "out"}, folder.path()).exit_code, 0);
    const Outcome events = runFoci(
        {"events", "trace.tsv", "--study", "study.toml", "--out", "events.tsv"}, folder.path());
    EXPECT_EQ(events.exit_code, 0) << events.err;
    EXPECT_EQ(folder.read("events.tsv"), folder.read("out/events.tsv")) << keys;
    return folder.read("events.tsv");
  };
  const std::string usual = eventsAre("");
  EXPECT_NE(eventsAre("max_gap_s = 0.5\n"), usual);
  const std::string rules = "detector = \"rules\"\n";
  EXPECT_NE(eventsAre(rules + "saccade_deg_s = 1000\n"), eventsAre(rules));
}

TEST(Recordings, ARecordingInTheStudysPlaceIsNamed) {
  TemporaryFolder folder;
  folder.write("gaze.csv", table("time_s,x_px,y_px\n"));
  for (const std::string command : {"replay", "render", "live"}) {
    const Outcome refused = command == "live"
                                ? runFoci({command, "gaze.csv"}, folder.path())
                                : runFoci({command, "gaze.csv", "--out", "out.png"}, folder.path());
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_TRUE(has(refused.err, "gaze.csv: is not a study") && has(refused.err, "--trace"))
        << refused.err;
  }
}

TEST(Recordings, AHintToAStudyComesOnlyWithoutOne) {
  TemporaryFolder folder;
  folder.write("gaze.csv", table("frame,x_px,y_px\n"));
  folder.write("study.toml", "[gaze]\nx = \"x_px\"\n");
  const Outcome without = runFoci({"trace", "info", "gaze.csv"}, folder.path());
  EXPECT_TRUE(has(without.err, "gaze.time") && has(without.err, "--study")) << without.err;
  const Outcome with =
      runFoci({"trace", "info", "gaze.csv", "--study", "study.toml"}, folder.path());
  EXPECT_TRUE(has(with.err, "gaze.time") && !has(with.err, "--study")) << with.err;
}

TEST(Recordings, AScoreSaysWhatItAssumed) {
  TemporaryFolder folder;
  std::string text = "time;x;y;coder_A\n";
  for (int i = 0; i < 200; ++i) {
    text += std::to_string(10 * i) + ";" + std::to_string(100 + i % 7) + ";200;fixation\n";
  }
  folder.write("coded.csv", text);
  const Outcome score = runFoci(with({"events", "coded.csv", "--score"}, kScreen), folder.path());
  EXPECT_EQ(score.exit_code, 0) << score.err;
  EXPECT_TRUE(has(score.err, "assumed: unit of the positions: px (gaze.units)")) << score.err;
}

TEST(Recordings, ARateBesideATimeColumnIsRefused) {
  TemporaryFolder folder;
  folder.write("frames.csv", table("frame,x_px,y_px\n"));
  folder.write("study.toml", "[gaze]\ntime = \"frame\"\nrate_Hz = 120\n");
  folder.write("rate.toml", "[gaze]\nrate_Hz = 120\n");
  for (const std::vector<std::string>& options : std::vector<std::vector<std::string>>{
           {"--study", "study.toml"}, {"--study", "rate.toml", "--time", "frame"}}) {
    const Outcome outcome = runFoci(with({"trace", "info", "frames.csv"}, options), folder.path());
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_TRUE(has(outcome.err, "gaze.rate_Hz and gaze.time")) << outcome.err;
  }
  const Outcome rate =
      runFoci({"trace", "info", "frames.csv", "--study", "rate.toml"}, folder.path());
  EXPECT_TRUE(has(rate.out, "rate_Hz         120.0")) << rate.out;
}

TEST(Recordings, WhatIsAssumedIsPrintedAndRecorded) {
  TemporaryFolder folder;
  const std::string assumed = "unit of the positions: px (gaze.units)";
  folder.write("study.toml", smallStudy());
  folder.write("scene.ply", squarePly(8, 1.0));
  std::string trace = steadyTrace();
  trace.replace(0, trace.find('\n'), "time\tx\ty");
  folder.write("trace.tsv", trace);
  const Outcome replay = runFoci({"replay", "study.toml", "--out", "out"}, folder.path());
  ASSERT_EQ(replay.exit_code, 0) << replay.err;
  EXPECT_TRUE(has(replay.err, "trace.tsv: assumed: " + assumed)) << replay.err;
  const auto manifest = nlohmann::json::parse(folder.read("out/manifest.json"));
  EXPECT_EQ(manifest["gaze"]["assumed"][0], assumed);
  EXPECT_TRUE(has(folder.read("out/report.html"), assumed));

  ASSERT_EQ(runFoci({"trace", "convert", "trace.tsv", "--out", "a_physio.tsv.gz"}, folder.path())
                .exit_code,
            0);
  const auto sidecar = nlohmann::json::parse(folder.read("a_recording-eye1_physio.json"));
  EXPECT_EQ(sidecar["FociAssumed"][0], assumed);
  EXPECT_FALSE(sidecar.contains("Manufacturer")) << "foci does not know it";
}

TEST(Recordings, AnEyeNavGsFileThatIsCutOffIsSaid) {
  TemporaryFolder folder;
  std::string text =
      "ViewIndex,FOV1,FOV2,FOV3,FOV4,PositionX,PositionY,PositionZ,QuaternionX,QuaternionY,"
      "QuaternionZ,QuaternionW,GazePosX,GazePosY,GazePosZ,GazeQX,GazeQY,GazeQZ,GazeQW,Timestamp\n";
  for (int i = 0; i < 20; ++i) {
    for (int side : {0, 1}) {
      text += std::to_string(side) + ",-0.8,0.8,-0.8,0.8,0,1.6,0,0,0,0,1,0,1.6,0,0,0.01,0,1," +
              std::to_string(20 * i) + "\n";
    }
  }
  folder.write("whole.csv", text);
  folder.write("cut.csv", text + "0,-0.8,0.8,-0.8");
  folder.write("short.csv", text + "0,-0.8,0.8,-0.8\n1,-0.8\n");
  const auto said = [&](const char* file) {
    const Outcome outcome = runFoci({"trace", "info", file}, folder.path());
    return outcome.out + outcome.err;
  };
  EXPECT_FALSE(has(said("whole.csv"), "cut off")) << said("whole.csv");
  EXPECT_TRUE(has(said("cut.csv"), "the last line is cut off")) << said("cut.csv");
  EXPECT_TRUE(has(said("short.csv"), "short.csv:42: 4 fields: expected 20")) << said("short.csv");
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
