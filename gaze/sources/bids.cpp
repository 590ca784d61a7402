// BIDS 1.10, physiological recordings with PhysioType "eyetrack".
#include "gaze/sources/bids.h"

#include <zlib.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "base/file.h"
#include "base/text.h"
#include "gaze/geometry/cyclopean.h"
#include "gaze/sources/read_rows.h"

namespace foci {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::string_view kPacked = "_physio.tsv.gz", kPlain = "_physio.tsv";

std::optional<fs::path> sidecarNameOf(const fs::path& file) {
  const std::string name = file.string();
  for (const std::string_view ending : {kPacked, kPlain}) {
    if (name.ends_with(ending)) {
      return name.substr(0, name.size() - ending.size()) + "_physio.json";
    }
  }
  return std::nullopt;
}

Json readJson(const fs::path& file) {
  std::error_code error;
  constexpr std::uintmax_t kMaxBytes = 1 << 20;  // a sidecar has a page or two
  if (fs::file_size(file, error) > kMaxBytes || error) {
    throw InputError(file.string(), "expected a JSON file of up to 1 MiB");
  }
  std::ifstream in(file);
  Json json = Json::parse(in, nullptr, false);
  if (!json.is_object()) throw InputError(file.string(), "expected a JSON object");
  return json;
}

/// The two numbers of a list; {0, 0} if there is no such list within the limits.
glm::dvec2 pairIn(const Json& json, const char* key, double low, double high) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array() || found->size() != 2) return glm::dvec2(0.0);
  glm::dvec2 result{0.0};
  for (int axis : {0, 1}) {
    const Json& value = (*found)[static_cast<std::size_t>(axis)];
    if (!value.is_number()) return glm::dvec2(0.0);
    result[axis] = value.get<double>();
    if (!(result[axis] >= low && result[axis] <= high)) return glm::dvec2(0.0);
  }
  return result;
}

Screen screenIn(const Json& json, Screen screen) {
  const auto stimulus = json.find("StimulusPresentation");
  if (stimulus == json.end() || !stimulus->is_object()) return screen;
  const glm::dvec2 pixels = pairIn(*stimulus, "ScreenResolution", 16, 16384);
  const glm::dvec2 metres = pairIn(*stimulus, "ScreenSize", 0.01, 20.0);
  if (pixels.x > 0.0) screen.size_px = glm::ivec2(pixels);
  if (metres.x > 0.0) screen.size_m = metres;
  const auto distance = stimulus->find("ScreenDistance");
  if (distance != stimulus->end() && distance->is_number()) {
    const double distance_m = distance->get<double>();
    if (distance_m >= 0.01 && distance_m <= 20.0) screen.distance_m = distance_m;
  }
  return screen;
}

/// The column's unit in the short form of `ColumnNames`; empty if the sidecar has none.
std::string unitOf(const Json& json, const std::string& column) {
  const auto entry = json.find(column);
  if (entry == json.end() || !entry->is_object()) return {};
  const auto units = entry->find("Units");
  if (units == entry->end() || !units->is_string()) return {};
  const std::string unit = units->get<std::string>();
  if (unit.starts_with("pixel")) return "px";
  if (unit.starts_with("degree")) return "deg";
  if (unit.starts_with("second")) return "s";
  if (unit.starts_with("millisecond")) return "ms";
  if (unit.starts_with("microsecond")) return "us";
  if (unit.starts_with("nanosecond")) return "ns";
  if (unit.starts_with("millimet")) return "mm";
  return unit.size() <= 16 ? unit : std::string();
}

/// Turns positions that count from the lower left corner of the screen. The study's own gaze.scale
/// and gaze.offset replace this.
/// @param header  names and units of the columns
/// @throws InputError for another origin than a left corner
TraceColumns fromUpperLeft(TraceColumns columns, const Json& json, const fs::path& sidecar,
                           const std::string& header, const Screen& screen) {
  const auto stimulus = json.find("StimulusPresentation");
  if (stimulus == json.end() || !stimulus->is_object()) return columns;
  const auto origin = stimulus->find("ScreenOrigin");
  const bool converts = columns.scale != glm::dvec2(1.0) || columns.offset != glm::dvec2(0.0);
  const bool degrees = columns.units.value_or(GazeUnits::px) == GazeUnits::deg ||
                       header.find(" [deg]") != header.npos;
  if (origin == stimulus->end() || converts || degrees || columns.mapped_later) return columns;
  const auto has = [&](const char* word) {
    return origin->is_array() && origin->size() == 2 &&
           std::find(origin->begin(), origin->end(), Json(word)) != origin->end();
  };
  if (has("top") && has("left")) return columns;
  if (!has("bottom") || !has("left")) {
    throw InputError(sidecar.string(),
                     "ScreenOrigin: expected [\"top\", \"left\"] or [\"bottom\", \"left\"]; a "
                     "study converts other positions with gaze.scale and gaze.offset");
  }
  const bool fractions = columns.units.value_or(GazeUnits::px) == GazeUnits::normalised ||
                         header.find(" [norm") != header.npos;
  if (!fractions && screen.size_px.y <= 0) {
    throw InputError(sidecar.string(),
                     "ScreenOrigin is at the bottom: expected ScreenResolution, too");
  }
  columns.scale.y = -1.0;
  columns.offset.y = fractions ? 1.0 : screen.size_px.y;
  return columns;
}

constexpr const char* kAssumedKey = "FociAssumed";
constexpr const char* kNominalText =
    "The recording states no screen: StimulusPresentation is a nominal screen of foci, which "
    "keeps the recording's own degrees or fractions";

/// What foci assumed as it converted the recording.
void takeAssumed(const Json& json, TraceHeader& header) {
  constexpr std::string_view kThen = "as foci converted it: ";
  constexpr std::size_t kMaxBytes = 200;
  const auto assumed = json.find(kAssumedKey);
  if (assumed == json.end() || !assumed->is_array()) return;
  for (const Json& each : *assumed) {
    if (!each.is_string()) continue;
    std::string text = each.get<std::string>().substr(0, kMaxBytes);
    std::ranges::replace_if(
        text, [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
    header.assumed.push_back(text.starts_with(kThen) ? text : std::string(kThen) + text);
  }
}

void append(std::string& text, const std::optional<double>& value, int digits) {
  text += '\t';
  text += value ? decimal(*value, digits) : "n/a";
}

void append(std::string& text, const std::optional<glm::dvec2>& point) {
  append(text, point ? std::optional(point->x) : std::nullopt, 3);
  append(text, point ? std::optional(point->y) : std::nullopt, 3);
}

}  // namespace

std::optional<fs::path> bidsSidecarOf(const fs::path& file) {
  const auto sidecar = sidecarNameOf(file);
  std::error_code error;
  return sidecar && fs::is_regular_file(*sidecar, error) ? sidecar : std::nullopt;
}

TraceHeader readBids(const fs::path& file, const fs::path& sidecar, const TraceColumns& described,
                     const Screen& fallback_screen, const TakeSample& take) {
  const Json json = readJson(sidecar);
  const auto columns = json.find("Columns");
  if (columns == json.end() || !columns->is_array() || columns->empty()) {
    throw InputError(sidecar.string(), "Columns: expected a list of names");
  }
  std::string header;
  for (const Json& column : *columns) {
    if (!column.is_string()) throw InputError(sidecar.string(), "Columns: expected names");
    const std::string name = column.get<std::string>();
    if (name.find_first_of("\t\n\r\"[(") != std::string::npos || name.size() > 256) {
      throw InputError(sidecar.string(), "Columns: " + shown(name) + ": expected a plain name");
    }
    const std::string unit = unitOf(json, name);
    header += (header.empty() ? "" : "\t") + name + (unit.empty() ? "" : " [" + unit + "]");
  }
  LineReader lines(file);
  const Screen screen = screenIn(json, fallback_screen);
  TextRows rows(lines, screen, header);
  const TraceColumns upright = fromUpperLeft(described, json, sidecar, header, screen);
  TraceHeader result = readRows(rows, upright, take);
  result.format = "BIDS eye tracking" + result.format.substr(std::min<std::size_t>(
                                            result.format.find(','), result.format.size()));
  takeAssumed(json, result);
  return result;
}

namespace {

constexpr std::string_view kEyes[] = {"_recording-eye1_", "_recording-eye2_"};

/// 0: left, 1: right.
std::size_t recordedSide(const fs::path& file) {
  const fs::path sidecar = *bidsSidecarOf(file);
  const Json json = readJson(sidecar);
  const auto eye = json.find("RecordedEye");
  const std::string name = eye != json.end() && eye->is_string() ? eye->get<std::string>() : "";
  if (name == "left") return 0;
  if (name == "right") return 1;
  throw InputError(sidecar.string(),
                   "RecordedEye: expected left in one and right in the other of two eyes' files");
}

/// Finds the other eye's sample of a time.
class OtherEye {
 public:
  OtherEye(const fs::path& file, const TraceColumns& described, const Screen& fallback_screen) {
    header_ = readBids(file, *bidsSidecarOf(file), described, fallback_screen,
                       [&](const GazeSample& sample) { samples_.push_back(sample); });
    if (samples_.size() < 2) throw InputError(file.string(), "expected at least 2 samples");
    const double span_s = samples_.back().time_s - samples_.front().time_s;
    reach_s_ = 0.5 * span_s / static_cast<double>(samples_.size() - 1);
  }

  /// @param time_s  does not decrease
  const GazeSample* at(double time_s) {
    while (next_ < samples_.size() && samples_[next_].time_s < time_s - reach_s_) ++next_;
    const bool near = next_ < samples_.size() && samples_[next_].time_s <= time_s + reach_s_;
    return near ? &samples_[next_] : nullptr;
  }

 private:
  TraceHeader header_{};
  std::vector<GazeSample> samples_{};
  double reach_s_ = 0.0;
  std::size_t next_ = 0;
};

}  // namespace

std::optional<fs::path> bidsOtherEyeOf(const fs::path& file) {
  for (std::size_t i : {0, 1}) {
    std::string name = file.filename().string();
    const std::size_t at = name.find(kEyes[i]);
    if (at == name.npos) continue;
    const fs::path other = file.parent_path() / name.replace(at, kEyes[i].size(), kEyes[1 - i]);
    std::error_code error;
    if (fs::is_regular_file(other, error) && bidsSidecarOf(other)) return other;
  }
  return std::nullopt;
}

TraceHeader readBidsEyes(const fs::path& file, const fs::path& other, const TraceColumns& described,
                         const Screen& fallback_screen, const TakeSample& take) {
  const std::size_t side = recordedSide(file);
  if (recordedSide(other) == side) {
    throw InputError(other.string(), "RecordedEye is that of " + file.string() +
                                         ": expected left in one and right in the other");
  }
  OtherEye other_eye(other, described, fallback_screen);
  Cyclopean cyclopean;
  std::size_t samples = 0, alone = 0;
  TraceHeader header =
      readBids(file, *bidsSidecarOf(file), described, fallback_screen, [&](const GazeSample& own) {
        GazeSample sample = own;
        const GazeSample* partner = other_eye.at(own.time_s);
        ++samples;
        alone += !partner;
        sample.eyes[side] = {.point_px = own.point_px, .pupil_mm = own.pupil_mm};
        sample.eyes[1 - side] = {};
        if (partner) {
          sample.eyes[1 - side] = {.point_px = partner->point_px, .pupil_mm = partner->pupil_mm};
          sample.blink = own.blink && partner->blink;
          if (own.pupil_mm && partner->pupil_mm) {
            sample.pupil_mm = 0.5 * (*own.pupil_mm + *partner->pupil_mm);
          }
        }
        sample.point_px =
            cyclopean.combine(own.time_s, sample.eyes[0].point_px, sample.eyes[1].point_px);
        take(sample);
      });
  header.format += ", binocular";
  header.assumed.push_back("the other eye: " + other.filename().string());
  constexpr double kMany = 0.05;
  if (static_cast<double>(alone) > kMany * static_cast<double>(samples)) {
    header.warnings.push_back(std::to_string(alone) +
                              " samples have no sample of the other eye at their time: are the "
                              "clocks of both files the same?");
  }
  return header;
}

struct BidsWriter::Output {
  gzFile file = nullptr;
  std::string text{};
  bool failed = false;

  void flush() {
    if (!text.empty()) {
      failed |= gzwrite(file, text.data(), static_cast<unsigned>(text.size())) <= 0;
    }
    text.clear();
  }
};

fs::path BidsWriter::sidecarFor(const fs::path& file) {
  const auto sidecar = sidecarNameOf(file);
  if (!sidecar || !file.string().ends_with(kPacked)) {
    throw InputError(file.string(), "expected a name that ends in _physio.tsv.gz");
  }
  return *sidecar;
}

BidsWriter::BidsWriter(const fs::path& file, bool eyes)
    : file_(file), eyes_(eyes), out_(std::make_unique<Output>()) {
  sidecarFor(file);
  out_->file = gzopen(file.string().c_str(), "wb");
  if (!out_->file) throw std::runtime_error("cannot write " + file.string());
}

BidsWriter::~BidsWriter() {
  if (out_->file) gzclose(out_->file);
}

void BidsWriter::add(const GazeSample& sample) {
  constexpr std::size_t kBlock = 1 << 16;
  std::string& text = out_->text;
  text += decimal(sample.time_s, 6);
  append(text, sample.point_px);
  append(text, sample.pupil_mm, 4);
  text += sample.blink ? "\t1" : "\t0";
  for (const EyeSample& eye : sample.eyes) {
    if (!eyes_) break;
    append(text, eye.point_px);
    append(text, eye.pupil_mm, 4);
  }
  text += '\n';
  if (text.size() > kBlock) out_->flush();
}

void BidsWriter::finish(const TraceHeader& header, double rate_Hz) {
  out_->flush();
  const bool closed = gzclose(out_->file) == Z_OK;
  out_->file = nullptr;
  if (!closed || out_->failed) throw std::runtime_error("cannot write " + file_.string());

  Json json = {{"PhysioType", "eyetrack"},
               {"SamplingFrequency", rate_Hz},
               {"StartTime", 0},
               {"RecordedEye", "cyclopean"},
               {"SampleCoordinateSystem", "gaze-on-screen"},
               {"Columns", {"timestamp", "x_coordinate", "y_coordinate", "pupil_size", "blink"}},
               {"timestamp", {{"Description", "The recording's own clock"}, {"Units", "s"}}},
               {"Description", "Converted by foci from " + header.format}};
  if (!header.assumed.empty()) json[kAssumedKey] = header.assumed;
  const auto describe = [&](const std::string& eye) {
    json[eye + "x_coordinate"] = {{"Units", "pixel"}};
    json[eye + "y_coordinate"] = {{"Units", "pixel"}};
    if (header.nominal_screen) {
      json[eye + "x_coordinate"]["Description"] = kNominalText;
      json[eye + "y_coordinate"]["Description"] = kNominalText;
    }
    json[eye + "pupil_size"] = {{"Description", "Diameter"}, {"Units", "mm"}};
  };
  describe("");
  json["blink"] = {{"Description", "1 where the tracker reports a blink"}};
  for (const std::string eye : {"left_", "right_"}) {
    if (!eyes_) break;
    for (const char* column : {"x_coordinate", "y_coordinate", "pupil_size"}) {
      json["Columns"].push_back(eye + column);
    }
    describe(eye);
  }
  if (header.screen) {
    const Screen& screen = *header.screen;
    Json stimulus = {{"ScreenOrigin", {"top", "left"}}};
    if (screen.size_px.x > 0) stimulus["ScreenResolution"] = {screen.size_px.x, screen.size_px.y};
    if (screen.size_m.x > 0.0) stimulus["ScreenSize"] = {screen.size_m.x, screen.size_m.y};
    if (screen.distance_m > 0.0) stimulus["ScreenDistance"] = screen.distance_m;
    json["StimulusPresentation"] = stimulus;
  }
  writeText(sidecarFor(file_), json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

}  // namespace foci
