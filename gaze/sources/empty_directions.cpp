#include "gaze/sources/empty_directions.h"

#include <array>
#include <optional>
#include <vector>

#include "gaze/sources/line_reader.h"

namespace foci {
namespace {

using Axes = std::array<std::optional<std::size_t>, 3>;

void leaveOut(Axes& axes, std::vector<ColumnReading>& readings) {
  for (std::optional<std::size_t>& column : axes) {
    if (!column) continue;
    readings[*column].meaning = "unused";
    readings[*column].why.clear();
    column.reset();
  }
}

}  // namespace

void leaveOutEmptyDirections(TableLayout& layout, std::string_view row) {
  if (!layout.hasDirections() || !layout.x) return;
  std::vector<std::string_view> fields;
  splitRow(row, layout.delimiter, fields);
  for (const EyeColumns& eye : layout.eyes) {
    for (const auto& column : eye.direction) {
      if (column && *column < fields.size() && !isAbsent(fields[*column])) return;
    }
  }
  for (EyeColumns& eye : layout.eyes) {
    leaveOut(eye.direction, layout.readings);
    leaveOut(eye.origin_mm, layout.readings);
  }
}

}  // namespace foci
