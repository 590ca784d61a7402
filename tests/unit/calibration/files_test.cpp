#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "base/input_error.h"
#include "base/text.h"
#include "calibration/binocular/fit_binocular.h"
#include "calibration/camera/camera.h"
#include "calibration/gaze_map/fit_gaze_map.h"
#include "calibration/gaze_map/gaze_map.h"
#include "calibration/screen/screen_file.h"
#include "tests/unit/calibration/simulated_user.h"

namespace foci {
namespace FOCI_FILE {

class CalibrationFiles : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text, const std::string& name = "file") {
    const auto path = folder_ / name;
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  template <typename Read>
  std::string refusal(Read read, const std::string& text) {
    try {
      read(write(text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  void SetUp() override {
    folder_ =
        std::filesystem::path(testing::TempDir()) /
        ("foci_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

 private:
  std::filesystem::path folder_;
};

TEST_F(CalibrationFiles, MapComesBackToTheLastDigit) {
  std::mt19937_64 random(1);
  SimulatedUser user;
  user.square[1] = {2.0, -1.0};
  user.noise_deg = 0.3;
  for (const MapUnits units : {MapUnits::deg, MapUnits::norm}) {
    auto pairs = recordUser(user, targetGrid(3, 12.0), 20, random);
    for (GazePair& p : pairs) {
      if (units == MapUnits::norm) p.target = p.target / 40.0 + 0.5;
    }
    const GazeMap map = fitGazeMap(pairs, {.units = units, .screen = defaultScreen()}).map;
    const GazeMap back = readGazeMap(write(gazeMapToml(map)));
    EXPECT_EQ(gazeMapToml(back), gazeMapToml(map));
    const GazeEstimate a = estimateGaze(map, {3.0, 4.0}), b = estimateGaze(back, {3.0, 4.0});
    EXPECT_EQ(a.point, b.point);
    EXPECT_EQ(a.uncertainty_deg, b.uncertainty_deg);
  }
}

TEST_F(CalibrationFiles, BadMapsAreRefusedByKey) {
  std::mt19937_64 random(2);
  const std::string good =
      gazeMapToml(fitGazeMap(recordUser({}, targetGrid(3, 12.0), 5, random), {}).map);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return refusal(readGazeMap, text);
  };
  EXPECT_EQ(refusal(readGazeMap, good), "");
  EXPECT_NE(with("\"affine\"", "\"fourth\"").find("map.model"), std::string::npos);
  EXPECT_NE(with("\"affine\"", "\"second\"").find("map.x"), std::string::npos);
  EXPECT_NE(with("\"deg\"", "3").find("map.units"), std::string::npos);
  EXPECT_NE(with("sigma_radius = ", "sigma_radius = -").find("sigma_radius"), std::string::npos);
  EXPECT_NE(with("[uncertainty]", "[uncertainty]\nspare = 1").find("unknown key"),
            std::string::npos);
  EXPECT_NE(refusal(readGazeMap, std::string(5000, '[')).find("nested"), std::string::npos);
  EXPECT_NE(refusal(readGazeMap, ""), "");
}

TEST_F(CalibrationFiles, ScreensComeBackFromTomlAndPsychoPy) {
  const ScreenCalibration screen{
      .screen = {.size_px = {2560, 1440}, .size_m = {0.597, 0.3358125}, .distance_m = 0.63},
      .gamma = 2.2,
      .size_from = "bank \"card\"",
      .distance_from = "blind spot"};
  const ScreenCalibration back = readScreen(write(screenToml(screen)));
  EXPECT_EQ(screenToml(back), screenToml(screen));
  const ScreenCalibration psychopy =
      readScreen(write(psychoPyMonitor(screen.screen, 2.2, "office")));
  EXPECT_EQ(psychopy.gamma, 2.2);
  const Screen& monitor = psychopy.screen;
  EXPECT_EQ(monitor.size_px, screen.screen.size_px);
  EXPECT_NEAR(monitor.size_m.x, 0.597, 1e-12);
  EXPECT_NEAR(monitor.size_m.y, 0.3358125, 1e-12);
  EXPECT_NEAR(monitor.distance_m, 0.63, 1e-12);
}

TEST_F(CalibrationFiles, PsychoPyTakesTheLastCalibrationAndNumpyArrays) {
  const ScreenCalibration monitor = readPsychoPyMonitor(write(R"({
    "2024_01_02": {"sizePix": {"__ndarray__": [1920, 1080], "dtype": "int64"},
                   "width": 53.0, "distance": 60.0, "gamma": null, "notes": ""},
    "2023_05_01": {"sizePix": [800, 600], "width": 30, "distance": 50}})"));
  EXPECT_NE(monitor.size_from.find("\"2024_01_02\""), std::string::npos) << monitor.size_from;
  const Screen& screen = monitor.screen;
  EXPECT_EQ(screen.size_px, glm::ivec2(1920, 1080));
  EXPECT_NEAR(screen.size_m.x, 0.53, 1e-12);
  EXPECT_NEAR(screen.distance_m, 0.6, 1e-12);
}

TEST_F(CalibrationFiles, PsychoPyGivesGammaAsANumberAListOrAGrid) {
  const auto gamma = [&](const std::string& fields) {
    return readPsychoPyMonitor(write(R"({"a": {"sizePix": [1920, 1080], "width": 53, )"
                                     R"("distance": 60, "notes": "NaN", )" +
                                     fields + "}}"))
        .gamma;
  };
  const auto grid = [](const std::string& values) {
    return R"("gamma": 1.8, "gammaGrid": {"__ndarray__": )" + values + "}";
  };
  EXPECT_DOUBLE_EQ(gamma(R"("gamma": 2.2)").value(), 2.2);
  EXPECT_DOUBLE_EQ(gamma(R"("gamma": [2.1, 2.2, 2.3])").value(), 2.2);
  EXPECT_FALSE(gamma(R"("gamma": [1, 1, 1])"));
  const std::string measured =
      "[[0, 120, 2.4, NaN], [0, 30, 2.0, NaN], [0, 70, 2.0, NaN], "
      "[0, 20, 2.3, NaN]]";
  EXPECT_DOUBLE_EQ(gamma(grid(measured)).value(), 2.1);
  EXPECT_DOUBLE_EQ(gamma(grid("[[0, 1, 1], [0, 1, 1], [0, 1, 1], [0, 1, 1]]")).value(), 1.8);
  EXPECT_DOUBLE_EQ(gamma(grid("[[0, 120, 2.4, NaN]]")).value(), 2.4);
  EXPECT_DOUBLE_EQ(gamma(grid("[[0, 1, 1]]")).value(), 1.8);
  EXPECT_THROW(gamma(grid("[[0, 1]]")), InputError);
  EXPECT_THROW(gamma(grid("[[0, 1, 1], [0, 1, 1]]")), InputError);
  EXPECT_THROW(gamma(grid("[[0, 1, 1], [0, 1, 1], [0, 1, 1], [0, 1, 9]]")), InputError);
  for (const char* no_number : {R"("2.2")", R"({"__tuple__": [2.2, 2.2]})", "true"}) {
    EXPECT_FALSE(gamma(R"("gamma": )" + std::string(no_number))) << no_number;
    EXPECT_FALSE(gamma(R"("gammaGrid": )" + std::string(no_number))) << no_number;
  }
}

TEST_F(CalibrationFiles, HostileMonitorsAreRefused) {
  for (const std::string& text :
       {std::string("{"), std::string("{}"), std::string("[]"), std::string("{\"a\": 3}"),
        std::string(R"({"sizePix": "x", "width": 30, "distance": 50})"),
        std::string(R"({"sizePix": [1920, 1080], "width": null, "distance": 50})"),
        std::string(R"({"sizePix": [1920, 1080], "width": 53})"),
        std::string(R"({"sizePix": [1920, 1080], "width": 53, "distance": 60, "gamma": 9})"),
        "{\"sizePix\": " + std::string(100000, '[')}) {
    EXPECT_NE(refusal(readPsychoPyMonitor, text), "") << text.substr(0, 60);
  }
}

TEST_F(CalibrationFiles, WhatAMonitorStatesIsCutBetweenCharacters) {
  std::string width = "\"x";
  for (int i = 0; i < 40; ++i) width += "\u00e9";
  const std::string why =
      refusal(readPsychoPyMonitor,
              R"({"sizePix": [1920, 1080], "distance": 50, "width": )" + width + "\"}");
  EXPECT_NE(why.find("width"), std::string::npos) << why;
  for (std::size_t i = 0; i < why.size();
       i += std::max<std::size_t>(utf8Length(why.substr(i)), 1)) {
    EXPECT_GT(utf8Length(why.substr(i)), 0u) << why;
  }
}

TEST_F(CalibrationFiles, CamerasComeBack) {
  const CameraModel camera{.size_px = {640, 480},
                           .focal_px = {600.5, 601.25},
                           .principal_px = {321, 239},
                           .distortion = {0.1, -0.2, 0.001, 0, 0.05},
                           .focal_sd_px = {0.5, 0.6},
                           .rms_px = 0.2};
  EXPECT_EQ(cameraToml(readCamera(write(cameraToml(camera)))), cameraToml(camera));
}

TEST_F(CalibrationFiles, PairsInAnyOrderOfColumnsAndAnySeparator) {
  for (const char separator : {'\t', ';', ',', ' '}) {
    std::string text =
        "y_target weight x time_s x_target y spare\n1 0.5 -2 0.1 3 4 a\n1 1 n/a 0.2 3 4 b\n";
    std::replace(text.begin(), text.end(), ' ', separator);
    const auto pairs = readGazePairs(write(text), MapUnits::deg);
    ASSERT_EQ(pairs.size(), 2u);
    EXPECT_EQ(*pairs[0].gaze, glm::dvec2(-2, 4));
    EXPECT_EQ(pairs[0].target, glm::dvec2(3, 1));
    EXPECT_EQ(pairs[0].weight, 0.5);
    EXPECT_EQ(*pairs[0].time_s, 0.1);
    EXPECT_FALSE(pairs[1].gaze);
  }
}

TEST_F(CalibrationFiles, PairsAreReadAsRecordingsAre) {
  const std::string rows = "x;y;x_target;y_target\r\n1;2;3;4\r\n";
  for (const std::string before :
       {"", "\xef\xbb\xbf", "sep=;\r\n", "\xef\xbb\xbfsep=;\r\n", "# of a\r\n\r\n"}) {
    for (const std::string absent : {"", "-", ".", "NaN", "-nan(ind)", "null"}) {
      const auto pairs =
          readGazePairs(write(before + rows + absent + ";2;3;4;\r\n"), MapUnits::deg);
      ASSERT_EQ(pairs.size(), 2u);
      EXPECT_EQ(*pairs[0].gaze, glm::dvec2(1, 2));
      EXPECT_FALSE(pairs[1].gaze) << absent;
    }
  }
}

TEST_F(CalibrationFiles, PairsMayHaveDecimalCommas) {
  const std::string header = "x;y;x_target;y_target\n";
  for (const char* before : {"x;y;x_target;y_target\n", "sep=;\nx;y;x_target;y_target\n",
                             "x\ty\tx_target\ty_target\n", "x y x_target y_target\n"}) {
    std::string row = "-1,25;2;3,5;4\n";
    if (std::string(before).find('\t') != std::string::npos) row = "-1,25\t2\t3,5\t4\n";
    if (before[1] == ' ') row = "-1,25 2 3,5 4\n";
    const auto pairs = readGazePairs(write(before + row), MapUnits::deg);
    ASSERT_EQ(pairs.size(), 1u);
    EXPECT_EQ(*pairs[0].gaze, glm::dvec2(-1.25, 2)) << before;
    EXPECT_EQ(pairs[0].target, glm::dvec2(3.5, 4)) << before;
  }
  const auto refused = refusal([](const auto& path) { readGazePairs(path, MapUnits::deg); },
                               header + "1,271;2;3;4\n954;2;3;4\n");
  EXPECT_NE(refused.find(":2: column 1 = \"1,271\": a decimal comma, or a separator"),
            std::string::npos)
      << refused;

  const auto eyes = readBinocularPairs(
      write("left_origin_x_mm;left_origin_y_mm;left_origin_z_mm;left_direction_x;left_direction_y;"
            "left_direction_z;x_target_mm;y_target_mm\n-31,5;0;600;0,05;0;-1;12,5;0\n"));
  ASSERT_EQ(eyes.size(), 1u);
  EXPECT_DOUBLE_EQ(eyes[0].target_m.x, 0.0125);
  EXPECT_DOUBLE_EQ(eyes[0].eyes[0]->centre_m.x, -0.0315);
}

TEST_F(CalibrationFiles, BadPairsAreRefusedByLine) {
  const auto refused = [&](const std::string& text) {
    return refusal([](const auto& path) { readGazePairs(path, MapUnits::deg); }, text);
  };
  const std::string header = "x\ty\tx_target\ty_target\n";
  EXPECT_NE(refused(""), "");
  EXPECT_NE(refused("x\ty\tx_target\n").find("y_target"), std::string::npos);
  EXPECT_NE(refused(header).find("no rows"), std::string::npos);
  EXPECT_NE(refused(header + "1\t2\t3\t4\n1\t2\t3\n").find(":3"), std::string::npos);
  EXPECT_NE(refused(header + "1\t2x\t3\t4\n").find("y = \"2x\""), std::string::npos);
  EXPECT_NE(refused(header + "1\t2\t300\t4\n").find("x_target = \"300\""), std::string::npos);
  EXPECT_NE(refused(header + "1\t2\tn/a\t4\n").find("without a target"), std::string::npos);
  EXPECT_NE(refused(header + "inf\t2\t3\t4\n"), "");
  EXPECT_NE(refused("x\tx\ty\tx_target\ty_target\n").find("twice"), std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci
