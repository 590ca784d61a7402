// `foci calibrate` without windows: what comes out, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

using Json = nlohmann::json;

/// 9 targets, `samples` each, from a tracker that scales, turns and moves; the last sample of each
/// is lost.
std::string pairsFile(int samples, double noise_deg) {
  std::string text = "x\ty\tx_target\ty_target\ttime_s\n";
  double phase = 0.0;
  for (int target = 0; target < 9; ++target) {
    const double x = 8.0 * (target % 3 - 1), y = 5.0 * (target / 3 - 1);
    for (int i = 0; i < samples; ++i) {
      phase += 2.4;  // no two samples alike, and no random numbers
      char line[160];
      std::snprintf(line, sizeof line, "%.6f\t%.6f\t%g\t%g\t%.3f\n",
                    1.1 * x - 0.05 * y + 2.0 + noise_deg * std::sin(phase),
                    0.04 * x + 0.9 * y - 1.0 + noise_deg * std::cos(1.7 * phase), x, y,
                    0.01 * (target * samples + i));
      text += line;
    }
    text += "n/a\tn/a\t" + std::to_string(x) + "\t" + std::to_string(y) + "\t0\n";
  }
  return text;
}

Outcome refusedWithoutATrace(const std::vector<std::string>& arguments,
                             const TemporaryFolder& folder) {
  const Outcome outcome = runFoci(arguments, folder.path());
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "made.toml"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "made.html"));
  return outcome;
}

TEST(CalibrateGaze, PrintsTheSummaryAndKeepsMapAndReport) {
  const TemporaryFolder folder;
  folder.write("fit.tsv", pairsFile(50, 0.2));
  folder.write("other.tsv", pairsFile(20, 0.1));
  const Outcome outcome = runFoci({"calibrate", "gaze", "--pairs", "fit.tsv", "--validate",
                                   "other.tsv", "--out", "map.toml", "--json"},
                                  folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json summary = Json::parse(outcome.out);
  EXPECT_EQ(summary["model"], "affine");
  EXPECT_EQ(summary["samples"], 9 * 21);
  EXPECT_NEAR(summary["lost"].get<double>(), 1.0 / 21.0, 1e-12);
  EXPECT_EQ(summary["grade"], "good");
  EXPECT_LT(summary["accuracy_deg"], 0.15);
  EXPECT_GE(summary["accuracy_max_deg"], summary["accuracy_deg"]);
  for (const char* key : {"precision_rms_s2s_deg", "precision_sd_deg"}) {
    EXPECT_GT(summary[key], 0.0) << key;
    EXPECT_LT(summary[key], 0.3) << key;
  }
  EXPECT_NE(folder.read("map.toml").find("model = \"affine\""), std::string::npos);
  EXPECT_NE(folder.read("map.html").find("<svg"), std::string::npos);
}

TEST(CalibrateGaze, WorksInEveryUnit) {
  const TemporaryFolder folder;
  folder.write("fit.tsv", pairsFile(10, 0.01));
  std::string plane = "x y x_target y_target\n";
  for (int i = 0; i < 9; ++i) {
    const double x = 0.15 * (i % 3 - 1), y = 0.1 * (i / 3 - 1);
    plane += std::to_string(1.2 * x + 0.03) + " " + std::to_string(0.8 * y) + " " +
             std::to_string(x) + " " + std::to_string(y) + "\n";
  }
  folder.write("plane.txt", plane);
  for (const std::string units : {"direction", "norm"}) {
    const Outcome outcome = runFoci(
        {"calibrate", "gaze", "--pairs", "plane.txt", "--units", units, "--json"}, folder.path());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const Json summary = Json::parse(outcome.out);
    EXPECT_LT(summary["accuracy_deg"], 0.05) << units;
    EXPECT_TRUE(summary["precision_rms_s2s_deg"].is_null());  // one sample a target
  }
}

TEST(CalibrateGaze, DriftMovesTheMap) {
  const TemporaryFolder folder;
  folder.write("fit.tsv", pairsFile(20, 0.1));
  ASSERT_EQ(runFoci({"calibrate", "gaze", "--pairs", "fit.tsv", "--out", "map.toml"}, folder.path())
                .exit_code,
            0);
  // At the middle the tracker of `pairsFile` says 2, -1; now it says 1.1 to the right of it.
  std::string one = "x y x_target y_target\n";
  for (int i = 0; i < 10; ++i) one += "3.1 -1 0 0\n";
  folder.write("one.txt", one);
  const Outcome outcome = runFoci({"calibrate", "gaze", "--drift", "map.toml", "--pairs", "one.txt",
                                   "--out", "moved.toml", "--json"},
                                  folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NEAR(Json::parse(outcome.out)["drift_deg"].get<double>(), 1.0, 0.1);
  const Outcome two = refusedWithoutATrace(
      {"calibrate", "gaze", "--drift", "map.toml", "--pairs", "fit.tsv", "--out", "made.toml"},
      folder);
  EXPECT_NE(two.err.find("more than one target"), std::string::npos);
  const Outcome units = refusedWithoutATrace({"calibrate", "gaze", "--drift", "map.toml", "--pairs",
                                              "one.txt", "--units", "norm", "--out", "made.toml"},
                                             folder);
  EXPECT_NE(units.err.find("--drift excludes --units"), std::string::npos) << units.err;
}

TEST(CalibrateGaze, RefusesSmallTargetsOfNoStatedUnitAndTheFitsOwnSamples) {
  const TemporaryFolder folder;
  std::string norm = "x y x_target y_target\n";
  for (int i = 0; i < 9; ++i) {
    const std::string target =
        std::to_string(0.1 + 0.4 * (i % 3)) + " " + std::to_string(0.1 + 0.4 * (i / 3));
    norm += target + " " + target + "\n";
  }
  folder.write("norm.txt", norm);
  folder.write("fit.tsv", pairsFile(20, 0.1));
  const std::vector<std::string> gaze{"calibrate", "gaze", "--out", "made.toml", "--pairs"};
  const auto with = [&](std::vector<std::string> options) {
    options.insert(options.begin(), gaze.begin(), gaze.end());
    return options;
  };
  EXPECT_NE(refusedWithoutATrace(with({"norm.txt"}), folder).err.find("--units"),
            std::string::npos);
  // Data loss at other moments makes no other samples, and alone it is none.
  folder.write("copy.tsv", pairsFile(20, 0.1) + "n/a\tn/a\t0\t0\t99\n");
  folder.write("lost.tsv", "x\ty\tx_target\ty_target\ttime_s\nn/a\tn/a\t0.000000\t0.000000\t0\n");
  for (const std::string file : {"fit.tsv", "copy.tsv"}) {
    const Outcome own = refusedWithoutATrace(with({"fit.tsv", "--validate", file}), folder);
    EXPECT_NE(own.err.find("--validate " + file), std::string::npos) << own.err;
  }
  EXPECT_EQ(runFoci(with({"fit.tsv", "--validate", "lost.tsv"}), folder.path())
                .err.find("the samples of the fit"),
            std::string::npos);
  EXPECT_EQ(runFoci(with({"norm.txt", "--units", "deg", "--overwrite"}), folder.path()).exit_code,
            0);
}

TEST(CalibrateGaze, RefusesInOneLine) {
  const TemporaryFolder folder;
  folder.write("good.tsv", pairsFile(5, 0.1));
  folder.write("line.tsv", "x y x_target y_target\n0 0 0 0\n1 1 1 1\n2 2 2 2\n3 3 3 3\n");
  folder.write("two.tsv", "x y x_target y_target\n0 0 0 0\n2 2 2 2\n0 0 0 0\n2 2 2 2\n");
  folder.write("broken.tsv", "x y x_target y_target\n0 0 0 zero\n");
  const auto says = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"calibrate", "gaze", "--out", "made.toml"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return refusedWithoutATrace(arguments, folder).err;
  };
  EXPECT_NE(says({"--pairs", "line.tsv"}).find("collinear"), std::string::npos);
  EXPECT_NE(says({"--pairs", "two.tsv"}).find("too few targets"), std::string::npos);
  EXPECT_NE(says({"--pairs", "broken.tsv"}).find("broken.tsv:2"), std::string::npos);
  EXPECT_NE(says({"--pairs", "absent.tsv"}).find("cannot be read"), std::string::npos);
  EXPECT_NE(says({"--pairs", "good.tsv", "--validate", "broken.tsv"}).find("broken.tsv:2"),
            std::string::npos);
  EXPECT_NE(says({"--pairs", "good.tsv", "--units", "px"}).find("--units"), std::string::npos);
  EXPECT_NE(says({"--pairs", "good.tsv", "--screen", "good.tsv"}).find("good.tsv"),
            std::string::npos);
  EXPECT_NE(says({"--pairs", ""}).find("--pairs"), std::string::npos);
}

TEST(CalibrationInUse, ReplayTakesScreenAndMapAndNamesThem) {
  const TemporaryFolder folder;
  folder.write("study.toml", smallStudy());
  folder.write("scene.ply", squarePly(8, 1.0));
  folder.write("trace.tsv", steadyTrace());
  // The tracker says 2 deg too far left.
  std::string pairs = "x y x_target y_target\n";
  for (int i = 0; i < 9; ++i) {
    const int x = 8 * (i % 3 - 1), y = 5 * (i / 3 - 1);
    pairs += std::to_string(x - 2) + " " + std::to_string(y) + " " + std::to_string(x) + " " +
             std::to_string(y) + "\n";
  }
  folder.write("pairs.txt", pairs);
  ASSERT_EQ(
      runFoci({"calibrate", "gaze", "--pairs", "pairs.txt", "--out", "map.toml"}, folder.path())
          .exit_code,
      0);
  ASSERT_EQ(runFoci({"calibrate", "screen", "--headless", "--size-px", "640x480", "--size-m",
                     "0.32x0.24", "--distance-m", "0.7", "--out", "screen.toml"},
                    folder.path())
                .exit_code,
            0);
  const Outcome outcome = runFoci({"replay", "study.toml", "--screen", "screen.toml", "--gaze-map",
                                   "map.toml", "--out", "out", "--json"},
                                  folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json manifest = Json::parse(folder.read("out/manifest.json"));
  EXPECT_FALSE(manifest["screen_is_default"].get<bool>());
  const std::string inputs = manifest["inputs"].dump();
  EXPECT_NE(inputs.find("screen.toml"), std::string::npos) << inputs;
  EXPECT_NE(inputs.find("map.toml"), std::string::npos) << inputs;
  const auto table = tableOf(folder.read("out/frames.tsv"));
  const auto column = static_cast<std::size_t>(
      std::find(table[0].begin(), table[0].end(), "gaze_x_px") - table[0].begin());
  // 2000 px/m at 0.7 m; the recording holds the middle.
  EXPECT_NEAR(std::stod(table[2][column]), 320.0 + 2000.0 * 0.7 * std::tan(2.0 * M_PI / 180.0),
              1.5);

  const Outcome simulated = runFoci(
      {"render", "study.toml", "--gaze-map", "absent.toml", "--out", "made.png"}, folder.path());
  EXPECT_EQ(simulated.exit_code, 2);
  EXPECT_NE(simulated.err.find("absent.toml"), std::string::npos) << simulated.err;
}

/// Columns of both eyes at (x, y, z) mm +- 31 that look at a point of the display, seen by a
/// tracker 150 mm below the display's centre.
std::string eyesAt(double x, double y, double z, double target_x, double target_y) {
  std::string text;
  for (const double side : {-31.0, 31.0}) {
    char columns[200];
    std::snprintf(columns, sizeof columns, "%.6f\t%.6f\t%.6f\t%.6f\t%.6f\t%.6f\t", x + side,
                  y + 150.0, z, target_x - x - side, target_y - y, -z);
    text += columns;
  }
  return text;
}

TEST(CalibrateBinocular, FindsTheDisplayAndLeadsReplayToTheTarget) {
  const TemporaryFolder folder;
  std::string header;
  for (const std::string eye : {"left_", "right_"}) {
    for (const std::string column : {"origin_x_mm", "origin_y_mm", "origin_z_mm", "direction_x",
                                     "direction_y", "direction_z"}) {
      header += eye + column + "\t";
    }
  }
  std::string pairs = header + "x_target_mm\ty_target_mm\n";
  for (int i = 0; i < 90; ++i) {
    const double x = 150.0 * (i % 3 - 1), y = 80.0 * (i / 3 % 3 - 1);
    pairs += eyesAt(20.0 * (i % 7) - 60.0, 15.0 * (i % 5) - 30.0, 500.0 + 10.0 * (i % 11), x, y) +
             std::to_string(x) + "\t" + std::to_string(y) + "\n";
  }
  folder.write("pairs.tsv", pairs);
  const Outcome outcome =
      runFoci({"calibrate", "binocular", "--pairs", "pairs.tsv", "--out", "both.toml", "--json"},
              folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json summary = Json::parse(outcome.out);
  EXPECT_LT(summary["accuracy_deg"].get<double>(), 0.01);
  EXPECT_NEAR(summary["position_mm"][1].get<double>(), 150.0, 0.1);
  const Outcome own = refusedWithoutATrace({"calibrate", "binocular", "--pairs", "pairs.tsv",
                                            "--validate", "pairs.tsv", "--out", "made.toml"},
                                           folder);
  EXPECT_NE(own.err.find("the samples of the fit"), std::string::npos) << own.err;

  // 80 mm to the right and 60 mm up on a display of 400 x 300 mm.
  std::string trace = "time_s\t" + header + "note\n";
  for (int i = 0; i < 100; ++i) {
    trace += std::to_string(0.01 * i) + "\t" + eyesAt(0.1 * i, 0.0, 500.0, 80.0, 60.0) + "-\n";
  }
  folder.write("trace.tsv", trace);
  folder.write("scene.ply", squarePly(8, 1.0));
  folder.write("study.toml", smallStudy());
  const Outcome replayed =
      runFoci({"replay", "study.toml", "--gaze-map", "both.toml", "--out", "out"}, folder.path());
  ASSERT_EQ(replayed.exit_code, 0) << replayed.err;
  const auto row = tableOf(folder.read("out/frames.tsv")).back();
  EXPECT_NEAR(std::stod(row[3]), 320.0 + 80.0 * 1.6, 0.1);
  EXPECT_NEAR(std::stod(row[4]), 240.0 - 60.0 * 1.6, 0.1);
}

TEST(CalibrateBinocular, RefusesInOneLine) {
  const TemporaryFolder folder;
  std::string still =
      "left_origin_x_mm\tleft_origin_y_mm\tleft_origin_z_mm\tleft_direction_x\t"
      "left_direction_y\tleft_direction_z\tx_target_mm\ty_target_mm\n";
  folder.write("few.tsv", still + "0\t0\t600\t0\t0\t-1\t0\t0\n");
  for (int i = 0; i < 90; ++i) {
    const double x = 150.0 * (i % 3 - 1), y = 80.0 * (i / 3 % 3 - 1);
    char row[160];
    std::snprintf(row, sizeof row, "0\t0\t600\t%g\t%g\t-600\t%g\t%g\n", x, y, x, y);
    still += row;
  }
  folder.write("still.tsv", still);
  folder.write("other.tsv", "x\ty\n1\t2\n");
  for (const char* file : {"few.tsv", "still.tsv", "other.tsv", "absent.tsv"}) {
    const Outcome outcome = refusedWithoutATrace(
        {"calibrate", "binocular", "--pairs", file, "--out", "made.toml"}, folder);
    EXPECT_NE(outcome.err.find(file), std::string::npos) << outcome.err;
  }
}

TEST(CalibrateScreen, HeadlessFromCardAndBlindSpot) {
  const TemporaryFolder folder;
  const double px_per_m = 4000.0, distance_m = 0.62;
  const double spot_px = px_per_m * distance_m * std::tan(13.5 * M_PI / 180.0);
  std::string runs;
  for (double off : {1.01, -0.99, 1.02, -0.98, 1.6, -1.0}) {
    runs += (runs.empty() ? "" : ",") + std::to_string(off * spot_px);
  }
  const Outcome outcome = runFoci(
      {"calibrate", "screen", "--headless", "--size-px", "1920x1080", "--card-px", "342.4x215.92",
       "--blind-spot-px=" + runs, "--out", "screen.toml", "--psychopy", "screen.json", "--json"},
      folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json summary = Json::parse(outcome.out);
  EXPECT_NEAR(summary["size_m"][0].get<double>(), 0.48, 1e-9);
  EXPECT_NEAR(summary["size_m"][1].get<double>(), 0.27, 1e-9);
  EXPECT_NEAR(summary["distance_m"].get<double>(), distance_m, 0.01 * distance_m);
  for (const std::string file : {"screen.toml", "screen.json"}) {
    const Outcome again =
        runFoci({"calibrate", "screen", "--headless", "--monitor", file, "--json"}, folder.path());
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_NEAR(Json::parse(again.out)["distance_m"].get<double>(), summary["distance_m"], 1e-12);
  }
}

TEST(CalibrateScreen, DoubtsOblongPixels) {
  const TemporaryFolder folder;
  const auto warningOf = [&](const std::string& size_px) {
    return runFoci({"calibrate", "screen", "--headless", "--size-px", size_px, "--size-m",
                    "0.531x0.299", "--distance-m", "0.6"},
                   folder.path())
        .err;
  };
  EXPECT_EQ(warningOf("1920x1080"), "");
  const std::string oblong = warningOf("1080x1920");
  EXPECT_NE(oblong.find("times as wide as high"), std::string::npos) << oblong;
  EXPECT_EQ(oblong.find("screen.size"), std::string::npos) << "a key, not an option: " << oblong;
}

TEST(RenderedScreen, DoubtsOblongPixels) {
  const TemporaryFolder folder;
  folder.write("study.toml", smallStudy());
  folder.write("scene.ply", squarePly(8, 1.0));
  folder.write("trace.tsv", steadyTrace());
  const auto warns = [&](const std::string& size_m, const std::vector<std::string>& options) {
    std::vector<std::string> words{options[0], "study.toml", "--set", "screen.size_m=" + size_m};
    words.insert(words.end(), options.begin() + 1, options.end());
    return runFoci(words, folder.path()).err.find("times as wide as high") != std::string::npos;
  };
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"render", "--out", "a.png"},
        {"replay", "--set", "gaze.source=simulated", "--seconds", "0:0.1", "--out", "run"}}) {
    EXPECT_FALSE(warns("[0.4, 0.3]", options)) << options[0];
    EXPECT_TRUE(warns("[0.3, 0.4]", options)) << options[0];
  }
}

TEST(CalibrateScreen, RefusesInOneLine) {
  const TemporaryFolder folder;
  const auto says = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"calibrate", "screen", "--headless", "--out", "made.toml"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return refusedWithoutATrace(arguments, folder).err;
  };
  EXPECT_NE(says({}).find("--size-px"), std::string::npos);
  EXPECT_NE(says({"--size-px", "1920"}).find("--size-px"), std::string::npos);
  EXPECT_NE(says({"--size-px", "1920x1080"}).find("--card-px"), std::string::npos);
  EXPECT_NE(says({"--size-px", "1920x1080", "--card-px", "300"}).find("--distance-m"),
            std::string::npos);
  EXPECT_NE(says({"--size-px", "1920x1080", "--card-px", "300x300", "--distance-m", "0.6"})
                .find("bank card"),
            std::string::npos);
  EXPECT_NE(says({"--size-px", "1920x1080", "--card-px", "300", "--distance-m", "60"})
                .find("--distance-m"),
            std::string::npos);
  EXPECT_NE(says({"--size-px", "1920x1080", "--card-px", "300", "--blind-spot-px", "500,510"})
                .find("blind spot"),
            std::string::npos);
  EXPECT_NE(
      says({"--size-px", "1920x1080", "--card-px", "300", "--distance-m", "1", "--gamma", "9"})
          .find("--gamma"),
      std::string::npos);
}

TEST(CalibrateCamera, RefusesInOneLine) {
  const TemporaryFolder folder;
  folder.write("text.png", "not an image");
  const auto says = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"calibrate", "camera", "--out", "made.toml"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return refusedWithoutATrace(arguments, folder).err;
  };
  EXPECT_NE(says({}).find("--images"), std::string::npos);
  EXPECT_NE(says({"--images", "text.png"}).find("text.png"), std::string::npos);
  EXPECT_NE(says({"--video", "text.png"}).find("text.png"), std::string::npos);
  EXPECT_NE(says({"--images", "text.png", "--board", "2x2"}).find("--board"), std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
