#include "gaze/events/event_model.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/input_error.h"
#include "gaze/events/gaze_features.h"
#include "gaze/events/pursuit.h"

// The bytes of the model file become a part of the library, so that it opens no file.
extern "C" {
extern const char foci_event_model_begin[], foci_event_model_end[];
}

asm(R"(
.section .rodata
.balign 16
.globl foci_event_model_begin
foci_event_model_begin:
.incbin ")" FOCI_EVENT_MODEL R"("
.globl foci_event_model_end
foci_event_model_end:
.byte 0
.text
)");

namespace foci {
namespace {

constexpr std::string_view kMagic = "foci event model ";
constexpr std::size_t kMaxBytes = 1 << 24;

/// Takes arrays from the front of the bytes.
class Unpacker {
 public:
  Unpacker(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  template <typename T>
  void take(std::vector<T>& values, std::size_t count) {
    if (count * sizeof(T) > bytes_.size()) throw damaged("the file is too short");
    values.resize(count);
    std::memcpy(values.data(), bytes_.data(), count * sizeof(T));
    bytes_.remove_prefix(count * sizeof(T));
  }

  /// @param features, classes  as the detector needs them
  BoostedTrees trees(const nlohmann::json& json, std::size_t features, std::size_t classes) {
    constexpr std::size_t kMaxDepth = 8, kMaxTrees = 4096;
    BoostedTrees trees{.classes = json.at("classes").get<std::size_t>(),
                       .features = json.at("features").get<std::size_t>(),
                       .depth = json.at("depth").get<std::size_t>()};
    const auto count = json.at("trees").get<std::size_t>();
    if (trees.classes != classes || trees.features != features || trees.depth > kMaxDepth ||
        count > kMaxTrees || count % classes != 0) {
      throw damaged("unexpected size of its trees");
    }
    take(trees.priors, classes);
    take(trees.edges, features * (BoostedTrees::kBins - 1));
    take(trees.nodes, count * ((std::size_t{1} << trees.depth) - 1));
    take(trees.leaves, count << trees.depth);
    for (const BoostedTrees::Node& node : trees.nodes) {
      const bool splits = node.bin != BoostedTrees::kNoSplit;
      if (splits && (node.bin + 1U >= BoostedTrees::kBins || node.feature >= features)) {
        throw damaged("a tree asks for a feature that does not exist");
      }
    }
    for (const float prior : trees.priors) {
      if (!(prior > 0.0F && prior <= 1.0F)) throw damaged("a share of a class is not in 0 to 1");
    }
    return trees;
  }

  void finish() const {
    if (!bytes_.empty()) throw damaged("the file is too long");
  }

  InputError damaged(const std::string& why) const {
    return {name_, "damaged event model: " + why + "; train it again (foci_train_events)"};
  }

 private:
  std::string_view bytes_;
  const std::string& name_;
};

}  // namespace

double calibrated(double stated, const std::vector<CalibrationKnot>& knots) {
  if (knots.empty()) return stated;
  const auto after = std::ranges::find_if(
      knots, [&](const CalibrationKnot& knot) { return knot.stated >= stated; });
  if (after == knots.begin()) return after->right;
  if (after == knots.end()) return knots.back().right;
  const CalibrationKnot &a = *(after - 1), &b = *after;
  return a.right + (b.right - a.right) * (stated - a.stated) / (b.stated - a.stated);
}

EventModel unpackModel(std::string_view bytes, const std::string& name) {
  const auto line = [&] {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    const std::string_view text = bytes.substr(0, end);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    return text;
  };
  if (!bytes.starts_with(kMagic) || bytes.size() > kMaxBytes) {
    throw InputError(name, "no event model: expected a file of foci_train_events");
  }
  const std::string version(line().substr(kMagic.size()));
  if (version != std::to_string(EventModel::kFormat)) {
    throw InputError(name, "event model of version " + version + ": expected version " +
                               std::to_string(EventModel::kFormat) +
                               "; train it again (foci_train_events)");
  }
  const std::string_view header = line();
  Unpacker unpacker(bytes, name);
  try {
    const auto json = nlohmann::json::parse(header);
    EventModel model{.revision = json.at("revision").get<int>(),
                     .seed = json.at("seed").get<unsigned>()};
    for (const auto& set : json.at("sets")) {
      model.sets.push_back({.name = set.at("name").get<std::string>(),
                            .licence = set.at("licence").get<std::string>(),
                            .source = set.at("source").get<std::string>(),
                            .sha256 = set.at("sha256").get<std::string>(),
                            .files = set.at("files").get<int>()});
    }
    const auto range = [&](const char* key) {
      return ModelRange{json.at(key).at(0).get<double>(), json.at(key).at(1).get<double>()};
    };
    model.rate_Hz = range("rate_Hz");
    model.noise_deg = range("noise_deg");
    model.motion_switch_s = json.at("switch_s").at(0).get<double>();
    model.oscillation_switch_s = json.at("switch_s").at(1).get<double>();
    model.pursuit_switch_s = json.at("switch_s").at(2).get<double>();
    for (const auto& each : json.at("levels")) {
      ModelLevel level{.ahead_s = each.at("ahead_s").get<double>()};
      level.motion = unpacker.trees(each.at("motion"), kGazeFeatures, 3);
      level.oscillation = unpacker.trees(each.at("oscillation"), kGazeFeatures, 2);
      model.levels.push_back(std::move(level));
    }
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& each = json.at("modes").at(i);
      ModelMode& mode = i == 0 ? model.online : model.offline;
      mode.pursuit = unpacker.trees(each.at("pursuit"), kPursuitFeatures, 2);
      for (const auto& knot : each.at("calibration")) {
        mode.calibration.push_back({knot.at(0).get<double>(), knot.at(1).get<double>()});
      }
    }
    unpacker.finish();
    if (model.levels.empty() || !(model.levels.back().ahead_s > 0.0)) {
      throw unpacker.damaged("none of its trees look ahead");
    }
    return model;
  } catch (const nlohmann::json::exception&) {
    throw unpacker.damaged("its header is not complete");
  }
}

void BoostedTrees::probabilities(std::span<const float> values,
                                 std::span<double> of_classes) const {
  assert(values.size() == features && of_classes.size() == classes && classes <= 8);
  const std::size_t inner = (std::size_t{1} << depth) - 1;
  std::array<std::int32_t, 8> sums{};  // whole numbers: their order does not matter
  for (std::size_t tree = 0; tree < trees(); ++tree) {
    const Node* node = &nodes[tree * inner];
    std::size_t at = 0;
    for (std::size_t level = 0; level < depth; ++level) {
      const Node each = node[at];
      const bool right = each.bin != kNoSplit &&
                         values[each.feature] > edges[each.feature * (kBins - 1) + each.bin];
      at = 2 * at + 1 + (right ? 1 : 0);
    }
    sums[tree % classes] += leaves[(tree << depth) + at - inner];
  }
  double total = 0.0;
  const std::int32_t most =
      *std::max_element(sums.begin(), sums.begin() + static_cast<std::ptrdiff_t>(classes));
  for (std::size_t k = 0; k < classes; ++k) {
    of_classes[k] =
        std::exp(kLeafUnit * (sums[k] - most) + std::log(static_cast<double>(priors[k])));
    total += of_classes[k];
  }
  for (double& each : of_classes) each /= total;
}

const EventModel& builtinEventModel() {
  static const EventModel kModel =
      unpackModel({foci_event_model_begin,
                   static_cast<std::size_t>(foci_event_model_end - foci_event_model_begin)},
                  "the built-in event model");
  return kModel;
}

}  // namespace foci
