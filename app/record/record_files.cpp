#include "app/record/record_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "app/record/tables.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "gaze/sources/rows.h"
#include "render/methods/method.h"

namespace foci {
namespace {

std::string exactly(const std::optional<double>& value) {
  return value ? exactText(*value) : "n/a";
}

std::string exactly(const std::optional<glm::dvec2>& point) {
  return point ? exactText(point->x) + '\t' + exactText(point->y) : "n/a\tn/a";
}

double timeIn(const Place& place, std::string_view field, double after_s) {
  const auto time_s = parseNumber(field);
  if (!time_s || !(*time_s >= after_s)) {
    throw place.error("time " + shown(field) + ": expected one that is not before the last");
  }
  return *time_s;
}

}  // namespace

double wholeMicroseconds(double time_s) { return std::round(time_s * 1e6) / 1e6; }

GazeTable::GazeTable(const std::filesystem::path& file, const Screen& screen)
    : file_(file.string()), out_(file, std::ios::binary) {
  out_ << "# screen_width_px=" << screen.size_px.x << " screen_height_px=" << screen.size_px.y
       << " screen_width_m=" << exactText(screen.size_m.x)
       << " screen_height_m=" << exactText(screen.size_m.y)
       << " viewing_distance_m=" << exactText(screen.distance_m) << " units=px rows=samples\n"
       << "time_s\tx_px\ty_px\tblink\tpupil_mm\tuncertainty_deg\tleft_x_px\tleft_y_px\tright_x_px\t"
          "right_y_px\n";
}

void GazeTable::add(const GazeSample& sample) {
  out_ << decimal(sample.time_s, 6) << '\t' << exactly(sample.point_px) << '\t' << sample.blink
       << '\t' << exactly(sample.pupil_mm) << '\t' << exactly(sample.uncertainty_deg);
  for (const EyeSample& eye : sample.eyes) out_ << '\t' << exactly(eye.point_px);
  out_ << '\n';
  if (!out_) throw std::runtime_error(cannotWrite(file_));
}

void GazeTable::flush() { out_.flush(); }

std::vector<RecordedFrame> readFrames(const std::filesystem::path& file) {
  NamedTable table(file, "frames", /*may_be_cut=*/true);  // the record of a killed run
  const std::size_t time = table.column("time_s"), method = table.column("method");
  const auto gaze = table.find("gaze_time_s");
  std::vector<RecordedFrame> frames;
  while (table.next()) {
    const double after_s = frames.empty() ? -1e12 : std::nextafter(frames.back().time_s, 1e12);
    std::string name(table.text(method));
    if (const auto expected = expectedMethod(name)) {
      throw table.error("method " + shown(name) + ": expected " + *expected);
    }
    const double time_s = timeIn(table, table.text(time), after_s);
    double known_s = time_s;
    if (gaze) {
      const std::string_view field = table.text(*gaze);
      known_s = field == "n/a"
                    ? -std::numeric_limits<double>::infinity()
                    : timeIn(table, field, frames.empty() ? -1e12 : frames.back().known_s);
    }
    frames.push_back({time_s, std::move(name), known_s});
  }
  if (frames.empty()) throw InputError(file.string(), "no frames: expected at least one");
  return frames;
}

double meanRate_Hz(std::size_t frames, double span_s, double otherwise) {
  if (frames < 2 || !(span_s > 0.0)) return otherwise;
  const double rate_Hz = std::round(1e3 * static_cast<double>(frames - 1) / span_s) / 1e3;
  return std::clamp(rate_Hz, 1.0, 1000.0);
}

std::string headHeader() { return "time_s\tof\tinferred\tx_m\ty_m\tz_m\tqx\tqy\tqz\tqw\n"; }

std::string headRow(const HeadRow& row) {
  const auto& [p, q] = row.head;
  std::string text = decimal(row.time_s, 6) + (row.of_sample ? "\tsample\t" : "\tframe\t") +
                     (row.inferred ? "1" : "0");
  for (const double value : {p.x, p.y, p.z, q.x, q.y, q.z, q.w}) text += '\t' + exactText(value);
  return text + '\n';
}

std::vector<HeadRow> readHeads(const std::filesystem::path& file) {
  NamedTable table(file, "time_s, of, x_m to qw", /*may_be_cut=*/true);  // of a killed run
  std::array<std::size_t, 9> columns{};
  std::ranges::transform(std::array{"time_s", "of", "x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"},
                         columns.begin(), [&](const char* name) { return table.column(name); });
  std::array<double, 2> last_s{-1e12, -1e12};  // of frames, of samples
  std::vector<HeadRow> rows;
  while (table.next()) {
    const bool of_sample = table.text(columns[1]) == "sample";
    const double after_s = last_s.at(of_sample ? 1 : 0);
    const double time_s = timeIn(table, table.text(columns[0]), std::nextafter(after_s, 1e12));
    last_s.at(of_sample ? 1 : 0) = time_s;
    const auto at = [&](std::size_t i) { return table.needed(columns.at(i)); };
    const glm::dquat turn(at(8), at(5), at(6), at(7));
    if (!(std::abs(glm::length(turn) - 1.0) < 1e-3)) {
      throw table.error("qx, qy, qz, qw: expected a quaternion of length 1");
    }
    rows.push_back(
        {.time_s = time_s, .of_sample = of_sample, .head = {{at(2), at(3), at(4)}, turn}});
  }
  return rows;
}

void giveHeads(const std::vector<HeadRow>& rows, std::vector<GazeSample>& samples) {
  auto sample = samples.begin();
  for (const HeadRow& row : rows) {
    if (!row.of_sample) continue;
    while (sample != samples.end() && sample->time_s < row.time_s) ++sample;
    if (sample == samples.end()) break;
    if (sample->time_s == row.time_s) sample->head = row.head;
  }
}

std::string changesHeader() { return "time_s\tkey\tvalue\n"; }

std::string changeRow(const Change& change) {
  return rowOf(decimal(change.time_s, 6), change.key, change.toml);
}

std::vector<Change> readChanges(const std::filesystem::path& file) {
  LineReader lines(file);
  std::string_view line;
  std::vector<Change> changes;
  for (bool header = true; lines.next(line); header = false) {
    if (header || line.empty()) continue;
    const auto fields = fieldsOf(line);
    if (fields.size() != 3) throw lines.error("expected time, key and value between tabs");
    if (!changesLive(fields[1])) {
      throw lines.error("key " + shown(fields[1]) + ": expected one that changes while foci runs");
    }
    const double time_s = timeIn(lines, fields[0], changes.empty() ? -1e12 : changes.back().time_s);
    changes.push_back({time_s, fields[1], fields[2]});
  }
  return changes;
}

std::vector<TraceMarker> readEventMarkers(const std::filesystem::path& file) {
  LineReader lines(file);
  std::string_view line;
  std::vector<TraceMarker> markers;
  bool broken = false;
  for (bool header = true; lines.next(line); header = false) {
    if (header || line.empty()) continue;
    if (broken) throw lines.error("follows a line that is too short");
    const std::size_t tab = line.find('\t');
    // The record of a killed run may end within a line.
    if ((broken = tab == line.npos)) continue;
    markers.push_back({timeIn(lines, std::string(line.substr(0, tab)), -1e12),
                       std::string(line.substr(tab + 1))});
  }
  std::ranges::stable_sort(markers, {}, &TraceMarker::time_s);
  return markers;
}

}  // namespace foci
