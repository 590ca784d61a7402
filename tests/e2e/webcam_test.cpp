// The whole way of a webcam: a filmed observer looks at targets; calibrate, validate, run.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/videoio.hpp>

#include "tests/e2e/binary.h"
#include "tests/faces/observer.h"

namespace foci::e2e {
namespace {

using Json = nlohmann::json;

constexpr double kRate_Hz = 15.0, kShown_s = 0.8;
constexpr glm::dvec2 kScreen_m{0.52, 0.2925};
constexpr double kDistance_m = 0.55;

/// 9 targets to calibrate on, 4 others to validate on; m from the screen's centre.
std::vector<faces::ShownTarget> targets() {
  constexpr glm::dvec2 kFit{0.23, 0.12}, kOther{0.12, 0.06};
  std::vector<faces::ShownTarget> shown;
  const auto show = [&](const glm::dvec2& point_m) {
    const double from_s = kShown_s * static_cast<double>(shown.size());
    shown.push_back({from_s, from_s + kShown_s, point_m});
  };
  for (int i = 0; i < 9; ++i) {
    const int place = (5 * i + 4) % 9;  // from the centre, in leaps
    show(kFit * glm::dvec2(place % 3 - 1, 1 - place / 3));
  }
  for (int i = 0; i < 4; ++i) show(kOther * glm::dvec2(i % 2 == 0 ? -1 : 1, i < 2 ? 1 : -1));
  return shown;
}

std::string targetTable(const std::vector<faces::ShownTarget>& shown, std::size_t from,
                        std::size_t to) {
  std::string text = "onset_s\tduration_s\tx_target\ty_target\n";
  for (std::size_t i = from; i < to; ++i) {
    const glm::dvec2 deg = glm::degrees(glm::atan(shown[i].point_m / kDistance_m));
    text += std::to_string(shown[i].from_s) + "\t" + std::to_string(kShown_s) + "\t" +
            std::to_string(deg.x) + "\t" + std::to_string(deg.y) + "\n";
  }
  return text;
}

/// Films the observer, whose head sways and who blinks.
void film(const std::filesystem::path& file, const std::vector<faces::ShownTarget>& shown,
          std::uint32_t person) {
  const faces::Face face(faces::somebody(person));
  const faces::Observer observer({.seed = 5}, shown);
  faces::Photography how;
  cv::VideoWriter video(file.string(), cv::VideoWriter::fourcc('a', 'v', 'c', '1'), kRate_Hz,
                        {how.size_px.x, how.size_px.y});
  ASSERT_TRUE(video.isOpened());
  const int frames = static_cast<int>(std::lround(shown.back().to_s * kRate_Hz));
  for (int frame = 0; frame < frames; ++frame) {
    how.seed = static_cast<std::uint32_t>(frame);
    video.write(face.photograph(observer.at(frame / kRate_Hz), how));
  }
}

/// @param environment  chooses the tracker: without its models networks are not used
void followTheGaze(const std::vector<std::string>& environment) {
  const TemporaryFolder folder;
  const auto shown = targets();
  film(folder.path() / "eyes.mp4", shown, 0);
  folder.write("fit.tsv", targetTable(shown, 0, 9));
  folder.write("other.tsv", targetTable(shown, 9, shown.size()));
  ASSERT_EQ(runFoci({"calibrate", "screen", "--headless", "--size-px", "1920x1080", "--size-m",
                     "0.52x0.2925", "--distance-m", "0.55", "--out", "screen.toml"},
                    folder.path(), environment)
                .exit_code,
            0);

  // Calibrate and validate.
  const Outcome calibrated =
      runFoci({"calibrate", "gaze", "--source", "webcam:eyes.mp4", "--pairs", "fit.tsv",
               "--validate", "other.tsv", "--screen", "screen.toml", "--out", "map.toml", "--json"},
              folder.path(), environment);
  ASSERT_EQ(calibrated.exit_code, 0) << calibrated.err;
  const Json summary = Json::parse(calibrated.out);
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
        (px / glm::dvec2(1920.0, 1080.0) - 0.5) * glm::dvec2(1.0, -1.0) * kScreen_m;
    sum_deg += glm::degrees(glm::distance(m, shown[at].point_m) / kDistance_m);
    ++count;
  }
  ASSERT_GT(count, 20.0);
  EXPECT_LE(sum_deg / count, 1.5);
}

TEST(Webcam, CalibratedOnAFilmedObserverItFollowsTheGazeByCascades) {
  const TemporaryFolder without_models;
  followTheGaze({"XDG_DATA_HOME=" + without_models.path().string()});
}

TEST(Webcam, CalibratedOnAFilmedObserverItFollowsTheGazeByNetworks) {
  const TemporaryFolder folder;
  const Outcome doctor = runFoci({"doctor", "--json"}, folder.path());
  ASSERT_EQ(doctor.exit_code, 0) << doctor.err;
  if (!Json::parse(doctor.out)["webcam_models"]["missing"].empty()) {
    GTEST_SKIP() << "the webcam's networks are not installed: sh app/webcam_models.sh";
  }
  followTheGaze({});
}

TEST(Webcam, RefusesInOneLine) {
  const TemporaryFolder folder;
  folder.write("fit.tsv", "onset_s duration_s x_target y_target\n0 1 0 0\n");
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

}  // namespace
}  // namespace foci::e2e
