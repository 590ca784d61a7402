// Rows of typed columns: what each format of a recording is before its columns have a meaning.
// Text tables have fields, binary formats and streams have numbers.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/swift_number.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

struct TablePreamble {
  Screen screen{};
  std::optional<GazeUnits> units{};
  std::optional<double> rate_Hz{};
  bool smi = false;                 ///< the file begins like those of SMI's BeGaze or IDF Converter
  std::optional<char> separator{};  ///< between fields, as a first line `sep=;` states it
  bool tobii_studio = false;        ///< the file begins like those of Tobii Studio 1 and 2
};

/// "px", "deg", "normalised", "relative" and their usual synonyms.
std::optional<GazeUnits> unitsNamed(std::string_view name);

/// The first line that is not blank, no comment (#) and no line `sep=;`. @return false if there is
/// none
bool nextHeaderLine(LineReader& lines, std::string_view& line, TablePreamble& preamble);

/// The character between the fields of a table: of the line `sep=;`, else the first of tab,
/// semicolon and comma that the header line has, else a blank.
char delimiterOf(std::string_view header, const TablePreamble& before);

/// "1280 x 1024". @return nothing for another text @throws InputError if it is out of range
std::optional<glm::ivec2> resolutionIn(const Place& place, std::string_view text);

/// A number from `low` to `high`. @param range  the limits as words, for the error
/// @throws InputError
double numberIn(const Place& place, std::string_view key, std::string_view text, double low,
                double high, const char* range);

/// A warning.
inline constexpr const char* kCutOff =
    "the last line is cut off and left out: is the file complete?";

class Rows : public Place {
 public:
  Rows() = default;
  Rows(const Rows&) = delete;
  Rows& operator=(const Rows&) = delete;

  /// Of the columns, with their units: "gaze x [px]".
  const std::vector<std::string>& names() const { return names_; }
  /// What the lines before the rows say.
  const TablePreamble& before() const { return before_; }
  /// Of the file, or of the stream.
  const std::string& source() const { return source_; }
  /// Between the fields of a text; 0: the columns are numbers.
  char delimiter() const { return delimiter_; }
  bool areNumbers() const { return delimiter_ == '\0'; }

  /// Moves on to the next row. Fields of the row before become invalid.
  /// @return false at the end
  virtual bool next() = 0;

  /// Visits the first rows. The next row is then the first one again.
  virtual void survey(std::size_t most, const std::function<void()>& visit) = 0;

  /// The line of names is a row itself. Call before `next`.
  virtual void readNamesAsRow() {}

  /// Only the first `columns` fields of a row are needed.
  void limitTo(std::size_t columns) { used_ = columns; }

  /// Of the latest row.
  std::size_t size() const { return areNumbers() ? numbers_.size() : fields_.size(); }
  /// A field as the text has it; a number as text, for messages.
  std::string_view text(std::size_t column) const {
    return areNumbers() ? textOf(numbers_[column]) : fields_[column];
  }
  bool isAbsent(std::size_t column) const {
    return areNumbers() ? std::isnan(numbers_[column]) : foci::isAbsent(fields_[column]);
  }
  /// The number in a column of numbers, or in a plain field of text (`swiftNumber`).
  std::optional<double> number(std::size_t column) const {
    if (!areNumbers()) return swiftNumber(fields_[column]);
    return std::isfinite(numbers_[column]) ? std::optional(numbers_[column]) : std::nullopt;
  }

  /// Whether the file may end within the latest row.
  bool mayBeCut() const { return may_be_cut_; }

  /// A likely cause of a row that makes no sense, for its error; empty if there is none.
  std::string hint() const;

 protected:
  std::vector<std::string> names_{};
  TablePreamble before_{};
  std::string source_{};
  char delimiter_ = '\0';
  std::size_t used_ = kAllFields;
  std::vector<std::string_view> fields_{};
  std::span<const double> numbers_{};
  bool may_be_cut_ = false;
  // The numbers of the line before and of this one, if a quote is left open there; else 0.
  std::size_t open_before_ = 0, open_here_ = 0;

 private:
  std::string_view textOf(double number) const;

  mutable std::string text_{};  // of a number
};

/// The lines of a text table. Blank lines and comments (#) are no rows.
class TextRows final : public Rows {
 public:
  /// Reads up to the line of names.
  /// @param lines   outlives the rows
  /// @throws InputError
  explicit TextRows(LineReader& lines);
  /// For a file without a line of names. A first line of these names is skipped.
  /// @param before  what describes the recording elsewhere
  /// @param header  the columns' names, separated by tabs
  TextRows(LineReader& lines, const TablePreamble& before, const std::string& header);

  bool next() override;
  void survey(std::size_t most, const std::function<void()>& visit) override;
  void readNamesAsRow() override;
  InputError error(const std::string& what) const override;

 private:
  struct Line {
    std::string text{};  // with kNumberPadding bytes behind it
    std::size_t number = 0;
    bool is_ended = true;
  };

  void takeNames();
  bool readLine(std::string_view& line);
  void split(std::string_view line, std::size_t number, bool is_ended);

  LineReader& lines_;
  std::string header_{};
  std::vector<Line> held_{};  // that `survey` has read
  std::size_t next_held_ = 0;
  std::size_t number_ = 0;  // of the latest line
};

/// Lines of comma-separated numbers, so many in each. Blank lines are none, and the last line may
/// be cut off.
class FixedLines {
 public:
  /// @param lines  outlives the object
  FixedLines(LineReader& lines, std::size_t fields) : lines_(lines), count_(fields) {}

  /// @throws InputError at the line behind one that has too few fields, or if it is the first
  bool next();
  /// Of the latest line. @throws InputError unless it is a number up to `limit`
  double number(std::size_t column, double limit = INFINITY) const;

  InputError error(const std::string& what) const { return lines_.error(what); }
  const std::string& fileName() const { return lines_.fileName(); }
  void warnIfCut(TraceHeader& header) const;

 private:
  LineReader& lines_;
  std::size_t count_, taken_ = 0;
  std::vector<std::string_view> fields_{};
  std::optional<InputError> cut_{};  // the latest line has too few fields
};

/// The numbers of a binary format or a stream.
class NumberRows final : public Rows {
 public:
  /// @param source  of the numbers, for errors
  /// @param names   of the columns, with units
  /// @param values  row after row; NaN: absent
  /// @param rate_Hz that the source states
  NumberRows(std::string source, std::vector<std::string> names, std::vector<double> values,
             std::optional<double> rate_Hz = {});

  bool next() override;
  void survey(std::size_t most, const std::function<void()>& visit) override;
  InputError error(const std::string& what) const override;

 private:
  std::vector<double> values_;
  std::size_t taken_ = 0;  // rows
};

}  // namespace foci
