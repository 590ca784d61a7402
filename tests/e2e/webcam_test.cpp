// The whole way of a webcam: a filmed observer looks at targets; calibrate, validate, run.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "calibration/webcam/webcam_calibration.h"
#include "tests/e2e/binary.h"
#include "tests/faces/film.h"
#include "tests/faces/hard_faces.h"
#include "tests/faces/observer.h"

namespace foci::e2e {
namespace FOCI_FILE {

using Json = nlohmann::json;

constexpr double kRate_Hz = 10.0, kShown_s = 0.8;
const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.52, 0.2925}, .distance_m = 0.55};
constexpr std::size_t kFitTargets = 9, kTargets = 13;

/// Nine targets to calibrate on, from the centre in leaps; then, after a break, four others to
/// validate on; m from the screen's centre.
std::vector<faces::ShownTarget> targets(double shown_s, double break_s = 0.0) {
  std::vector<faces::ShownTarget> shown;
  for (std::size_t i = 0; i < kTargets; ++i) {
    const int place = static_cast<int>(5 * i + 4) % 9, other = static_cast<int>(i - kFitTargets);
    const bool fit = i < kFitTargets;
    const double from_s = shown_s * static_cast<double>(i) + (fit ? 0.0 : break_s);
    shown.push_back({from_s, from_s + shown_s,
                     fit ? glm::dvec2(0.23 * (place % 3 - 1), 0.12 * (1 - place / 3))
                         : glm::dvec2(other % 2 == 0 ? -0.12 : 0.12, other < 2 ? 0.06 : -0.06)});
  }
  return shown;
}

glm::dvec2 direction_deg(const glm::dvec2& point_m) {
  return glm::degrees(glm::atan(point_m / kScreen.distance_m));
}

std::string targetTable(std::span<const faces::ShownTarget> shown) {
  std::string text = "onset_s\tduration_s\tx_target\ty_target\n";
  for (const faces::ShownTarget& target : shown) {
    const glm::dvec2 deg = direction_deg(target.point_m);
    text += std::to_string(target.from_s) + "\t" + std::to_string(target.to_s - target.from_s) +
            "\t" + std::to_string(deg.x) + "\t" + std::to_string(deg.y) + "\n";
  }
  return text;
}

/// `foci calibrate gaze` on the film eyes.mp4 of these targets, to map.toml: its summary.
Json calibrate(const TemporaryFolder& folder, std::span<const faces::ShownTarget> shown,
               const std::vector<std::string>& environment) {
  folder.write("fit.tsv", targetTable(shown.first(kFitTargets)));
  folder.write("other.tsv", targetTable(shown.subspan(kFitTargets)));
  EXPECT_EQ(runFoci({"calibrate", "screen", "--headless", "--size-px", "1920x1080", "--size-m",
                     "0.52x0.2925", "--distance-m", "0.55", "--out", "screen.toml"},
                    folder.path(), environment)
                .exit_code,
            0);
  const Outcome calibrated =
      runFoci({"calibrate", "gaze", "--source", "webcam:eyes.mp4", "--pairs", "fit.tsv",
               "--validate", "other.tsv", "--screen", "screen.toml", "--out", "map.toml", "--json"},
              folder.path(), environment);
  EXPECT_EQ(calibrated.exit_code, 0) << calibrated.err;
  return Json::parse(calibrated.out);
}

/// @param environment  chooses the tracker: without its models networks are not used
void followTheGaze(const std::vector<std::string>& environment) {
  const TemporaryFolder folder;
  const auto shown = targets(kShown_s);
  const faces::Observer observer({.seed = 5}, shown);
  faces::film(folder.path() / "eyes.mp4", faces::Face(faces::somebody(0)), kRate_Hz,
              shown.back().to_s, {}, [&](double time_s) { return observer.at(time_s); });
  const Json summary = calibrate(folder, shown, environment);
  EXPECT_EQ(summary["model"], "webcam");
  EXPECT_TRUE(summary["validated"].get<bool>());
  EXPECT_LE(summary["accuracy_deg"].get<double>(), 1.5);
  EXPECT_LE(summary["lost"].get<double>(), 0.3);  // blinks

  // Run, in another process, on the same film: gaze comes from the map and the kept reference.
  folder.write("scene.ply", squarePly(8, 1.0));
  folder.write("study.toml", smallStudy());
  const Outcome replayed = runFoci(
      {"replay", "study.toml", "--trace", "webcam:eyes.mp4", "--gaze-map", "map.toml", "--screen",
       "screen.toml", "--size", "64x36", "--seconds", "0:10", "--out", "out", "--json"},
      folder.path(), environment);
  ASSERT_EQ(replayed.exit_code, 0) << replayed.err;
  const std::string inputs = Json::parse(folder.read("out/manifest.json"))["inputs"].dump();
  EXPECT_NE(inputs.find("eyes.mp4"), std::string::npos) << inputs;
  EXPECT_NE(inputs.find("map.toml"), std::string::npos) << inputs;
  const auto table = tableOf(folder.read("out/frames.tsv"));
  const auto column = [&](const char* name) {
    return static_cast<std::size_t>(std::find(table[0].begin(), table[0].end(), name) -
                                    table[0].begin());
  };
  double sum_deg = 0.0, count = 0.0;
  for (std::size_t row = 1; row < table.size(); ++row) {
    const double time_s = std::stod(table[row][column("time_s")]);
    const auto at = static_cast<std::size_t>(time_s / kShown_s);
    if (at >= shown.size() || time_s - shown[at].from_s < 0.5) continue;
    if (table[row][column("gaze_x_px")] == "n/a") continue;
    const glm::dvec2 px(std::stod(table[row][column("gaze_x_px")]),
                        std::stod(table[row][column("gaze_y_px")]));
    const glm::dvec2 m =
        (px / glm::dvec2(1920.0, 1080.0) - 0.5) * glm::dvec2(1.0, -1.0) * kScreen.size_m;
    sum_deg += glm::degrees(glm::distance(m, shown[at].point_m) / kScreen.distance_m);
    ++count;
  }
  ASSERT_GT(count, 20.0);
  EXPECT_LE(sum_deg / count, 1.5);
}

TEST(Webcam, CalibratedOnAFilmedObserverItFollowsTheGazeByCascades) {
  const TemporaryFolder without_models;
  followTheGaze({"XDG_DATA_HOME=" + without_models.path().string()});
}

bool networksAreMissing() {
  const TemporaryFolder folder;
  return !Json::parse(runFoci({"doctor", "--json"}, folder.path()).out)["webcam_models"]["missing"]
              .empty();
}

TEST(Webcam, CalibratedOnAFilmedObserverItFollowsTheGazeByNetworks) {
  if (networksAreMissing()) {
    GTEST_SKIP() << "the webcam's networks are not installed: sh app/webcam_models.sh";
  }
  followTheGaze({});
}

/// Across and down, degrees.
struct Errors {
  glm::dvec2 tracked{0.0}, true_irises{0.0}, mean_target{0.0};
  double found = 0.0;  ///< share of the validation's frames
};

/// A person as hard to see as a real one, calibrated by the command. The same map is fitted to the
/// true irises, too: what then is left is the head's.
Errors measure(std::uint32_t index, bool glasses, double turn_rad, bool leaves) {
  constexpr double kAway_s = 30.0;
  const TemporaryFolder folder;
  const auto shown = targets(1.0, leaves ? kAway_s : 0.0);
  faces::Person person = faces::hardPerson(index);
  person.glasses = glasses;
  faces::Sitting sitting{.sway_rad = turn_rad, .blink_every_s = 0.0, .seed = index + 1};
  const faces::Observer before(sitting, shown);
  if (leaves) sitting.head_m += glm::dvec3(0.03, -0.02, 0.04);  // sits down elsewhere
  const faces::Observer after(sitting, shown);
  const double left_s = shown[kFitTargets - 1].to_s, back_s = shown[kFitTargets].from_s;
  const std::vector<faces::Truth> truths =
      faces::film(folder.path() / "eyes.mp4", faces::Face(person), 6.0, shown.back().to_s,
                  faces::hardLight(0), [&](double time_s) -> std::optional<faces::Moment> {
                    if (time_s < left_s) return before.at(time_s);
                    return time_s < back_s ? std::nullopt : std::optional(after.at(time_s));
                  });
  Errors errors;
  const Json summary = calibrate(folder, shown, {});
  errors.tracked = {summary["error_across_deg"], summary["error_down_deg"]};
  errors.found = 1.0 - summary["lost"].get<double>();

  WebcamTracker tracker;
  WebcamRecording recording = readWebcam({.file = folder.path() / "eyes.mp4"}, tracker);
  for (std::size_t i = 0; i < recording.frames.size() && i < truths.size(); ++i) {
    WebcamRecord& record = recording.frames[i].record;
    if (!record.head) continue;
    glm::dvec2 sum(0.0);
    for (const glm::dvec2& px : truths[i].iris_px) {
      sum += glm::dvec2(onHeadPlane_mm(*tracker.camera(), *record.head, px, kIrisDepth_mm));
    }
    record.view = webcamView(*record.head, 0.5 * sum);
  }
  WebcamMap map;
  const GazeReport exact = calibrateWebcam(
      pairFrames(recording.frames, readShownTargets(folder.path() / "fit.tsv")),
      pairFrames(recording.frames, readShownTargets(folder.path() / "other.tsv")), kScreen, map);
  errors.true_irises = exact.accuracy.overall.axes_deg.value_or(glm::dvec2(0.0));

  glm::dvec2 mean(0.0);
  for (std::size_t i = 0; i < kFitTargets; ++i) {
    mean += direction_deg(shown[i].point_m) / double(kFitTargets);
  }
  for (std::size_t i = kFitTargets; i < kTargets; ++i) {
    errors.mean_target +=
        glm::abs(direction_deg(shown[i].point_m) - mean) / double(kTargets - kFitTargets);
  }
  return errors;
}

TEST(Webcam, AHardFaceIsFollowedThroughTheMap) {
  if (networksAreMissing()) {
    GTEST_SKIP() << "the webcam's networks are not installed: sh app/webcam_models.sh";
  }
  const Errors errors = measure(1, false, 0.03, false);
  EXPECT_GT(errors.found, 0.9);
  // A third of the error of always guessing the middle of the screen.
  EXPECT_LT(errors.tracked.x, errors.mean_target.x / 3.0);
  EXPECT_LT(errors.tracked.y, errors.mean_target.y / 3.0);
}

/// For docs/results.py, which asks for disabled tests.
TEST(Webcam, DISABLED_DegreesOfHardFaces) {
  struct Condition {
    const char* name;
    bool glasses = false;
    double turn_rad = 0.03;
    bool leaves = false;
  };
  for (const Condition& condition :
       {Condition{.name = "usual"}, Condition{.name = "glasses", .glasses = true},
        Condition{.name = "turning_head", .turn_rad = 0.15},
        Condition{.name = "after_half_a_minute_out_of_view", .leaves = true}}) {
    constexpr std::array<std::uint32_t, 2> kPeople{1, 2};
    std::array<double, 7> mean{};
    for (const std::uint32_t person : kPeople) {
      const Errors e = measure(person, condition.glasses, condition.turn_rad, condition.leaves);
      const std::array<double, 7> values{e.found,         e.tracked.x,     e.tracked.y,
                                         e.true_irises.x, e.true_irises.y, e.mean_target.x,
                                         e.mean_target.y};
      for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += values[i] / double(kPeople.size());
    }
    std::string text;
    for (const double value : mean) text += std::to_string(value) + " ";
    RecordProperty(std::string("degrees_") + condition.name, text);
  }
}

TEST(Webcam, RefusesInOneLine) {
  const TemporaryFolder folder;
  folder.write("fit.tsv", "onset_s duration_s x_target y_target\n0 1 3 0\n");
  folder.write("broken.tsv", "onset_s duration_s x_target y_target\n0 1 0 left\n");
  folder.write("text.mp4", "no video");
  folder.write("scene.ply", squarePly(8, 1.0));
  folder.write("study.toml", smallStudy());
  const auto says = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = runFoci(arguments, folder.path());
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "made.toml"));
    return outcome.err;
  };
  const auto calibrate = [&](const std::string& source, const std::string& pairs) {
    return says({"calibrate", "gaze", "--source", source, "--pairs", pairs, "--out", "made.toml"});
  };
  EXPECT_NE(calibrate("webcam:absent.mp4", "fit.tsv").find("absent.mp4"), std::string::npos);
  EXPECT_NE(calibrate("webcam:text.mp4", "fit.tsv").find("text.mp4"), std::string::npos);
  EXPECT_NE(calibrate("webcam:63", "fit.tsv").find("camera"), std::string::npos);
  EXPECT_NE(calibrate("webcam:640", "fit.tsv").find("0 to 63"), std::string::npos);
  EXPECT_NE(calibrate("webcam:", "fit.tsv").find("expected a camera"), std::string::npos);
  EXPECT_NE(calibrate("webcam:text.mp4", "broken.tsv").find("broken.tsv:2"), std::string::npos);
  EXPECT_NE(says({"replay", "study.toml", "--trace", "webcam:text.mp4", "--out", "out"})
                .find("calibrate gaze"),
            std::string::npos);
  EXPECT_NE(says({"replay", "study.toml", "--trace", "webcam:text.mp4", "--gaze-map", "fit.tsv",
                  "--out", "out"})
                .find("fit.tsv"),
            std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
