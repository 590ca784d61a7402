// Native recordings of Tobii Pro Glasses 2 (livedata.json.gz) and 3 (gazedata.gz): both eyes'
// centres, directions and pupils, in the columns of Pro Lab's export. Each line is a JSON object.
// Glasses 2 write `ts` in microseconds, `s` (0: valid), the number of the sample `gidx`, and one of
// `pc`, `pd`, `gd` for each `eye`. Glasses 3 write a sample in a line. Lengths are in millimetres,
// x left, y up, z forward. Lines of other sensors are skipped.
// From "Tobii Pro Glasses 2 API Developer's Guide" and "Tobii Pro Glasses 3 Developer Guide".
#include <array>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "base/text.h"
#include "gaze/sources/recording_formats.h"

namespace foci {
namespace {

using GlassesJson = nlohmann::json;

constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kOfEye = 7;  // direction, centre, pupil

/// The time, then the values of the left and of the right eye.
using Row = std::array<double, 1 + 2 * kOfEye>;

Row absentRow(double time_s) {
  Row row{};
  row.fill(kAbsent);
  row[0] = time_s;
  return row;
}

std::vector<std::string> columnNames() {
  std::vector<std::string> names{"time [s]"};
  for (const std::string eye : {"left", "right"}) {
    for (const char axis : {'X', 'Y', 'Z'}) {
      names.push_back("Gaze direction " + eye + " " + axis + " [HUCS norm]");
    }
    for (const char axis : {'X', 'Y', 'Z'}) {
      names.push_back("Pupil position " + eye + " " + axis + " [HUCS mm]");
    }
    names.push_back("Pupil diameter " + eye + " [mm]");
  }
  return names;
}

std::optional<double> numberIn(const GlassesJson& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

/// Takes a vector of three numbers into the row.
void takeVector(const GlassesJson& json, const char* key, std::size_t at, Row& row) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array() || found->size() != 3) return;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if ((*found)[axis].is_number()) row[at + axis] = (*found)[axis].get<double>();
  }
}

void takeEye(const GlassesJson& json, const std::array<const char*, 3>& keys, std::size_t side,
             Row& row) {
  const std::size_t at = 1 + side * kOfEye;
  takeVector(json, keys[0], at, row);
  takeVector(json, keys[1], at + 3, row);
  if (const auto pupil_mm = numberIn(json, keys[2]); pupil_mm && *pupil_mm > 0.0) {
    row[at + 6] = *pupil_mm;
  }
}

/// A line of Glasses 2: one value of one eye.
void takeGlasses2(const GlassesJson& line, std::map<double, Row>& rows) {
  const auto number = numberIn(line, "gidx"), time_us = numberIn(line, "ts");
  if (!number || !time_us) return;
  Row& row = rows.try_emplace(*number, absentRow(1e-6 * *time_us)).first->second;
  const auto eye = line.find("eye");
  if (numberIn(line, "s").value_or(0.0) != 0.0 || eye == line.end()) return;
  takeEye(line, {"gd", "pc", "pd"}, *eye == "left" ? 0 : 1, row);
}

/// A line of Glasses 3: one sample.
void takeGlasses3(const GlassesJson& line, std::map<double, Row>& rows) {
  const auto time_s = numberIn(line, "timestamp");
  if (!time_s || line.value("type", GlassesJson()) != "gaze") return;
  Row row = absentRow(*time_s);
  const auto data = line.find("data");
  for (const std::size_t side : {0, 1}) {
    if (data == line.end() || !data->is_object()) break;
    const auto eye = data->find(side == 0 ? "eyeleft" : "eyeright");
    if (eye == data->end() || !eye->is_object()) continue;
    takeEye(*eye, {"gazedirection", "gazeorigin", "pupildiameter"}, side, row);
  }
  rows.emplace(static_cast<double>(rows.size()), row);
}

bool isTobiiGlasses(const RecordingFile& file) {
  const std::string name = file.path().filename().string();
  if (name.find(".json") == name.npos && name.find("gazedata") == name.npos) return false;
  if (!trimmed(file.firstLine()).starts_with('{')) return false;
  const GlassesJson line = GlassesJson::parse(file.firstLine(), nullptr, false);
  return line.is_object() && ((line.contains("ts") && line.contains("s")) ||
                              (line.contains("type") && line.contains("timestamp")));
}

/// @throws InputError for a line before the last that is no JSON
NumberRows glassesRows(LineReader& lines) {
  std::map<double, Row> rows;
  std::optional<InputError> broken;
  std::string_view text;
  while (lines.next(text)) {
    if (trimmed(text).empty()) continue;
    if (broken) throw *broken;
    const GlassesJson line = GlassesJson::parse(text, nullptr, false);
    if (!line.is_object()) {  // the last line may be cut off
      broken = lines.error("expected a JSON object in each line");
    } else if (line.contains("gidx")) {
      takeGlasses2(line, rows);
    } else {
      takeGlasses3(line, rows);
    }
  }
  std::vector<double> values;
  for (const auto& [number, row] : rows) values.insert(values.end(), row.begin(), row.end());
  return {lines.fileName(), columnNames(), std::move(values)};
}

TraceHeader readTobiiGlasses(const RecordingFile& file, const Screen& fallback_screen,
                             const TakeSample& take) {
  LineReader lines(file.path());
  NumberRows rows = glassesRows(lines);
  TraceHeader header = readRows(rows, file.columns(), fallback_screen, take);
  header.format = "Tobii Pro Glasses, native recording, binocular";
  return header;
}

}  // namespace

const RecordingFormat kTobiiGlasses{
    .name = "Tobii Pro Glasses", .is = isTobiiGlasses, .read = readTobiiGlasses};

}  // namespace foci
