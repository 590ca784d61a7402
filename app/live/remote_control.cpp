#include "app/live/remote_control.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <ctime>

#include "app/platform/json_text.h"
#include "app/study/session_settings_of.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr auto kPatience = std::chrono::seconds(10);  // a method may take seconds to be made

std::string answerOf(std::future<std::string> done) {
  try {
    if (done.wait_for(kPatience) != std::future_status::ready) return "error no answer yet";
    const std::string error = done.get();
    return error.empty() ? "ok" : "error " + error;
  } catch (const std::future_error&) {
    return "error foci is leaving";
  }
}

std::string stateOf(const LiveState& state, double now_s) {
  const FrameRecord& last = state.last;
  nlohmann::ordered_json json = {{"now_s", now_s},
                                 {"frame_s", last.time_s},
                                 {"gaze_state", nameOf(last.eye.state)},
                                 {"gaze_px", last.gaze_px},
                                 {"surface_distance_m", last.eye.surface_distance_m},
                                 {"focus_D", last.eye.focus_D},
                                 {"pupil_mm", last.pupil_mm},
                                 {"method", last.method},
                                 {"gaze_remark", nullptr},
                                 {"clock", nullptr},
                                 {"record", nullptr},
                                 {"record_failure", nullptr}};
  for (const std::string& text : {state.reception.doubt, state.reception.remark}) {
    if (!text.empty()) json["gaze_remark"] = text;
  }
  if (const auto& clock = state.reception.clock) {
    json["clock"] = {
        {"offset_s", clock->offset_s}, {"drift_ppm", clock->drift_ppm}, {"steps", clock->steps}};
  }
  if (state.record) {
    json["record"] = state.record->folder().string();
    json["record_failure"] = state.record->failure();
  }
  if (state.playing) {
    json["recording_s"] = state.playing->recording_s;
    json["speed"] = state.playing->plays ? state.playing->speed : 0.0;
  }
  return jsonText(json);
}

}  // namespace

std::filesystem::path unusedName(const std::string& extension) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  std::array<char, 40> text;
  const std::string stem(text.data(),
                         std::strftime(text.data(), text.size(), "foci-%Y%m%d-%H%M%S", &local));
  std::filesystem::path path = stem + extension;
  for (int i = 2; std::filesystem::exists(path); ++i) {
    path = stem;
    path += "-" + std::to_string(i) + extension;
  }
  return path;
}

std::string answerTo(const std::string& command, LiveRenderer& renderer) {
  const std::size_t space = std::min(command.find(' '), command.size());
  const std::string verb = command.substr(0, space);
  const std::string rest(trimmed(std::string_view(command).substr(space)));
  if (verb == "mark" && !rest.empty()) return "ok " + decimal(renderer.addMarker(rest), 6);
  if (verb == "stop") return answerOf(renderer.stopRecord());
  if (verb == "state") return "ok " + stateOf(renderer.state(), renderer.now_s());
  if (verb == "record") {
    // A command from the network must not choose a path.
    const bool is_plain_name = std::ranges::all_of(
        rest, [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; });
    if (!is_plain_name) return "error record NAME: expected letters, digits, - and _";
    return answerOf(
        renderer.startRecord(rest.empty() ? unusedName("") : std::filesystem::path(rest)));
  }
  if (verb == "set") {
    const std::size_t key_end = rest.find(' ');
    if (key_end == std::string::npos) return "error set KEY VALUE: expected a value";
    const std::string key = rest.substr(0, key_end);
    const std::string toml(trimmed(std::string_view(rest).substr(key_end)));
    try {
      return answerOf(renderer.change(key, remoteValue(renderer.state().study, key, toml)));
    } catch (const InputError& error) {
      return std::string("error ") + error.what();
    }
  }
  if (verb == "mark") return "error mark: expected mark TEXT";
  if (verb == "gaze") return "error gaze: expected gaze TIME X Y [PUPIL]";
  return "error " + shown(command) + ": expected gaze, mark, record, stop, set, state or leave";
}

}  // namespace foci
