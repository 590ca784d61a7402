// Rows of typed columns: what each format of a recording is before its columns have a meaning.
// Text tables have fields, binary formats and streams have numbers.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/input_error.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

struct TablePreamble {
  Screen screen{};
  std::optional<GazeUnits> units{};
  std::optional<double> rate_Hz{};
  bool smi = false;                 ///< the file begins like those of SMI's BeGaze or IDF Converter
  std::optional<char> separator{};  ///< between fields, as a first line `sep=;` states it
  bool tobii_studio = false;        ///< the file begins like those of Tobii Studio 1 and 2
  bool of_scene_camera = false;     ///< the positions
  bool of_samples = false;          ///< each row: none is of a mouse, a sensor or an event
};

/// "px", "deg", "normalised", "relative" and their usual synonyms.
std::optional<GazeUnits> unitsNamed(std::string_view name);

/// "1280 x 1024". @return nothing for another text @throws InputError if it is out of range
std::optional<glm::ivec2> resolutionIn(const Place& place, std::string_view text);

/// A number from `low` to `high`. @param range  the limits as words, for the error
/// @throws InputError
double numberIn(const Place& place, std::string_view key, std::string_view text, double low,
                double high, const char* range);

/// A number of pixels along a side of a screen. @throws InputError
int pixelsIn(const Place& place, std::string_view key, std::string_view text);

/// A warning.
inline constexpr const char* kCutOff =
    "the last line is cut off and left out: is the file complete?";

/// Rows that tell what a table is: its groups, units and codes.
inline constexpr std::size_t kSurveyedRows = 2048;

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

  /// Visits the first rows, at most so many. The next row is then the first one again.
  virtual void survey(std::size_t most, const std::function<void()>& visit) = 0;

  /// The line of names is a row itself. Call before `next`.
  virtual void readNamesAsRow() {}
  /// Gives a column of row numbers without a name, as R's write.table and pandas' to_string write
  /// it, an empty name. Call before `names`.
  virtual void nameRowNumbers() {}

  /// Only the first `columns` fields of a row are needed.
  void limitTo(std::size_t columns) { used_ = columns; }

  /// Of the latest row.
  std::size_t size() const { return areNumbers() ? numbers_.size() : fields_.size(); }
  /// Fields of the latest row without the empty ones at its end, of which the first `kept` count.
  std::size_t sizeUpToText(std::size_t kept) const {
    std::size_t fields = size();
    while (fields > kept && text(fields - 1).empty()) --fields;
    return fields;
  }
  /// A field as the text has it; a number as text, for messages.
  std::string_view text(std::size_t column) const {
    return areNumbers() ? textOf(numbers_[column]) : fields_[column];
  }
  bool isAbsent(std::size_t column) const {
    return areNumbers() ? std::isnan(numbers_[column]) : foci::isAbsent(fields_[column]);
  }
  /// The number in a column of numbers, or in a field of text without a decimal comma.
  std::optional<double> number(std::size_t column) const {
    if (!areNumbers()) return parseNumber(fields_[column]);
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

/// The commas in the numbers of a table: decimal ones, as is usual in many countries, or separators
/// of thousands.
class CommaNumbers {
 public:
  /// @param delimiter  between the fields; if it is a comma, no number has one
  explicit CommaNumbers(char delimiter) : decimal_allowed_(delimiter != ',') {}

  /// A number with a decimal point or a decimal comma.
  std::optional<double> parse(std::string_view text);

  /// Notes whether the column of x (axis 0) or y (axis 1) has separators of thousands.
  /// @param text  that `parse` has read as `number`
  void note(const Place& place, std::size_t column, std::string_view text, std::size_t axis,
            double number);

  /// The first number with a decimal comma; empty if there was none.
  /// @throws InputError if the commas may separate thousands
  const std::string& example() const;

 private:
  bool decimal_allowed_;
  std::string example_{};
  bool decimal_ = false;  // a comma that cannot separate thousands
  // Along x and y: the first number such as "1,271", and whether others reach 100 without a comma.
  std::array<std::optional<InputError>, 2> thousands_{};
  std::array<bool, 2> plain_{};
};

/// The lines of a text table. Blank lines and comments (#) are no rows.
class TextRows final : public Rows {
 public:
  /// Reads up to the line of names.
  /// @param lines   outlives the rows
  /// @throws InputError
  explicit TextRows(LineReader& lines);
  /// For a file without a line of names, or behind it.
  /// @param before  what describes the recording elsewhere
  /// @param header  the columns' names, separated as the fields are
  TextRows(LineReader& lines, const TablePreamble& before, const std::string& header);

  /// Call before `next`: the table has no comments, so that a row may begin with #.
  void withoutComments() { has_comments_ = false; }
  /// Call before `next`: a first row of the names is none.
  void skipNames();

  bool next() override;
  void survey(std::size_t most, const std::function<void()>& visit) override;
  void readNamesAsRow() override;
  void nameRowNumbers() override;
  InputError error(const std::string& what) const override;

 private:
  struct Line {
    std::string text{};
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
  bool has_comments_ = true;
};

/// A small table whose columns are known by their names. Blank lines and comments (#) are no rows.
class NamedTable final : public Place {
 public:
  /// @param expected    the columns, for errors
  /// @param may_be_cut  a last row of too few fields is left out
  NamedTable(const std::filesystem::path& file, std::string expected, bool may_be_cut = false);
  /// So many columns without names, with commas between them. The last row may be cut off.
  NamedTable(const std::filesystem::path& file, std::size_t columns);

  /// @throws InputError if there are two of the name
  std::optional<std::size_t> find(std::string_view name) const;
  /// @throws InputError if there is none
  std::size_t column(std::string_view name) const;

  /// Call before `next`: the table has no comments, so that a row may begin with #.
  void withoutComments() { rows_->withoutComments(); }

  /// Moves on to the next row.
  /// @throws InputError for a row of another number of fields, and at the end if commas may
  /// separate thousands
  bool next();
  bool isCut() const { return cut_.has_value(); }

  /// Of the latest row.
  std::string_view text(std::size_t column) const { return rows_->text(column); }
  /// Nothing for an absent one. @throws InputError
  std::optional<double> number(std::size_t column, double low = -INFINITY, double high = INFINITY);
  /// Of a column of x (axis 0) or y (axis 1), where commas may separate thousands.
  std::optional<double> position(std::size_t column, std::size_t axis, double low, double high);
  /// @throws InputError for an absent one, too
  double needed(std::size_t column, double low = -INFINITY, double high = INFINITY);

  InputError error(const std::string& what) const override { return rows_->error(what); }
  const std::string& fileName() const { return lines_.fileName(); }

 private:
  InputError unexpected(std::size_t column, double low, double high) const;

  LineReader lines_;
  std::string expected_{};
  std::optional<TextRows> rows_{};
  CommaNumbers commas_{','};
  bool may_be_cut_ = true, any_ = false;
  std::optional<InputError> cut_{};  // the latest row has too few fields
};

/// The numbers of a binary format or a stream.
class NumberRows final : public Rows {
 public:
  /// @param source  of the numbers, for errors
  /// @param names   of the columns, with units
  /// @param values  row after row; NaN: absent
  /// @param before  what the source states
  NumberRows(std::string source, std::vector<std::string> names, std::vector<double> values,
             const TablePreamble& before = {});

  bool next() override;
  void survey(std::size_t most, const std::function<void()>& visit) override;
  InputError error(const std::string& what) const override;

 private:
  std::vector<double> values_;
  std::size_t taken_ = 0;  // rows
};

}  // namespace foci
