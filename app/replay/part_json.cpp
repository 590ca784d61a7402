#include "app/replay/part_json.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace foci {
namespace {

using Json = nlohmann::ordered_json;

Json jsonOf(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json jsonOf(const glm::dvec2& point) { return Json::array({point.x, point.y}); }

Json jsonOf(const std::optional<glm::dvec2>& point) {
  return point ? jsonOf(*point) : Json(nullptr);
}

std::optional<double> numberOf(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return json.get<double>();
}

glm::dvec2 vectorOf(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>()};
}

std::optional<glm::dvec2> pointOf(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return vectorOf(json);
}

GazeState stateNamed(const std::string& name) {
  for (const GazeState state :
       {GazeState::fixation, GazeState::saccade, GazeState::oscillation, GazeState::pursuit,
        GazeState::blink, GazeState::lost, GazeState::unjudged}) {
    if (nameOf(state) == name) return state;
  }
  throw std::runtime_error("unknown gaze state");
}

}  // namespace

Json jsonOf(const PartFrame& frame) {
  const FrameRecord& record = frame.seen.record;
  const EyeNow& eye = record.eye;
  Json points = Json::array();
  for (const glm::dvec2& point_px : frame.seen.gaze_px) points.push_back(jsonOf(point_px));
  Json json = {
      {"time_s", record.time_s},
      {"eye_m", {record.eye_m.x, record.eye_m.y, record.eye_m.z}},
      {"world_from_eye_xyzw",
       {record.world_from_eye.x, record.world_from_eye.y, record.world_from_eye.z,
        record.world_from_eye.w}},
      {"sample_time_s", eye.sample ? Json(eye.sample->time_s) : Json(nullptr)},
      {"state", std::string(nameOf(eye.state))},
      {"gaze_px", jsonOf(record.gaze_px)},
      {"fixation_px", jsonOf(record.fixation_px)},
      {"image_px", points},
      {"surface_distance_m", jsonOf(eye.surface_distance_m)},
      {"vergence_D", eye.vergence ? Json(eye.vergence->value_D) : Json(nullptr)},
      {"vergence_error_D", eye.vergence ? Json(eye.vergence->error_D) : Json(nullptr)},
      {"target_D", jsonOf(eye.target_D)},
      {"focus_D", eye.focus_D},
      {"pupil_mm", record.pupil_mm},
      {"method", record.method},
      {"splats", record.stats.splats},
      {"fragments", record.stats.fragments},
      {"tolerance_error", jsonOf(record.stats.tolerance_error)},
      {"tolerance_met",
       record.stats.tolerance_met ? Json(*record.stats.tolerance_met) : Json(nullptr)},
      {"quality_level",
       record.stats.quality_level ? Json(textOf(*record.stats.quality_level)) : Json(nullptr)},
      {"render_ms", record.stats.ms},
      {"rendered", record.rendered},
      {"marker", frame.seen.marker},
  };
  if (!frame.image.empty()) {
    json["image"] = frame.image;
    json["sha256"] = frame.sha256;
  }
  if (!frame.maps_sha256.empty()) json["maps_sha256"] = frame.maps_sha256;
  return json;
}

PartFrame partFrameOf(const Json& json) {
  PartFrame frame;
  FrameRecord& record = frame.seen.record;
  EyeNow& eye = record.eye;
  record.time_s = eye.time_s = json.at("time_s").get<double>();
  if (const auto time_s = numberOf(json.at("sample_time_s"))) {
    eye.sample = GazeSample{.time_s = *time_s};
  }
  eye.state = stateNamed(json.at("state").get<std::string>());
  record.gaze_px = pointOf(json.at("gaze_px"));
  record.fixation_px = pointOf(json.at("fixation_px"));
  for (const Json& point : json.at("image_px")) frame.seen.gaze_px.push_back(vectorOf(point));
  const Json& at = json.at("eye_m");
  record.eye_m = {at.at(0).get<double>(), at.at(1).get<double>(), at.at(2).get<double>()};
  const Json& turn = json.at("world_from_eye_xyzw");
  record.world_from_eye = {turn.at(3).get<double>(), turn.at(0).get<double>(),
                           turn.at(1).get<double>(), turn.at(2).get<double>()};
  eye.surface_distance_m = numberOf(json.at("surface_distance_m"));
  if (const auto vergence_D = numberOf(json.at("vergence_D"))) {
    eye.vergence = {.value_D = *vergence_D, .error_D = json.at("vergence_error_D").get<double>()};
  }
  eye.target_D = numberOf(json.at("target_D"));
  eye.focus_D = json.at("focus_D").get<double>();
  record.pupil_mm = json.at("pupil_mm").get<double>();
  record.method = json.at("method").get<std::string>();
  record.stats.splats = json.at("splats").get<std::uint64_t>();
  record.stats.fragments = json.at("fragments").get<std::uint64_t>();
  record.stats.tolerance_error = numberOf(json.at("tolerance_error"));
  if (const Json& met = json.at("tolerance_met"); !met.is_null()) {
    record.stats.tolerance_met = met.get<bool>();
  }
  if (const Json& level = json.at("quality_level"); !level.is_null()) {
    record.stats.quality_level = qualityLevelFrom(level.get<std::string>());
  }
  record.stats.ms = json.at("render_ms").get<double>();
  record.rendered = json.at("rendered").get<bool>();
  frame.seen.marker = json.at("marker").get<bool>();
  frame.image = json.value("image", "");
  frame.sha256 = json.value("sha256", "");
  frame.maps_sha256 = json.value("maps_sha256", std::vector<std::string>());
  return frame;
}

}  // namespace foci
