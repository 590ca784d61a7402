// Scenes made to break depth-of-field methods, each with one dial that runs from harmless to
// extreme, and what each gives as its score. Where the picture is known in closed form it is scored
// against that, else against the reference of many pinhole views.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "render/methods/method.h"

namespace foci {

/// How much is spent.
struct StabilityEffort {
  int views = 64;            ///< pinhole views of the reference: 400 in full
  bool every_value = false;  ///< all of the dial's values, or its first, its last and the target's
};

/// A scene with its dial set.
struct StabilitySetup {
  SurfelCloud cloud;
  RenderSettings settings;
  /// Of a frame; absent: the PSNR against the reference.
  std::function<double(const Frame&)> score{};
};

struct StabilityScene {
  std::string_view name;
  std::string_view what;   ///< one line
  std::string_view dial;   ///< with its unit
  std::string_view score;  ///< what is measured, with its unit
  bool high_is_good = false;
  std::vector<float> values;        ///< of the dial, from harmless to extreme
  std::vector<float> short_values;  ///< of the short run
  std::function<StabilitySetup(float value)> setup;
  /// What a single frame does not tell; absent: the setup's score.
  /// @param method  as of `makeMethod`
  std::function<double(std::string_view method, float value, const StabilityEffort& effort)>
      measure{};
};

const std::vector<StabilityScene>& stabilityScenes();

/// The scores of some methods, as of `makeMethod`.
std::vector<double> stabilityScores(const StabilityScene& scene, float value,
                                    const std::vector<std::string>& methods,
                                    const StabilityEffort& effort);

/// A scene as a method draws it.
Frame stabilityFrame(const StabilitySetup& setup, std::string_view method);

/// The share of a uniform disc of radius `radius_px` that lies on the near side of a straight edge
/// `distance_px` from its centre (positive: beyond it), seen through a Gaussian pixel of
/// `sigma_px`:
///   share(x) = (acos(-t) + t sqrt(1 - t^2)) / pi, t = clamp(x / radius, -1, 1),
/// convolved with the Gaussian; with radius 0 the Gaussian's own step. 0 to 1.
double edgeShare(double distance_px, double radius_px, double sigma_px);

}  // namespace foci
