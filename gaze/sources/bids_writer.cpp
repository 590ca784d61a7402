#include "gaze/sources/bids.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::string_view kTable = "_physio.tsv.gz";
constexpr const char* kNominalText =
    "The recording states no screen: StimulusPresentation is a nominal screen of foci, which "
    "keeps the recording's own degrees or fractions";

std::string textOf(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

void append(std::string& text, const std::optional<double>& value, int digits) {
  text += '\t';
  text += value ? decimal(*value, digits) : "n/a";
}

const BidsContents::Values& valuesOf(const BidsContents& contents,
                                     std::optional<std::size_t> side) {
  return side ? contents.eyes[*side] : contents.both;
}

void count(BidsContents::Values& values, bool point, const std::optional<double>& mm,
           const std::optional<double>& own) {
  values.points += point;
  values.pupils_mm += mm.has_value();
  values.pupils_own += own.has_value();
}

}  // namespace

PackedOutput::PackedOutput(const fs::path& file)
    : name_(file.string()), file_(gzopen(name_.c_str(), "wb"), gzclose) {
  if (!file_) throw std::runtime_error("cannot write " + name_);
}

void PackedOutput::write(const std::string& text) {
  if (text.empty()) return;
  failed_ |= gzwrite(file_.get(), text.data(), static_cast<unsigned>(text.size())) <= 0;
}

void PackedOutput::close() {
  const bool closed = gzclose(file_.release()) == Z_OK;
  if (!closed || failed_) throw std::runtime_error("cannot write " + name_);
}

void BidsContents::add(const GazeSample& sample) {
  count(both, sample.point_px.has_value(), sample.pupil_mm, sample.pupil_own);
  for (const std::size_t side : {0, 1}) {
    const EyeSample& eye = sample.eyes[side];
    count(eyes[side], eye.point_px.has_value(), eye.pupil_mm, eye.pupil_own);
  }
  blinks += sample.blink;
}

std::vector<std::optional<std::size_t>> BidsContents::recordings() const {
  std::vector<std::optional<std::size_t>> sides;
  for (const std::size_t side : {0, 1}) {
    if (eyes[side].points > 0) sides.emplace_back(side);
  }
  if (sides.empty()) sides.emplace_back(std::nullopt);
  return sides;
}

BidsNames::BidsNames(const fs::path& out) : folder_(out.parent_path()) {
  const std::string name = out.filename().string();
  if (!name.ends_with(kTable)) {
    throw InputError(out.string(), "expected a name that ends in _physio.tsv.gz");
  }
  stem_ = name.substr(0, name.size() - kTable.size());
  const std::size_t label = stem_.find("_recording-");
  if (label != stem_.npos) stem_.erase(label, stem_.find('_', label + 1) - label);
}

fs::path BidsNames::ofEye(std::optional<std::size_t> side, const std::string& suffix) const {
  return folder_ / (stem_ + "_recording-eye" + (side == 1 ? "2" : "1") + "_" + suffix);
}

fs::path BidsNames::ofTask(const std::string& suffix) const {
  return folder_ / (stem_ + "_" + suffix);
}

BidsTable::BidsTable(const fs::path& file, const BidsContents& contents,
                     std::optional<std::size_t> side)
    : file_(file),
      side_(side),
      pupils_mm_(valuesOf(contents, side).pupils_mm > 0),
      pupils_own_(!pupils_mm_ && valuesOf(contents, side).pupils_own > 0),
      blinks_(contents.blinks > 0) {}

void BidsTable::add(const GazeSample& sample) {
  constexpr std::size_t kBlock = 1 << 16;
  const EyeSample* eye = side_ ? &sample.eyes[*side_] : nullptr;
  const auto& point_px = eye ? eye->point_px : sample.point_px;
  text_ += decimal(sample.time_s, 6);
  append(text_, point_px ? std::optional(point_px->x) : std::nullopt, 3);
  append(text_, point_px ? std::optional(point_px->y) : std::nullopt, 3);
  if (pupils_mm_) append(text_, eye ? eye->pupil_mm : sample.pupil_mm, 4);
  if (pupils_own_) append(text_, eye ? eye->pupil_own : sample.pupil_own, 4);
  if (blinks_) text_ += sample.blink ? "\t1" : "\t0";
  text_ += '\n';
  if (text_.size() <= kBlock) return;
  file_.write(text_);
  text_.clear();
}

void BidsTable::finish() {
  file_.write(text_);
  file_.close();
}

std::string bidsPhysioJson(const TraceHeader& header, const BidsContents& contents,
                           std::optional<std::size_t> side, double rate_Hz) {
  const auto& values = valuesOf(contents, side);
  Json json = {{"PhysioType", "eyetrack"},
               {"SamplingFrequency", rate_Hz},
               {"StartTime", 0},
               {"RecordedEye", !side        ? "cyclopean"
                               : *side == 0 ? "left"
                                            : "right"},
               {"SampleCoordinateSystem", "gaze-on-screen"},
               {"Columns", {"timestamp", "x_coordinate", "y_coordinate"}},
               {"timestamp", {{"Description", "The recording's own clock"}, {"Units", "s"}}}};
  for (const char* axis : {"x_coordinate", "y_coordinate"}) {
    json[axis] = {{"Units", "pixel"}};
    if (header.nominal_screen) json[axis]["Description"] = kNominalText;
  }
  if (values.pupils_mm > 0) {
    json["Columns"].push_back("pupil_size");
    json["pupil_size"] = {{"Description", "Diameter"}, {"Units", "mm"}};
  } else if (values.pupils_own > 0) {
    const std::string unit = header.pupil_unit.empty() ? "arbitrary" : header.pupil_unit;
    json["Columns"].push_back("pupil_size");
    json["pupil_size"] = {{"Description", "As the tracker gives it"}, {"Units", unit}};
  }
  if (contents.blinks > 0) {
    json["Columns"].push_back("blink");
    json["blink"] = {{"Description", "Whether the tracker reports a blink"},
                     {"Levels", {{"0", "no blink"}, {"1", "a blink"}}}};
  }
  json["Description"] = "Converted by foci from " + header.format;
  if (!header.assumed.empty()) json["FociAssumed"] = header.assumed;
  return textOf(json);
}

std::string bidsEventsJson(const Screen& screen) {
  Json stimulus = {{"ScreenOrigin", {"top", "left"}}};
  if (screen.size_px.x > 0) stimulus["ScreenResolution"] = {screen.size_px.x, screen.size_px.y};
  if (screen.size_m.x > 0.0) stimulus["ScreenSize"] = {screen.size_m.x, screen.size_m.y};
  if (screen.distance_m > 0.0) stimulus["ScreenDistance"] = screen.distance_m;
  return textOf({{"StimulusPresentation", stimulus}});
}

bool statesScreen(const fs::path& events_json, const Screen& screen) {
  constexpr double kRounding_m = 1e-6;
  BidsMetadata metadata;
  std::ifstream in(events_json);
  const Json json = Json::parse(in, nullptr, false);
  const auto stimulus = json.is_object() ? json.find("StimulusPresentation") : json.end();
  if (!json.is_object() || stimulus == json.end()) return false;
  metadata.stimulus = *stimulus;
  const Screen stated = metadata.screen();
  return (screen.size_px.x <= 0 || stated.size_px == screen.size_px) &&
         (screen.size_m.x <= 0.0 || glm::distance(stated.size_m, screen.size_m) < kRounding_m) &&
         (screen.distance_m <= 0.0 ||
          std::abs(stated.distance_m - screen.distance_m) < kRounding_m);
}

std::string bidsMessages(const std::vector<TraceMarker>& markers) {
  std::string table;
  for (const TraceMarker& marker : markers) {
    std::string text = marker.text;
    std::ranges::replace_if(
        text, [](unsigned char c) { return c < 0x20; }, ' ');
    table += decimal(marker.time_s, 6) + "\t0\t" + text + '\n';
  }
  return table;
}

std::string bidsTableJson(const std::string& column, const std::string& description,
                          const std::string& meaning) {
  return textOf({{"Columns", {"onset", "duration", column}},
                 {"Description", description},
                 {"OnsetSource", "timestamp"},
                 {column, {{"Description", meaning}}}});
}

std::string bidsMessagesJson() {
  return bidsTableJson("message", "Messages of the recording", "Text of an event marker");
}

void writePacked(const fs::path& file, const std::string& text) {
  PackedOutput packed(file);
  packed.write(text);
  packed.close();
}

}  // namespace foci
