#include "calibration/binocular/binocular_pairs.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "base/input_error.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/rows.h"
#include "gaze/sources/table_row.h"

namespace foci {
namespace {

constexpr std::array<std::string_view, 2> kEyes{"left_", "right_"};
constexpr std::array<std::string_view, 6> kOfEye{"origin_x_mm", "origin_y_mm", "origin_z_mm",
                                                 "direction_x", "direction_y", "direction_z"};
constexpr std::array<std::string_view, 2> kTarget{"x_target_mm", "y_target_mm"};
constexpr double kMaxDistance_mm = 1e5, kMaxLength = 1e6, kMinLength = 1e-6;
constexpr std::size_t kMaxRows = 2'000'000;

using Column = std::optional<std::size_t>;

struct Columns {
  std::array<std::array<Column, 6>, 2> eyes{};
  std::array<std::size_t, 2> target{};
};

class PairsReader {
 public:
  explicit PairsReader(const std::filesystem::path& file) : lines_(file) {}

  std::vector<BinocularSample> read() {
    std::string_view line;
    TablePreamble preamble;
    if (!nextHeaderLine(lines_, line, preamble)) {
      throw InputError(lines_.fileName(), "empty: expected a header row");
    }
    delimiter_ = delimiterOf(line, preamble);
    commas_ = CommaNumbers(delimiter_);
    readHeader(line);
    std::vector<BinocularSample> samples;
    while (lines_.next(line)) {
      if (trimmed(line).empty() || line.front() == '#') continue;
      if (samples.size() == kMaxRows) throw lines_.error("more than 2000000 rows");
      splitRow(line, delimiter_, fields_);
      samples.push_back(sample());
    }
    commas_.example();  // refuses separators of thousands
    if (samples.empty()) throw InputError(lines_.fileName(), "no rows below the header");
    return samples;
  }

 private:
  Column find(const std::string& name) const {
    const auto found = std::find(fields_.begin(), fields_.end(), name);
    if (found == fields_.end()) return std::nullopt;
    return static_cast<std::size_t>(found - fields_.begin());
  }

  void readHeader(std::string_view line) {
    splitRow(line, delimiter_, fields_);
    const auto missing = [&](const std::string& name) {
      return lines_.error("no column " + name +
                          ": expected left_origin_x_mm ... right_direction_z, x_target_mm "
                          "y_target_mm");
    };
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const std::string name(kTarget[axis]);
      const Column column = find(name);
      if (!column) throw missing(name);
      columns_.target[axis] = *column;
    }
    bool any = false;
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const auto nameOf = [&](std::size_t i) {
        return std::string(kEyes[eye]) + std::string(kOfEye[i]);
      };
      std::size_t found = 0, absent = 0;
      for (std::size_t i = 0; i < 6; ++i) {
        columns_.eyes[eye][i] = find(nameOf(i));
        found += columns_.eyes[eye][i].has_value();
        if (!columns_.eyes[eye][i]) absent = i;
      }
      if (found > 0 && found < 6) throw missing(nameOf(absent));
      any |= found > 0;
    }
    if (!any) throw missing(std::string(kEyes[0]) + std::string(kOfEye[0]));
  }

  /// @return absent where the field is
  std::optional<double> number(std::size_t column, std::string_view name, double max) {
    if (column >= fields_.size()) throw lines_.error("a row without " + std::string(name));
    if (isAbsent(fields_[column])) return std::nullopt;
    const auto value = commas_.parse(fields_[column]);
    if (!value || std::abs(*value) > max) {
      throw lines_.error(std::string(name) + " = " + shown(fields_[column]) +
                         ": expected a number up to " + std::to_string(static_cast<long>(max)));
    }
    return value;
  }

  BinocularSample sample() {
    BinocularSample result;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto value = number(columns_.target[axis], kTarget[axis], kMaxDistance_mm);
      if (!value) throw lines_.error("a row without a target");
      commas_.note(lines_, columns_.target[axis], fields_[columns_.target[axis]], axis, *value);
      result.target_m[static_cast<int>(axis)] = 1e-3 * *value;
    }
    for (std::size_t eye = 0; eye < 2; ++eye) {
      if (!columns_.eyes[eye][0]) continue;
      std::array<double, 6> values{};
      bool complete = true;
      for (std::size_t i = 0; i < 6; ++i) {
        const auto value =
            number(*columns_.eyes[eye][i], kOfEye[i], i < 3 ? kMaxDistance_mm : kMaxLength);
        complete &= value.has_value();
        values[i] = value.value_or(0.0);
      }
      const glm::dvec3 direction(values[3], values[4], values[5]);
      if (!complete) continue;
      if (!(glm::length(direction) > kMinLength)) throw lines_.error("a direction of length 0");
      result.eyes[eye] = {.centre_m = 1e-3 * glm::dvec3(values[0], values[1], values[2]),
                          .direction = direction};
    }
    return result;
  }

  LineReader lines_;
  char delimiter_ = ' ';
  CommaNumbers commas_{delimiter_};
  Columns columns_{};
  std::vector<std::string_view> fields_{};
};

}  // namespace

std::vector<BinocularSample> readBinocularPairs(const std::filesystem::path& file) {
  return PairsReader(file).read();
}

}  // namespace foci
