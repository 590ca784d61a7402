// Scenes made to break depth-of-field methods. Each scene has one dial, which runs from harmless to
// extreme.
//
// A scene with a closed form is scored against it. A scene of sheets is scored against rays that
// meet the sheets exactly (sheets.h). Other scenes are scored against the mean of many pinhole
// views.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/scene_in_view.h"
#include "render/methods/method.h"

namespace foci {

/// A scene with its dial set.
struct StabilitySetup {
  View view;
  SurfelCloud cloud;
  RenderSettings settings;
  /// The reference; absent: the frame that `accumulate` renders of the cloud.
  std::function<Frame(const View&, const RenderSettings&, int samples)> truth{};
  /// The score of a frame; absent: its PSNR against the reference.
  std::function<double(const Frame&)> score{};
  /// A background. Its frame is subtracted from the frame of `cloud` before the score is taken.
  std::optional<SurfelCloud> without{};
  /// Moves view and settings one step further, if something moves. The score is then the excess
  /// change (excess_change.h), the max over the steps.
  std::function<void(View&, RenderSettings&)> step{};
};

struct StabilityScene {
  std::string name;   ///< in file names and options
  std::string what;   ///< one line
  std::string dial;   ///< name and unit of the dial
  std::string score;  ///< name and unit of the score
  bool high_is_good = false;
  double good = 0.0;          ///< the score that a method should reach, or stay below
  std::vector<float> values;  ///< of the dial, from harmless to extreme
  std::function<StabilitySetup(float value)> setup{};
  /// A scene of gaze compares observers instead of methods: their names,
  std::vector<std::string> observers{};
  /// and the score of one of them.
  std::function<double(std::size_t observer, float value)> observe{};
  std::string input{};                  ///< `scanKey` of a scan; empty for a built-in scene
  std::vector<std::string> warnings{};  ///< of reading the scan, printed already

  bool isGood(double value) const { return high_is_good ? value >= good : value <= good; }
};

/// All built-in scenes.
const std::vector<StabilityScene>& stabilityScenes();

/// A scan with a part of its points, scored against the whole scan.
StabilityScene thinnedScan(const ScanView& scan);

}  // namespace foci
