#include "calibration/binocular/binocular_pairs.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "base/input_error.h"
#include "gaze/sources/rows.h"

namespace foci {
namespace {

constexpr std::array<const char*, 6> kOfEye{"origin_x_mm", "origin_y_mm", "origin_z_mm",
                                            "direction_x", "direction_y", "direction_z"};
constexpr double kMaxDistance_mm = 1e5, kMaxLength = 1e6, kMinLength = 1e-6;
constexpr std::size_t kMaxRows = 2'000'000;

using EyeAt = std::array<std::size_t, kOfEye.size()>;

/// @param eye  "left_", "right_" @return nothing if the table has no column of it
std::optional<EyeAt> eyeColumnsOf(const NamedTable& table, const std::string& eye) {
  if (std::ranges::none_of(kOfEye,
                           [&](const char* name) { return table.find(eye + name).has_value(); })) {
    return std::nullopt;
  }
  EyeAt columns{};
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = table.column(eye + kOfEye[i]);
  return columns;
}

/// @return nothing in data loss
std::optional<BinocularSample::Eye> eyeIn(NamedTable& table, const EyeAt& columns) {
  std::array<double, kOfEye.size()> values{};
  bool complete = true;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double max = i < 3 ? kMaxDistance_mm : kMaxLength;
    const auto value = table.number(columns[i], -max, max);
    complete &= value.has_value();
    values[i] = value.value_or(0.0);
  }
  if (!complete) return std::nullopt;
  const glm::dvec3 direction(values[3], values[4], values[5]);
  if (!(glm::length(direction) > kMinLength)) throw table.error("a direction of length 0");
  return BinocularSample::Eye{.centre_m = 1e-3 * glm::dvec3(values[0], values[1], values[2]),
                              .direction = direction};
}

}  // namespace

std::vector<BinocularSample> readBinocularPairs(const std::filesystem::path& file) {
  NamedTable table(file, "left_origin_x_mm ... right_direction_z, x_target_mm y_target_mm");
  const std::array target{table.column("x_target_mm"), table.column("y_target_mm")};
  const std::array eyes{eyeColumnsOf(table, "left_"), eyeColumnsOf(table, "right_")};
  if (!eyes[0] && !eyes[1]) table.column("left_origin_x_mm");  // throws
  std::vector<BinocularSample> samples;
  while (table.next()) {
    if (samples.size() == kMaxRows) throw table.error("more than 2000000 rows");
    BinocularSample& sample = samples.emplace_back();
    for (const std::size_t axis : {0, 1}) {
      const auto value = table.position(target[axis], axis, -kMaxDistance_mm, kMaxDistance_mm);
      if (!value) throw table.error("a row without a target");
      sample.target_m[static_cast<int>(axis)] = 1e-3 * *value;
    }
    for (const std::size_t side : {0, 1}) {
      if (eyes[side]) sample.eyes[side] = eyeIn(table, *eyes[side]);
    }
  }
  if (samples.empty()) throw InputError(table.fileName(), "no rows below the header");
  return samples;
}

}  // namespace foci
