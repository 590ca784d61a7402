// One row of a table of gaze as a sample.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "base/input_error.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/rows.h"
#include "gaze/sources/table_layout.h"

namespace foci {

class TableRow {
 public:
  /// All arguments outlive the row. @param screen  may still change while rows are read
  TableRow(const Rows& rows, const TableLayout& layout, const TraceColumns& given,
           const Screen& screen, GazeUnits units)
      : rows_(rows),
        layout_(layout),
        given_(given),
        screen_(screen),
        units_(units),
        commas_(rows.delimiter()) {}

  /// Whether the row has every field that the layout uses.
  bool isComplete() const { return rows_.size() >= layout_.columns; }

  /// @throws InputError if the row is too short
  std::string_view field(std::size_t column) const {
    if (column < rows_.size()) return rows_.text(column);
    failShort(column);
  }
  bool isAbsent(std::size_t column) const {
    if (column < rows_.size()) return rows_.isAbsent(column);
    failShort(column);
  }
  std::optional<double> number(std::size_t column) const {
    if (column >= rows_.size()) failShort(column);
    const auto number = rows_.number(column);
    return number || rows_.areNumbers() ? number : commas_.parse(rows_.text(column));
  }
  /// Whether a number means data loss (gaze.missing).
  bool isMissing(double number) const { return number == layout_.missing; }

  /// Whether the row is a sample: rows of messages may lie between the samples.
  bool isSample() const {
    const auto& column = layout_.rows.column;
    return !column || (*column < rows_.size() && layout_.rows.has(rows_.text(*column)));
  }

  bool hasGaze() const { return layout_.isFilled(rows_, false); }
  /// Neither gaze, nor what rates it.
  bool isBlank() const { return !layout_.isFilled(rows_, true); }

  /// Reads everything except the time. The point is the recording's own, or the mean of two lines
  /// of sight. It is absent if the row has points of single eyes only.
  /// @param sample  overwritten; reuse the same object for speed
  /// @throws InputError that names the column
  void read(GazeSample& sample) const;

  /// The last field in use.
  std::string_view lastField() const { return field(layout_.columns - 1); }

  /// Of all rows so far.
  /// @throws InputError if the commas may separate thousands
  const std::string& decimalComma() const { return commas_.example(); }

  /// By the layout's validity code.
  bool isValid(std::size_t column) const;

  [[noreturn]] void fail(std::size_t column, const char* expected) const;
  [[noreturn]] void failShort(std::size_t column) const;
  InputError tooShort(std::size_t column) const;

 private:
  // `inline` makes reading faster: these are called for millions of rows, in one file only.
  inline bool isTrusted(GazeSample& sample) const;
  void readEye(const EyeColumns& columns, EyeSample& eye) const;
  std::optional<glm::dvec3> triple(const ColumnsAt<3>& columns) const;
  template <std::size_t N>
  std::optional<std::array<std::string_view, N>> partsIn(std::size_t column,
                                                         const char* expected) const;
  std::optional<glm::dvec3> tripleIn(std::size_t column) const;
  std::optional<glm::dvec2> meanSight(const std::array<EyeSample, 2>& eyes) const;
  inline std::optional<double> readPupil(std::size_t column) const;
  std::optional<double> readOwnPupil(std::size_t column) const;
  inline std::optional<glm::dvec2> readPoint(std::size_t x, std::size_t y) const;
  std::optional<glm::dvec2> readTuple(std::size_t column) const;
  inline std::optional<double> coordinate(std::size_t column, int axis) const;
  std::optional<double> coordinate(std::size_t column, std::string_view text, int axis,
                                   double number) const;
  inline std::optional<glm::dvec2> pointOf(double x, double y) const;
  bool readFlag(std::size_t column) const;

  const Rows& rows_;
  const TableLayout& layout_;
  const TraceColumns& given_;
  const Screen& screen_;
  GazeUnits units_;
  mutable CommaNumbers commas_;  // gathered while numbers are parsed
};

}  // namespace foci
