#include "app/replay/part.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/platform/json_text.h"
#include "app/platform/progress.h"
#include "app/platform/sha256.h"
#include "app/platform/version.h"
#include "app/replay/replay_inputs.h"
#include "app/study/inputs.h"
#include "app/study/load_scene.h"
#include "app/study/session_settings_of.h"
#include "app/study/study_text.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
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

/// Calls `field` with the name and the value of what part.json states of a part.
template <class SomePart, class Field>
void eachFieldOfPart(SomePart& part, const Field& field) {
  field("version", part.version);
  field("first", part.span.first);
  field("end", part.span.end);
  field("frames", part.frames);
  field("study", part.study_file);
  field("screen_is_default", part.screen_is_default);
  field("configuration", part.configuration);
  field("threads", part.threads);
  field("device", part.device);
  field("warnings", part.warnings);
  field("study_sha256", part.study_sha256);
}

/// The same of a frame.
template <class SomeFrame, class Field>
void eachFieldOfFrame(SomeFrame& frame, const Field& field) {
  auto& record = frame.seen.record;
  field("time_s", record.time_s);
  field("eye_m", record.eye_m);
  field("gaze_px", record.gaze_px);
  field("fixation_px", record.fixation_px);
  field("image_px", frame.seen.gaze_px);
  field("surface_distance_m", record.eye.surface_distance_m);
  field("target_D", record.eye.target_D);
  field("focus_D", record.eye.focus_D);
  field("pupil_mm", record.pupil_mm);
  field("method", record.method);
  field("splats", record.stats.splats);
  field("fragments", record.stats.fragments);
  field("tolerance_error", record.stats.tolerance_error);
  field("tolerance_met", record.stats.tolerance_met);
  field("render_ms", record.stats.ms);
  field("rendered", record.rendered);
  field("marker", frame.seen.marker);
  field("image", frame.image);
  field("sha256", frame.sha256);
  field("maps_sha256", frame.maps_sha256);
}

Json jsonOf(const PartFrame& frame) {
  Json json;
  eachFieldOfFrame(frame, [&](const char* name, const auto& value) { json[name] = value; });
  const FrameRecord& record = frame.seen.record;
  const EyeNow& eye = record.eye;
  const glm::dquat& turn = record.world_from_eye;
  json["world_from_eye_xyzw"] = glm::dvec4(turn.x, turn.y, turn.z, turn.w);
  json["state"] = nameOf(eye.state);
  if (eye.sample) json["sample_time_s"] = eye.sample->time_s;
  if (eye.vergence) json["vergence_D"] = glm::dvec2(eye.vergence->value_D, eye.vergence->error_D);
  if (const auto& level = record.stats.quality_level) json["quality_level"] = textOf(*level);
  return json;
}

PartFrame partFrameOf(const Json& json) {
  PartFrame frame;
  eachFieldOfFrame(frame, [&](const char* name, auto& value) { json.at(name).get_to(value); });
  FrameRecord& record = frame.seen.record;
  EyeNow& eye = record.eye;
  eye.time_s = record.time_s;
  const auto turn = json.at("world_from_eye_xyzw").get<glm::dvec4>();
  record.world_from_eye = {turn.w, turn.x, turn.y, turn.z};
  eye.state = stateNamed(json.at("state").get<std::string>()).value();
  if (json.contains("sample_time_s")) eye.sample = GazeSample{.time_s = json["sample_time_s"]};
  if (json.contains("vergence_D")) {
    const auto vergence = json["vergence_D"].get<glm::dvec2>();
    eye.vergence = {.value_D = vergence.x, .error_D = vergence.y};
  }
  if (json.contains("quality_level")) {
    record.stats.quality_level = qualityLevelFrom(json["quality_level"].get<std::string>());
  }
  return frame;
}

Json jsonOf(const Part& part) {
  Json json = {{"program", "foci"}};
  eachFieldOfPart(part, [&](const char* name, const auto& value) { json[name] = value; });
  json["inputs"] = Json::array();
  for (const InputFile& input : part.inputs) {
    json["inputs"].push_back({{"path", input.path.string()},
                              {"absolute", std::filesystem::absolute(input.path).string()},
                              {"sha256", input.sha256}});
  }
  json["frames_seen"] = Json::array();
  for (const PartFrame& frame : part.all) json["frames_seen"].push_back(jsonOf(frame));
  return json;
}

/// The frames asked for that the run has.
FrameSpan within(const FramesAsked& asked, std::size_t frames) {
  const auto& [span, part, parts] = asked;
  if (parts > 0) {
    if (parts > frames) {
      throw InputError("--frames " + std::to_string(part) + "/" + std::to_string(parts),
                       "the run has " + counted(frames, "frame") + ": fewer than parts");
    }
    return {(part - 1) * frames / parts, part * frames / parts};
  }
  if (span.first >= frames) {
    throw InputError("--frames " + spanText(span),
                     "the run has frames 0 to " + std::to_string(frames - 1));
  }
  return {span.first, std::min(span.end, frames)};
}

std::string_view bytesOf(const Image& image) {
  return {reinterpret_cast<const char*>(image.rgb.data()), image.rgb.size()};
}

/// Renders the frames of the span, and stages each new image.
std::vector<PartFrame> renderSpan(ReplayedEye& eye, const FrameSpan& span, OutputFolder& folder) {
  std::vector<PartFrame> frames;
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
      frame.image = imageFileName(i);
      frame.sha256 = sha256Of(bytesOf(image));
      folder.write(frame.image, pngOf(image));
    }
    for (const auto& map :
         stageMaps(eye.study().output.maps, i, seen, frame.seen.record.eye.focus_D, folder)) {
      frame.maps_sha256.push_back(sha256OfFile(map));
    }
    frames.push_back(std::move(frame));
    progress.advance(i + 1);
  }
  return frames;
}

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30;  // of a file of a part

[[noreturn]] void refuseAltered(const std::filesystem::path& file, const std::string& what) {
  throw InputError(file.string(),
                   "is not the " + what + " that the part rendered; render the part again");
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
  Part part{.version = versionText(),
            .configuration = configurationOf(study),
            .study_sha256 = sha256Of(portable),
            .span = own,
            .frames = gaze.schedule.frames,
            .screen_is_default = study.screen.is_default,
            .study_file = study.file.string(),
            .threads = threads,
            .all = renderSpan(eye, own, folder)};
  eye.addRemark();
  part.device = eye.session().devices();
  part.inputs = hashes.get();
  part.warnings = rendering.all();
  Json json = jsonOf(part);
  json["sha256"] = sha256Of(jsonText(json));
  folder.write(kStudy, portable);
  folder.write(kPart, jsonText(json) + "\n");
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
    part.version = json.at("version").get<std::string>();
    const std::string sha256 = json.at("sha256").get<std::string>();
    json.erase("sha256");
    altered = sha256Of(jsonText(json)) != sha256;
    eachFieldOfPart(part, [&](const char* name, auto& value) { json.at(name).get_to(value); });
    for (const Json& input : json.at("inputs")) {
      part.inputs.push_back(
          {input.at("path").get<std::string>(), input.at("sha256").get<std::string>()});
      part.input_places.emplace_back(input.at("absolute").get<std::string>());
    }
    for (const Json& frame : json.at("frames_seen")) part.all.push_back(partFrameOf(frame));
    const Json configuration = Json::parse(part.configuration);
    for (const char* key : kFileKeys) static_cast<void>(configuration.at(key));
  } catch (const std::exception&) {
    throw InputError(file.string(), "expected what foci replay --frames wrote" +
                                        (part.version.empty() || part.version == versionText()
                                             ? ""
                                             : ", but rendered by foci " + part.version));
  }
  if (altered) refuseAltered(file, "list of frames");
  const auto bad = [](const PartFrame& frame) {
    return std::filesystem::path(frame.image).filename() != frame.image;
  };
  if (part.span.first >= part.span.end || part.span.end > part.frames ||
      part.all.size() != part.span.end - part.span.first || part.all.front().image.empty() ||
      std::ranges::any_of(part.all, bad)) {
    throw InputError(file.string(), "expected what foci replay --frames wrote");
  }
  return part;
}

Study studyOf(const Part& part) {
  const std::filesystem::path file = part.folder / kStudy;
  if (sha256Of(bytesOfFile(file, kMostBytes)) != part.study_sha256) refuseAltered(file, "study");
  Study study = readStudy(file);
  study.file = part.study_file;
  study.screen.is_default = part.screen_is_default;
  return study;
}

namespace {

/// The same with the names that the run was given, for the manifest. From another folder they lead
/// nowhere.
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

/// @param size_px  of the run's images
/// @throws InputError if the file is missing or holds another image than the part rendered
Image imageOf(const Part& part, const PartFrame& frame, const glm::ivec2& size_px) {
  const std::filesystem::path file = part.folder / frame.image;
  Image image = imageOfPng(bytesOfFile(file, kMostBytes), size_px);
  if (sha256Of(bytesOf(image)) != frame.sha256) refuseAltered(file, "image");
  return image;
}

/// The bytes of the files of the maps of the part's `i`-th frame.
/// @param maps  of the study
/// @throws InputError as `imageOf`
std::vector<std::string> mapsOf(const Part& part, std::size_t i,
                                const std::vector<FrameMap>& maps) {
  std::vector<std::string> files;
  files.reserve(maps.size());
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const std::filesystem::path file = part.folder / mapFileName(maps[k], part.span.first + i);
    files.push_back(bytesOfFile(file, kMostBytes));
    const std::vector<std::string>& written = part.all[i].maps_sha256;
    if (k >= written.size() || sha256Of(files.back()) != written[k]) refuseAltered(file, "map");
  }
  return files;
}

/// @throws InputError unless `part` belongs to the same run as `first`
void requireSameRun(const Part& first, const Part& part) {
  const std::string both = first.folder.string() + " and " + part.folder.string();
  if (part.version != first.version) {
    throw InputError(both, "rendered by foci " + first.version + " and " + part.version +
                               "; expected one version");
  }
  if (part.configuration != first.configuration || part.frames != first.frames) {
    throw InputError(both, "have different studies; expected parts of one run");
  }
  if (!std::ranges::equal(first.inputs, part.inputs, {}, &InputFile::sha256, &InputFile::sha256)) {
    throw InputError(both, "have input files with different contents; expected parts of one run");
  }
}

std::string framesText(std::size_t first, std::size_t end) {
  return std::to_string(first) + ":" + std::to_string(end);
}

/// The devices of the parts, each once.
std::string devicesOf(const std::vector<Part>& parts, Warnings& warnings) {
  std::vector<std::string> devices;
  for (const Part& part : parts) {
    if (std::ranges::find(devices, part.device) == devices.end()) devices.push_back(part.device);
  }
  std::string text = listed(devices, "; ");
  if (devices.size() > 1) {
    warnings.add("the parts were rendered on " + text + ": they may differ in rounding");
  }
  return text;
}

/// Compares hashes. The part's own study.toml replaces two inputs: the run's study and the file of
/// its monitor. Neither needs to be as it was.
/// @throws InputError unless the parts were rendered from the files that the join reads
void requireSameFiles(const Part& part, const Study& study, const Study& stated) {
  for (std::size_t i = 0; i < part.inputs.size(); ++i) {
    const auto& [path, sha256] = part.inputs[i];
    const std::filesystem::path& place = part.input_places[i];
    const bool replaced = path == part.study_file || path == stated.screen.monitor;
    if (replaced && place != study.scene.file) continue;
    if (FileToHash(place).sha256() == sha256) continue;
    throw InputError(path.string(),
                     "is not the file that the parts were rendered from; render the parts again");
  }
}

/// Times on the recording's clock tell whether the recording is still the one that was rendered.
void requireSameTimes(const Part& part, const Schedule& schedule) {
  for (std::size_t i = 0; i < part.all.size(); ++i) {
    const std::size_t frame = part.span.first + i;
    if (frame < schedule.frames && part.all[i].seen.record.time_s == schedule.time_s(frame))
      continue;
    throw InputError(part.folder.string(),
                     "has other times than the recording; render the part again");
  }
}

}  // namespace

std::vector<Part> inOrder(std::vector<Part> parts) {
  std::ranges::sort(parts, {}, [](const Part& part) { return part.span.first; });
  std::size_t next = 0;
  for (const Part& part : parts) {
    requireSameRun(parts.front(), part);
    if (part.span.first > next) {
      throw InputError("frames " + framesText(next, part.span.first), "are in none of the parts");
    }
    if (part.span.first < next) {
      throw InputError(part.folder.string(),
                       "frames " + framesText(part.span.first, std::min(next, part.span.end)) +
                           " are in another part, too");
    }
    next = part.span.end;
  }
  if (next < parts.front().frames) {
    throw InputError("frames " + framesText(next, parts.front().frames),
                     "are in none of the parts");
  }
  return parts;
}

RunResult join(const std::vector<Part>& parts, const Study& study, const std::filesystem::path& out,
               const std::string& command, const OutputGuard& guard) {
  Study stated = statedStudyOf(parts.front());
  requireSameFiles(parts.front(), study, stated);
  Warnings warnings;
  const ReplayedGaze gaze = readReplayedGaze(study, warnings);
  stated = withRecordedHead(stated, gaze.trace);
  stated.output.fps = gaze.study.output.fps;
  for (const Part& part : parts) requireSameTimes(part, gaze.schedule);
  const Scene scene = loadScene(gaze.study, warnings);
  warnings.add(eyeRemark(gaze.study));
  RunWriter writer(stated, gaze, scene, out, guard, warnings);
  sayAssumptions(gaze.study, gaze.trace);
  Progress progress("joining", "frames", gaze.schedule.frames);
  ManifestFacts facts{.command = command,
                      .threads = parts.front().threads,
                      .device = devicesOf(parts, warnings),
                      .gaze = {},
                      .inputs = parts.front().inputs};
  std::size_t frame = 0;
  Image image;
  for (const Part& part : parts) {
    for (const std::string& warning : part.warnings) warnings.add(warning);
    for (std::size_t i = 0; i < part.all.size(); ++i) {
      if (!part.all[i].image.empty()) image = imageOf(part, part.all[i], stated.imageSize_px());
      writer.add(frame, part.all[i].seen, image);
      const std::vector<FrameMap>& maps = stated.output.maps;
      const std::vector<std::string> files = mapsOf(part, i, maps);
      for (std::size_t k = 0; k < maps.size(); ++k) writer.addMap(maps[k], frame, files[k]);
      ++frame;
      progress.advance(frame);
    }
  }
  return writer.finish(facts);
}

}  // namespace foci
