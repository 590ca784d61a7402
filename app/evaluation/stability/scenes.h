// Scenes made to break depth-of-field methods, each with one dial that runs from harmless to
// extreme, and what each gives as its score. Where the image is known in closed form it is scored
// against that, where it is made of sheets against rays that meet them exactly
// (stability_sheets.h), else against the reference of many pinhole views.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/evaluation/scene_in_view.h"
#include "render/methods/method.h"

namespace foci {

/// How much is spent.
struct StabilityEffort {
  int samples = 64;  ///< of the lens, for the reference
  int steps = 4;     ///< from frame to frame, where something moves
};

/// A scene with its dial set.
struct StabilitySetup {
  View view;
  SurfelCloud cloud;
  RenderSettings settings;
  /// What is seen in truth. Absent: what `accumulate` draws of the cloud.
  std::function<Frame(const View&, const RenderSettings&, int samples)> truth{};
  /// Of a frame; absent: the PSNR against the reference.
  std::function<double(const Frame&)> score{};
  /// What is drawn without what is scored: taken from the frame before it is.
  std::optional<SurfelCloud> without{};
  /// Where something moves, view and settings a step further; the score is then the change from
  /// frame to frame beyond the reference's own that 99.9 % of the pixels stay below, the most over
  /// the steps.
  std::function<void(View&, RenderSettings&)> step{};
};

struct StabilityScene {
  std::string name;   ///< in names of files and options
  std::string what;   ///< one line
  std::string dial;   ///< with its unit
  std::string score;  ///< what is measured, with its unit
  bool high_is_good = false;
  double good = 0.0;          ///< the score that a method is to reach, or to stay below
  std::vector<float> values;  ///< of the dial, from harmless to extreme
  std::function<StabilitySetup(float value)> setup{};
  /// Not of images: who is held against each other instead of methods,
  std::vector<std::string> observers{};
  /// and the score of one of them.
  std::function<double(std::size_t observer, float value)> observe{};
  std::string input{};  ///< of a scan, as of `inputOf`; empty for what is built in

  bool isGood(double value) const { return high_is_good ? value >= good : value <= good; }
};

/// All but the scan's.
const std::vector<StabilityScene>& stabilityScenes();

/// A scan that is thinned out, against the whole of it. @param size_px  width of the image
StabilityScene thinnedScan(const ScanView& scan);

/// One scene at one value, against which methods are held. Draws the reference when it is first
/// asked for.
class StabilityTrial {
 public:
  /// @param scene  of images
  StabilityTrial(const StabilityScene& scene, float value, const StabilityEffort& effort);

  /// @param method  as of `makeMethod`
  double score(std::string_view method);

  /// The last frame that was scored, where something moves the last of the steps, and what it was
  /// to be.
  const Frame& drawn() const { return drawn_; }
  const Frame& reference();

  const StabilitySetup& setup() const { return setup_; }

 private:
  Frame draw(std::string_view method, const SurfelCloud& cloud) const;
  double popping(std::string_view method);
  const std::vector<Frame>& references();

  StabilitySetup setup_;
  StabilityEffort effort_;
  Frame drawn_;
  std::vector<Frame> references_;  // a frame, or one a step and one more
};

/// The share of a uniform disc of radius `radius_px` that lies on the near side of a straight edge
/// `distance_px` from its centre (positive: beyond it), seen through a Gaussian pixel of
/// `sigma_px`:
///   share(x) = (acos(-t) + t sqrt(1 - t^2)) / pi, t = clamp(x / radius, -1, 1),
/// convolved with the Gaussian; with radius 0 the Gaussian's own step. 0 to 1.
double edgeShare(double distance_px, double radius_px, double sigma_px);

/// A uniform disc of unit volume and radius `radius_px`, seen through a Gaussian of `sigma_px`, at
/// a distance from its centre:
///   1 / (pi C^2 s^2) int_0^C r exp(-(r^2 + d^2) / (2 s^2)) I0(r d / s^2) dr. Per square pixel.
double discThroughGaussian(double distance_px, double radius_px, double sigma_px);

}  // namespace foci
