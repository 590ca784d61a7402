#include "app/replay/part.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <utility>

#include "app/graphics/image.h"
#include "app/platform/json_text.h"
#include "app/platform/progress.h"
#include "app/platform/sha256.h"
#include "app/platform/version.h"
#include "app/replay/frame_maps.h"
#include "app/replay/replayed_eye.h"
#include "app/replay/run_writer.h"
#include "app/study/study_text.h"
#include "base/file.h"
#include "base/input_error.h"
#include "gaze/webcam/webcam_frames.h"

namespace foci {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char *kPart = "part.json", *kStudy = "study.toml";

/// The keys that name files.
constexpr const char* kFileKeys[] = {"scene.file",     "scene.part",         "screen.monitor",
                                     "screen.spectra", "observer.wavefront", "gaze.source",
                                     "gaze.map",       "gaze.camera",        "record.frames",
                                     "record.changes", "record.markers"};

std::string spanText(const FrameSpan& span) {
  const bool open = span.end == std::numeric_limits<std::size_t>::max();
  return std::to_string(span.first) + ":" + (open ? "" : std::to_string(span.end));
}

/// The configuration without what may differ between the parts of a run.
std::string configurationOf(const Study& study) {
  Json all = Json::object();
  for (const ResolvedKey& key : resolvedKeys(study)) {
    all[std::string(key.name)] = Json::parse(key.json, nullptr, false);
  }
  return jsonText(all);
}

/// A study that reads back in any folder.
std::string portableToml(const Study& study) {
  Study moved = study;
  for (auto* path : {&moved.record.frames, &moved.record.changes, &moved.record.markers}) {
    if (*path) **path = std::filesystem::absolute(**path);
  }
  std::error_code ignored;
  const auto place = webcamPlaceOf(moved.gaze.source);
  const std::filesystem::path file = place ? place->file : std::filesystem::path(moved.gaze.source);
  if (std::filesystem::exists(file, ignored)) {
    moved.gaze.source = (place ? "webcam:" : "") + std::filesystem::absolute(file).string();
  }
  return studyToml(moved);
}

Json headOf(const Study& study, const FrameSpan& span, std::size_t frames, unsigned threads,
            const std::string& device, const std::vector<InputFile>& files) {
  Json inputs = Json::array();
  for (const InputFile& input : files) {
    inputs.push_back({{"path", input.path.string()},
                      {"absolute", std::filesystem::absolute(input.path).string()},
                      {"sha256", input.sha256}});
  }
  return {{"program", "foci"},
          {"version", versionText()},
          {"first", span.first},
          {"end", span.end},
          {"frames", frames},
          {"study", study.file.string()},
          {"screen_is_default", study.screen.is_default},
          {"configuration", configurationOf(study)},
          {"threads", threads},
          {"device", device},
          {"inputs", inputs}};
}

/// The frames asked for that the run has.
FrameSpan within(const FramesAsked& asked, std::size_t frames) {
  const auto& [span, part, parts] = asked;
  if (parts > 0) {
    if (parts > frames) {
      throw InputError("--frames " + std::to_string(part) + "/" + std::to_string(parts),
                       "the run has " + std::to_string(frames) + " frames: fewer than parts");
    }
    return {(part - 1) * frames / parts, part * frames / parts};
  }
  if (span.first >= frames) {
    throw InputError("--frames " + spanText(span),
                     "the run has frames 0 to " + std::to_string(frames - 1));
  }
  return {span.first, std::min(span.end, frames)};
}

/// Renders the frames of the span, and stages each new image.
Json renderSpan(ReplayedEye& eye, const FrameSpan& span, OutputFolder& folder) {
  Json frames = Json::array();
  Progress progress("rendering", "frames", span.end);
  for (std::size_t i = 0; i < span.end; ++i) {
    if (i < span.first) {
      eye.pass(i);
      continue;
    }
    PartFrame frame;
    const Frame& seen = eye.see(i, frame.seen);
    eye.requireParts(i);
    if (frame.seen.record.rendered || i == span.first) {
      const Image image = imageOf(seen, eye.study().screen.gamma);
      const auto png = pngOf(image);
      frame.image = imageFileName(i);
      Sha256 hash;
      hash.add(image.rgb);
      frame.sha256 = hash.hex();
      folder.write(frame.image, {png.begin(), png.end()});
    }
    for (const auto& map :
         stageMaps(eye.study().output.maps, i, seen, frame.seen.record.eye.focus_D, folder)) {
      frame.maps_sha256.push_back(sha256OfFile(map));
    }
    frames.push_back(jsonOf(frame));
    progress.advance(i + 1);
  }
  return frames;
}

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30;  // of a file of a part

std::string hashOf(const std::string& text) {
  Sha256 hash;
  hash.add({reinterpret_cast<const unsigned char*>(text.data()), text.size()});
  return hash.hex();
}

[[noreturn]] void refuseAltered(const std::filesystem::path& file, const std::string& what) {
  throw InputError(file.string(),
                   "is not the " + what + " that the part rendered; render the part again");
}

/// @throws InputError unless the bytes are those that the part wrote
void requireOwn(const std::filesystem::path& file, std::span<const unsigned char> bytes,
                const std::string& sha256, const std::string& what) {
  Sha256 hash;
  hash.add(bytes);
  if (hash.hex() == sha256) return;
  refuseAltered(file, what);
}

}  // namespace

std::vector<std::filesystem::path> partFiles(const std::filesystem::path& out) {
  std::vector<std::filesystem::path> files = imagesIn(out);
  files.push_back(out / kPart);
  files.push_back(out / kStudy);
  return files;
}

FrameSpan replayPart(const Study& study, const FramesAsked& asked, const std::filesystem::path& out,
                     unsigned threads, ReplayedScene& scene, const OutputGuard& guard) {
  Warnings of_inputs, rendering;
  const ReplayedGaze gaze = readReplayedGaze(study, of_inputs);
  const FrameSpan own = within(asked, gaze.schedule.frames);
  const std::string portable = portableToml(study);  // before the work, since it can be refused
  ReplayedEye eye(gaze.study, gaze, scene.of(gaze.study, of_inputs), rendering);
  InputHashes hashes(study, scene.hashed);
  OutputFolder folder(out, guard);
  sayAssumptions(gaze.study, gaze.trace);
  eye.sayDevice();
  Json frames = renderSpan(eye, own, folder);
  eye.addRemark();
  Json part =
      headOf(study, own, gaze.schedule.frames, threads, eye.session().devices(), hashes.get());
  part["warnings"] = rendering.all();
  part["frames_seen"] = std::move(frames);
  part["study_sha256"] = hashOf(portable);
  part["sha256"] = hashOf(jsonText(part));
  folder.write(kStudy, portable);
  folder.write(kPart, jsonText(part) + "\n");
  folder.commit();
  return own;
}

Part readPart(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kPart;
  const std::string text = bytesOfFile(file, kMostBytes);
  Part part;
  part.folder = folder;
  bool altered = false;
  try {
    Json json = Json::parse(text);
    const std::string sha256 = json.at("sha256").get<std::string>();
    json.erase("sha256");
    altered = hashOf(jsonText(json)) != sha256;
    part.study_sha256 = json.at("study_sha256").get<std::string>();
    part.version = json.at("version").get<std::string>();
    part.configuration = json.at("configuration").get<std::string>();
    part.span = {json.at("first").get<std::size_t>(), json.at("end").get<std::size_t>()};
    part.frames = json.at("frames").get<std::size_t>();
    part.screen_is_default = json.at("screen_is_default").get<bool>();
    part.study_file = json.at("study").get<std::string>();
    part.threads = json.at("threads").get<unsigned>();
    part.device = json.at("device").get<std::string>();
    part.warnings = json.at("warnings").get<std::vector<std::string>>();
    for (const Json& input : json.at("inputs")) {
      part.inputs.push_back(
          {input.at("path").get<std::string>(), input.at("sha256").get<std::string>()});
      part.input_places.emplace_back(input.at("absolute").get<std::string>());
    }
    for (const Json& frame : json.at("frames_seen")) part.all.push_back(partFrameOf(frame));
    const Json configuration = Json::parse(part.configuration);
    for (const char* key : kFileKeys) static_cast<void>(configuration.at(key));
  } catch (const std::exception&) {
    throw InputError(file.string(), "expected what foci replay --frames wrote");
  }
  if (altered) refuseAltered(file, "list of frames");
  const auto bad = [](const PartFrame& frame) {
    return std::filesystem::path(frame.image).filename() != frame.image;
  };
  if (part.span.first >= part.span.end || part.span.end > part.frames ||
      part.all.size() != part.span.end - part.span.first || part.all.front().image.empty() ||
      std::any_of(part.all.begin(), part.all.end(), bad)) {
    throw InputError(file.string(), "expected what foci replay --frames wrote");
  }
  return part;
}

Study studyOf(const Part& part) {
  const std::filesystem::path file = part.folder / kStudy;
  if (hashOf(bytesOfFile(file, kMostBytes)) != part.study_sha256) refuseAltered(file, "study");
  Study study = readStudy(file);
  study.file = part.study_file;
  study.screen.is_default = part.screen_is_default;
  return study;
}

Study statedStudyOf(const Part& part) {
  Study study = studyOf(part);
  const Json configuration = Json::parse(part.configuration);
  for (const char* key : kFileKeys) {
    const Json& value = configuration.at(key);
    const std::string file = part.folder / kPart;
    setKey(study, key, "null", file);
    if (value.is_null() || value.empty()) continue;
    setKey(study, key, tomlOfJson(value.dump()), file);
  }
  return study;
}

Image imageOf(const Part& part, const PartFrame& frame, const glm::ivec2& size_px) {
  const std::filesystem::path file = part.folder / frame.image;
  const std::string bytes = bytesOfFile(file, kMostBytes);
  Image image = imageOfPng({bytes.begin(), bytes.end()}, size_px);
  requireOwn(file, image.rgb, frame.sha256, "image");
  return image;
}

std::vector<std::string> mapsOf(const Part& part, std::size_t i,
                                const std::vector<FrameMap>& maps) {
  std::vector<std::string> files;
  files.reserve(maps.size());
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const std::filesystem::path file = part.folder / mapFileName(maps[k], part.span.first + i);
    files.push_back(bytesOfFile(file, kMostBytes));
    const auto* const bytes = reinterpret_cast<const unsigned char*>(files.back().data());
    requireOwn(file, {bytes, files.back().size()},
               k < part.all[i].maps_sha256.size() ? part.all[i].maps_sha256[k] : "", "map");
  }
  return files;
}

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

GazeState stateOf(const Json& json) {
  const auto state = stateNamed(json.get<std::string>());
  if (!state) throw std::runtime_error("unknown gaze state");
  return *state;
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
  eye.state = stateOf(json.at("state"));
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
