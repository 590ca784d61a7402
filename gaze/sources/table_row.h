// One row of a table of gaze as a sample.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/table_layout.h"

namespace foci {

class TableRow {
 public:
  /// All outlive the row. @param screen  may become known later
  TableRow(const LineReader& lines, const TableLayout& layout, const Screen& screen,
           GazeUnits units)
      : lines_(lines), layout_(layout), screen_(screen), units_(units) {}

  /// Takes a line of a LineReader; what is got before is of the line before.
  void split(std::string_view line);

  /// Every field that the layout names is there.
  bool isComplete() const { return fields_.size() >= layout_.columns; }

  /// @throws InputError where the row is too short
  std::string_view field(std::size_t column) const {
    if (column < fields_.size()) return fields_[column];
    failShort(column);
  }
  std::optional<double> number(std::size_t column) const;

  /// What the row says but its time. The point is the recording's own, or the mean of two lines of
  /// sight; absent where the row has points of the eyes alone.
  /// @param sample  new, or of the row before: all that is large is not cleared anew
  /// @throws InputError naming the column
  void read(GazeSample& sample) const;

  [[noreturn]] void fail(std::size_t column, const char* expected) const;
  [[noreturn]] void failShort(std::size_t column) const;

 private:
  // Inline where they are defined, and used nowhere else: a row is read millions of times.
  inline bool isTrusted(GazeSample& sample) const;
  void readEye(const EyeColumns& columns, EyeSample& eye) const;
  std::optional<glm::dvec3> triple(const std::array<std::optional<std::size_t>, 3>& columns) const;
  std::optional<glm::dvec3> tripleIn(std::size_t column) const;
  std::optional<glm::dvec2> meanSight(const std::array<EyeSample, 2>& eyes) const;
  bool isValid(std::size_t column) const;
  inline std::optional<double> readPupil(std::size_t column) const;
  inline std::optional<glm::dvec2> readPoint(std::size_t x, std::size_t y) const;
  std::optional<glm::dvec2> readTuple(std::size_t column) const;
  inline std::optional<double> coordinate(std::size_t column, std::string_view text,
                                          int axis) const;
  inline std::optional<glm::dvec2> pointOf(double x, double y) const;
  bool readFlag(std::size_t column) const;
  inline std::optional<double> parse(std::string_view text) const;

  const LineReader& lines_;
  const TableLayout& layout_;
  const Screen& screen_;
  GazeUnits units_;
  std::vector<std::string_view> fields_{};
};

}  // namespace foci
