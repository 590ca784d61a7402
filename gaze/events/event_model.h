// The trained detector's model: its gradient-boosted trees (Friedman 2001), its file, and where it
// comes from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace foci {

/// An additive model of the log odds of some classes. Each round adds one tree for each class. All
/// trees are complete and have the same depth.
struct BoostedTrees {
  static constexpr std::size_t kBins = 64;       ///< of each feature
  static constexpr std::uint8_t kNoSplit = 255;  ///< as `Node::bin`: all samples go to the left
  static constexpr double kLeafUnit = 1.0 / 4096.0;

  struct Node {
    std::uint8_t feature = 0;
    std::uint8_t bin = kNoSplit;  ///< values above `edges[feature][bin]` go to the right
  };

  std::size_t classes = 0, features = 0, depth = 0;
  std::vector<float> edges{};          ///< `kBins - 1` for each feature, ascending
  std::vector<Node> nodes{};           ///< 2^depth - 1 for each tree, level by level
  std::vector<std::int16_t> leaves{};  ///< 2^depth for each tree, in `kLeafUnit`
  std::vector<float> priors{};         ///< share of each class in the training, > 0

  std::size_t trees() const { return leaves.size() >> depth; }

  /// The probability of each class, given the shares of the training. They sum to 1.
  /// @param values  one for each feature
  void probabilities(std::span<const float> values, std::span<double> of_classes) const;
};

/// A data set that the model was trained on.
struct ModelSet {
  std::string name, licence, source;
  std::string sha256;  ///< of the files' SHA-256, in order of their paths
  int files = 0;
};

/// Least and greatest value in the training, between which a recording is familiar.
struct ModelRange {
  double least = 0.0, greatest = 0.0;
};

/// A point of the curve from a label's probability by the trees to the share of such labels that
/// were right on data sets left out.
struct CalibrationKnot {
  double stated = 0.0, right = 0.0;
};

/// The curve at a probability, straight between its points. Without points, the probability.
double calibrated(double stated, const std::vector<CalibrationKnot>& knots);

/// The trees for one lookahead.
struct ModelLevel {
  double ahead_s = 0.0;        ///< features look ahead so far
  BoostedTrees motion{};       ///< classes of `Motion`
  BoostedTrees oscillation{};  ///< of a moving eye: saccade, oscillation
};

/// What differs between the online and the offline detector.
struct ModelMode {
  BoostedTrees pursuit{};                      ///< of stable gaze: fixation, pursuit
  std::vector<CalibrationKnot> calibration{};  ///< ascending
};

/// What the first trees tell apart.
enum class Motion { stable, moving, gone };

struct EventModel {
  static constexpr int kFormat = 2;  ///< version of features and file; another is refused

  int revision = 0;  ///< counts the trainings that were published
  unsigned seed = 0;
  std::vector<ModelSet> sets{};
  ModelRange rate_Hz{}, noise_deg{};
  double motion_switch_s = 0.0;       ///< cost of a change of the motion, `ViterbiPath`
  double oscillation_switch_s = 0.0;  ///< from saccade to oscillation and back
  double pursuit_switch_s = 0.0;      ///< from fixation to pursuit and back
  std::vector<ModelLevel> levels{};   ///< ascending by `ahead_s`; one looks ahead at least
  ModelMode online{}, offline{};
};

/// A model file (tests/bench/packed_model.h): a line "foci event model FORMAT", a line of JSON, and
/// the trees.
/// @param name  for the error
/// @throws InputError if it is no model, of another version or damaged
EventModel unpackModel(std::string_view bytes, const std::string& name);

/// The model that is part of the library. It is unpacked at the first call.
const EventModel& builtinEventModel();

}  // namespace foci
