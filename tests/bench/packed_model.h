// Writes the model of the trained detector as the file that `unpackModel` reads.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gaze/events/event_model.h"

namespace foci {

/// A line "foci event model FORMAT", a line of JSON, and the trees.
inline std::string packedModel(const EventModel& model) {
  const auto jsonOf = [](const BoostedTrees& trees) {
    return nlohmann::ordered_json{{"classes", trees.classes},
                                  {"features", trees.features},
                                  {"depth", trees.depth},
                                  {"trees", trees.trees()}};
  };
  nlohmann::ordered_json json = {{"revision", model.revision}, {"seed", model.seed}};
  for (const ModelSet& set : model.sets) {
    json["sets"].push_back({{"name", set.name},
                            {"files", set.files},
                            {"sha256", set.sha256},
                            {"licence", set.licence},
                            {"source", set.source}});
  }
  json["rate_Hz"] = {model.rate_Hz.least, model.rate_Hz.greatest};
  json["noise_deg"] = {model.noise_deg.least, model.noise_deg.greatest};
  json["switch_s"] = {model.motion_switch_s, model.oscillation_switch_s, model.pursuit_switch_s};
  std::vector<const BoostedTrees*> all;
  for (const ModelLevel& level : model.levels) {
    json["levels"].push_back({{"ahead_s", level.ahead_s},
                              {"motion", jsonOf(level.motion)},
                              {"oscillation", jsonOf(level.oscillation)}});
    all.insert(all.end(), {&level.motion, &level.oscillation});
  }
  for (const ModelMode* mode : {&model.online, &model.offline}) {
    auto knots = nlohmann::ordered_json::array();
    for (const CalibrationKnot& knot : mode->calibration) {
      knots.push_back({knot.stated, knot.right});
    }
    json["modes"].push_back({{"pursuit", jsonOf(mode->pursuit)}, {"calibration", knots}});
    all.push_back(&mode->pursuit);
  }
  std::string bytes =
      "foci event model " + std::to_string(EventModel::kFormat) + '\n' + json.dump() + '\n';
  const auto append = [&](const auto& values) {
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof values[0]);
  };
  for (const BoostedTrees* trees : all) {
    append(trees->priors);
    append(trees->edges);
    append(trees->nodes);
    append(trees->leaves);
  }
  return bytes;
}

}  // namespace foci
