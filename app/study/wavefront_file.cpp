#include "app/study/eye_tables.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr double kLeastPupil_mm = 1.0, kMostPupil_mm = 12.0, kMost_um = 50.0;
constexpr std::size_t kMostLines = 1000, kLongestCell = 60;
constexpr std::uintmax_t kMostTable_bytes = 1 << 20;  // far above such a table

struct Row {
  int line = 0;
  std::vector<std::string> cells;

  const std::string& at(int column) const { return cells[static_cast<std::size_t>(column)]; }
};

/// -1: left, 1: right, 0: another word.
int sideNamed(const std::string& text) {
  for (const std::string_view word : {"od", "r", "re", "right", "right eye"}) {
    if (text == word) return 1;
  }
  for (const std::string_view word : {"os", "l", "le", "left", "left eye"}) {
    if (text == word) return -1;
  }
  return 0;
}

std::string unquoted(std::string_view text) {
  text = trimmed(text);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    text = text.substr(1, text.size() - 2);
  }
  return std::string(trimmed(text));
}

/// The name of another order of the terms that a line states: as a cell of its own ("Noll"), or in
/// a cell or comment about the order ("Noll index", "# ordering: Noll"). A name of a person or a
/// file may hold the same letters; a line that also names OSA or ANSI only compares.
std::optional<std::string> otherOrderIn(const std::string& line, char separator) {
  static const std::regex name("(^|[^a-z])(noll|fringe|malacara)([^a-z]|$)");
  static const std::regex about(
      "(^|[^a-z])(order|ordered|ordering|index|indices|indexing|convention|scheme|notation|"
      "standard|"
      "numbering|sequence|zernikes?|modes?|terms?|j)([^a-z]|$)");
  static const std::regex ours("(^|[^a-z])(osa|ansi)([^a-z]|$)");
  std::smatch found;
  if (line.size() > 1000 || !std::regex_search(line, found, name)) return std::nullopt;
  std::string other = found[2];
  if (std::regex_search(line, ours)) return std::nullopt;
  const std::vector<std::string> cells = cellsOf(trimmed(line), separator);
  const bool alone = std::ranges::find(cells, other) != cells.end();
  return alone || std::regex_search(line, about) ? std::optional(std::move(other)) : std::nullopt;
}

/// What a comment states of the coefficients' unit, if anything: "units: nm", "coefficients (um)".
std::string unitStatementIn(const std::string& comment) {
  static const std::regex statement(
      "((^|[.,;] *)(units?|values?)|(^|[^a-z])coeff[a-z]*)[ =:(\\[]*((in|is|are) +)?"
      "(um|µm|μm|microns?|microm[a-z]*|nm|nanom[a-z]*|waves?(?![ -]*(aberr|front))|lambdas?|λ)"
      "(?![a-z])");
  std::smatch found;
  const bool states = comment.size() <= 1000 && std::regex_search(comment, found, statement);
  return states ? found.str() : "";
}

/// The table, while it is read.
class WavefrontTable {
 public:
  WavefrontTable(const std::filesystem::path& file, std::optional<double> pupil_mm)
      : file_(file.string()), pupil_mm_(pupil_mm) {}

  MeasuredEyes read() {
    readRows();
    takeStatements();
    if (rows_.empty()) fail(0, "no coefficients: expected a table of Zernike coefficients");
    const auto isTerm = [&](const std::string& cell) { return isNamed(cell); };
    const bool is_wide = std::ranges::count_if(rows_.front().cells, isTerm) >= 2;
    noteNames(is_wide);
    if (is_wide) {
      readWide();
    } else {
      readLong();
    }
    if (!eyes_.left && !eyes_.right) fail(0, "no coefficients beyond the tilt (index 2)");
    return eyes_;
  }

 private:
  [[noreturn]] void fail(int line, const std::string& what) const {
    throw InputError(line > 0 ? file_ + ":" + std::to_string(line) : file_, what);
  }

  [[noreturn]] void failTwice(const Row& row, int term) const {
    fail(row.line, "term " + std::to_string(term) + " a second time: expected each term once");
  }

  void readRows() {
    std::istringstream in(bytesOfFile(file_, kMostTable_bytes));
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) {
      if (lines.size() == kMostLines) {
        fail(0,
             "more than " + std::to_string(kMostLines) + " lines: expected one table of one eye");
      }
      if (lines.empty() && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
      lines.push_back(line);
    }
    const auto holds = [&](char c) {
      return std::ranges::any_of(lines, [&](const std::string& line) {
        return !line.starts_with('#') && line.find(c) != line.npos;
      });
    };
    const char separator = holds('\t') ? '\t' : holds(';') ? ';' : holds(',') ? ',' : ' ';
    decimal_comma_ = separator != ',';
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const int line = static_cast<int>(i) + 1;
      if (const auto other = otherOrderIn(lowered(lines[i]), separator)) {
        fail(line, *other + ": expected the order of OSA and ANSI Z80.28");
      }
      std::string_view content = trimmed(lines[i]);
      if (content.starts_with('#')) {
        // A comment may hold the pupil, or the coefficients' unit.
        content = trimmed(content.substr(1));
        if (!lowered(content).starts_with("pupil")) {
          const std::string unit = unitStatementIn(lowered(content));
          if (!unit.empty()) comments_.push_back({line, {unit}});
          continue;
        }
      }
      if (content.empty()) continue;
      rows_.push_back({line, cellsOf(content, separator)});
      for (const std::string& cell : rows_.back().cells) {
        if (cell.size() > kLongestCell) {
          fail(line, shown(cell) + ": expected cells of at most 60 characters");
        }
      }
      const auto blank = [](const std::string& cell) { return cell.empty(); };
      while (!rows_.back().cells.empty() && blank(rows_.back().cells.back())) {
        rows_.back().cells.pop_back();
      }
      if (rows_.back().cells.empty()) rows_.pop_back();
    }
    for (const Row& row : rows_) {
      decimal_point_ |= std::ranges::any_of(row.cells, [](const std::string& cell) {
        return cell.find('.') != cell.npos && parseNumber(cell);
      });
    }
  }

  std::optional<double> numberIn(std::string cell) const {
    if (decimal_comma_) std::ranges::replace(cell, ',', '.');
    return parseNumber(cell);
  }

  double number(const Row& row, const std::string& cell, const std::string& what) const {
    const auto value = numberIn(cell);
    if (!value) fail(row.line, what + " = " + shown(cell) + ": expected a number");
    return *value;
  }

  /// @param name  what names the cell: a radius counts twice
  double pupilOf(const Row& row, const std::string& name, const std::string& cell) const {
    const std::size_t end = cell.find_first_not_of("0123456789.,");
    const std::string unit = end == cell.npos ? "" : std::string(trimmed(cell.substr(end)));
    if (!unit.empty() && unit != "mm") {
      fail(row.line, "pupil = " + shown(cell) + ": expected mm");
    }
    const bool radius = lowered(name).find("radius") != name.npos;
    const double mm = (radius ? 2.0 : 1.0) * number(row, cell.substr(0, end), "pupil");
    if (!(mm >= kLeastPupil_mm && mm <= kMostPupil_mm)) {
      fail(row.line, "pupil = " + shown(cell) + ": expected a diameter of 1 to 12 mm");
    }
    return mm;
  }

  static bool namesPupil(const std::string& cell) {
    const std::string text = lowered(cell);
    return text.starts_with("pupil") || text.starts_with("diameter") ||
           text.starts_with("analysis diameter") || text.starts_with("zone");
  }

  static bool isUnit(std::string_view name) { return name == "unit" || name == "units"; }

  /// Whether a column holds the coefficients' unit: mm beside the pupil is the pupil's.
  bool isUnitColumn(std::size_t at) const {
    const std::vector<std::string>& head = rows_.front().cells;
    if (!isUnit(lowered(head[at]))) return false;
    return at == 0 || !namesPupil(head[at - 1]) || rows_.size() < 2 ||
           rows_[1].cells.size() <= at || lowered(rows_[1].cells[at]) != "mm";
  }

  /// Takes rows such as `pupil_mm, 6`, `unit, nm` and `wavelength_nm, 555` out of the table.
  void takeStatements() {
    std::optional<double> named;
    std::erase_if(rows_, [&](const Row& row) {
      std::vector<std::string> cells = row.cells;
      const std::string name = lowered(cells[0]);
      const bool unit = isUnit(trimmed(std::string_view(name).substr(0, name.find_first_of("=:"))));
      const bool wavelength = name.starts_with("wavelength") || name.starts_with("lambda");
      if (!namesPupil(cells[0]) && !unit && !wavelength) return false;
      if (cells.size() == 1) {
        // "pupil_mm = 6" or "Pupil diameter: 6 mm"
        const std::size_t at = cells[0].find_first_of("=:");
        if (at == cells[0].npos) return false;
        cells.emplace_back(trimmed(std::string_view(cells[0]).substr(at + 1)));
      }
      if (unit && cells.size() == 2 && !isNamed(cells[1])) {
        takeUnitCell(row, cells[1], unit_);
        return true;
      }
      if (cells.size() > 3 || isNamed(cells[1]) || cells[1].empty() ||
          std::isdigit(static_cast<unsigned char>(cells[1][0])) == 0) {
        return false;
      }
      if (wavelength) {
        wavelength_line_ = row.line;
        return true;
      }
      if (cells.size() == 3 && lowered(cells[2]) == "mm") cells.pop_back();
      if (cells.size() != 2 || unit) return false;
      const double mm = pupilOf(row, cells[0], cells[1]);
      if (named && *named != mm) fail(row.line, "a second pupil: expected one for the table");
      named = mm;
      return true;
    });
    if (named) pupil_mm_ = named;
  }

  /// Finds out whether names such as Z40 are a single index, or n and m. Tilt alone is no
  /// wavefront.
  void noteNames(bool is_wide) {
    static const std::regex signed_name("[ZzCc]\\d+[+-]\\d+"), single("[ZzCc]_?\\d+");
    static const std::regex pair("[ZzCc]_?(\\d)(\\d)");
    bool has_heading = false;
    const Columns columns = is_wide ? Columns{} : columnsOf(rows_.front(), has_heading);
    const int column = std::max(columns.name >= 0 ? columns.name : columns.index, 0);
    std::string ambiguous;
    int line = 0;
    bool all_are = true;
    for (const Row& row : rows_) {
      for (std::size_t c = 0; c < row.cells.size(); ++c) {
        if (is_wide ? &row != &rows_.front() : static_cast<int>(c) != column) continue;
        const std::string name = withoutUnit(row.cells[c]);
        signed_names_ |= std::regex_match(name, signed_name);
        if (!std::regex_match(name, single)) continue;
        std::smatch parts;
        all_are &= std::regex_match(name, parts, pair) && indexOfPair(parts[1], parts[2]);
        if (line > 0 || !all_are || indexOfPair(parts[1], parts[2]) < 3) continue;
        line = row.line;
        ambiguous = name;
      }
    }
    if (line > 0 && all_are && !signed_names_) {
      fail(line, shown(ambiguous) +
                     ": an index, or n and m? expected names such as Z2_0 for n = 2 and m = 0, or "
                     "the columns j and um for an index");
    }
  }

  static std::optional<int> indexOfPair(const std::string& n, const std::string& m) {
    const int order = std::stoi(n), frequency = std::stoi(m);
    if (std::abs(frequency) > order || (order - frequency) % 2 != 0) return std::nullopt;
    return zernikeIndex({.n = order, .m = frequency});
  }

  /// The single index of a term's name: Z5, Z(2,-2), Z2-2, C_4.
  std::optional<int> indexOf(const std::string& cell) const {
    std::smatch parts;
    if (!decimal_point_ && numberIn(cell)) return std::nullopt;  // 6,0 beside semicolons
    static const std::regex pair(
        "[ZzCc]?_?\\(?\\s*(\\d{1,2})\\s*[, _^]\\s*([+-]?\\d{1,2})\\s*\\)?");
    static const std::regex joined("[ZzCc](\\d{1,2})([+-]\\d{1,2})"), digits("[ZzCc](\\d)(\\d)");
    static const std::regex single("[ZzCc]_?\\[?(\\d{1,2})\\]?");
    if (std::regex_match(cell, parts, pair)) return indexOfPair(parts[1], parts[2]);
    if (std::regex_match(cell, parts, joined)) return indexOfPair(parts[1], parts[2]);
    if (signed_names_ && std::regex_match(cell, parts, digits))
      return indexOfPair(parts[1], parts[2]);
    if (std::regex_match(cell, parts, single)) return std::stoi(parts[1]);
    return std::nullopt;
  }
  static std::string withoutUnit(const std::string& cell) {
    static const std::regex unit("\\s*[\\[(_ ]*(um|µm|μm|nm|microns?)[\\])]*$");
    return std::regex_replace(cell, unit, "");
  }
  bool isNamed(const std::string& cell) const { return indexOf(withoutUnit(cell)).has_value(); }

  /// Micrometres in the unit of coefficients that a text names; nothing where it names none.
  std::optional<double> unitIn(int line, const std::string& words) const {
    // "at 555 nm", "lambda = 555", "for 6 mm"
    static const std::regex other("\\d{3,}(\\.\\d+)?[ _-]*nm|(lambda|λ)[ =:]*\\d[\\d.]*|\\d *mm");
    static const std::regex waves("(^|[^a-z])(waves?(?![ -]*(aberr|front))|lambdas?)([^a-z]|$)|λ");
    static const std::regex um("(^|[^a-z])(um|µm|μm|microns?|microm[a-z]*)([^a-z]|$)");
    static const std::regex nm("(^|[^a-z])(nm|nanom[a-z]*)([^a-z]|$)"),
        mm("(^|[^a-z])mm([^a-z]|$)");
    const std::string text = std::regex_replace(lowered(words), other, "");
    if (std::regex_search(text, waves)) {
      fail(line, shown(words) + ": expected micrometres, not waves");
    }
    if (std::regex_search(text, um)) return 1.0;
    if (std::regex_search(text, nm)) return 1e-3;
    if (std::regex_search(text, mm)) fail(line, shown(words) + ": expected um or nm, not mm");
    return std::nullopt;
  }

  /// Takes the unit that a text names, if any; every text must name the same.
  void takeUnit(int line, const std::string& text, std::optional<double>& unit) const {
    const auto named = unitIn(line, text);
    if (named && unit && *named != *unit) {
      fail(line, shown(text) + ": a second unit: expected one for each coefficient");
    }
    if (named) unit = named;
  }
  void takeUnitCell(const Row& row, const std::string& cell, std::optional<double>& unit) const {
    if (!unitIn(row.line, cell)) fail(row.line, "unit = " + shown(cell) + ": expected um or nm");
    takeUnit(row.line, cell, unit);
  }

  /// Micrometres of one of the unit that a heading, a cell of the row or else a comment names.
  double unitOf(const Row& head, int column, const Row& row, int unit_column) const {
    std::optional<double> unit = unit_;
    if (column >= 0) takeUnit(head.line, head.at(column), unit);
    const auto at = static_cast<std::size_t>(unit_column);
    if (at < row.cells.size() && !row.cells[at].empty()) {
      takeUnitCell(row, row.cells[at], unit);
    }
    if (!unit) {
      for (const Row& comment : comments_) takeUnit(comment.line, comment.cells[0], unit);
    }
    if (!unit && wavelength_line_ > 0) {
      fail(wavelength_line_,
           "a wavelength, as for waves, and no unit: expected a heading um or nm");
    }
    return unit.value_or(1.0);
  }

  void set(const Row& row, std::optional<Wavefront>& eye, int index, double um, double pupil_mm) {
    if (index < 0 || index >= zernikeCount(kMaxZernikeOrder)) {
      fail(row.line, "term " + std::to_string(index) + ": expected at most order " +
                         std::to_string(kMaxZernikeOrder) + ", indices 0 to 65");
    }
    if (!(std::abs(um) <= kMost_um)) {
      fail(row.line, "coefficient " + exactText(um) +
                         " um: expected at most 50; a heading nm would make it nanometres");
    }
    if (!eye) eye = Wavefront{.zernike_um = {}, .pupil_m = pupil_mm / 1000.0};
    const auto at = static_cast<std::size_t>(index);
    if (eye->zernike_um.size() <= at) eye->zernike_um.resize(at + 1, 0.0);
    eye->zernike_um[at] = um;
  }

  int sideOf(const Row& row, const std::string& cell) const {
    if (const int side = sideNamed(lowered(cell)); side != 0) return side;
    fail(row.line, "eye = " + shown(cell) + ": expected right, OD, left or OS");
  }

  double pupilInForce() const {
    if (!pupil_mm_) {
      fail(0,
           "no pupil: expected a row such as pupil_mm,6, a column pupil_mm, or the key "
           "observer.wavefront_pupil_mm");
    }
    return *pupil_mm_;
  }

  void readWide() {
    const Row& head = rows_.front();
    int eye_column = -1, pupil_column = -1, unit_column = -1;
    std::set<int> seen;
    for (std::size_t c = 0; c < head.cells.size(); ++c) {
      const auto index = indexOf(withoutUnit(head.cells[c]));
      if (index && !seen.insert(*index).second) failTwice(head, *index);
      if (lowered(head.cells[c]) == "eye") eye_column = static_cast<int>(c);
      if (isUnitColumn(c)) unit_column = static_cast<int>(c);
      if (namesPupil(head.cells[c])) pupil_column = static_cast<int>(c);
    }
    if (rows_.size() < 2) fail(head.line, "a heading without a row of coefficients");
    if (eye_column < 0 && rows_.size() > 2) {
      fail(rows_[2].line, "a second row: expected a column eye, with one row for each eye");
    }
    for (std::size_t r = 1; r < rows_.size(); ++r) {
      Row row = rows_[r];
      if (unit_column == static_cast<int>(row.cells.size())) row.cells.emplace_back();  // blank
      if (row.cells.size() != head.cells.size()) {
        fail(row.line, counted(row.cells.size(), "cell") + ": expected " +
                           std::to_string(head.cells.size()) + ", as in the heading");
      }
      const int side = eye_column < 0 ? 0 : sideOf(row, row.at(eye_column));
      const double pupil_mm = pupil_column < 0
                                  ? pupilInForce()
                                  : pupilOf(row, head.at(pupil_column), row.at(pupil_column));
      std::optional<Wavefront> eye;
      for (std::size_t c = 0; c < head.cells.size(); ++c) {
        const auto index = indexOf(withoutUnit(head.cells[c]));
        if (!index) continue;
        const double unit = unitOf(head, static_cast<int>(c), row, unit_column);
        set(row, eye, *index, unit * number(row, row.cells[c], head.cells[c]), pupil_mm);
      }
      keep(row, side, eye);
    }
  }

  void keep(const Row& row, int side, const std::optional<Wavefront>& eye) {
    for (const int one : {-1, 1}) {
      if (side != 0 && side != one) continue;
      std::optional<Wavefront>& kept = one < 0 ? eyes_.left : eyes_.right;
      if (kept) fail(row.line, "a second row of one eye: expected one row for each eye");
      kept = eye;
    }
  }

  struct Columns {
    int n = -1, m = -1, index = -1, name = -1;
    int value = -1, right = -1, left = -1, eye = -1, pupil = -1, unit = -1;
  };

  Columns columnsOf(const Row& head, bool& has_heading) const {
    Columns columns;
    for (std::size_t c = 0; c < head.cells.size(); ++c) {
      const std::string text = lowered(withoutUnit(head.cells[c]));
      const int at = static_cast<int>(c);
      const auto is = [&](std::initializer_list<const char*> words) {
        return std::ranges::any_of(words, [&](const char* w) { return text == w; });
      };
      if (is({"n"})) columns.n = at;
      if (is({"m"})) columns.m = at;
      if (is({"j", "index", "osa", "ansi", "i", "osa index", "ansi index", "osa_index",
              "ansi_index"})) {
        columns.index = at;
      }
      if (is({"term", "mode", "name", "zernike"})) columns.name = at;
      if (is({"value", "coefficient", "coeff", "c", "", "um", "µm", "nm", "zernike_um"})) {
        columns.value = at;
      }
      if (namesPupil(text)) columns.pupil = at;
      if (is({"eye"})) columns.eye = at;
      if (isUnitColumn(c)) columns.unit = at;
      if (const int side = sideNamed(text); side != 0)
        (side > 0 ? columns.right : columns.left) = at;
    }
    has_heading = columns.value >= 0 || columns.right >= 0 || columns.left >= 0;
    if (has_heading) return columns;
    for (const std::string& cell : head.cells) unitIn(head.line, cell);  // refuses waves and mm
    if (head.cells.size() == 2) return {.index = 0, .name = 0, .value = 1};
    if (head.cells.size() == 3) return {.n = 0, .m = 1, .value = 2};
    fail(head.line,
         "expected a heading: n, m and um; or j and um; or terms such as Z3 and Z(2,-2)");
  }

  int termOf(const Row& row, const Columns& columns) const {
    if (columns.n >= 0 && columns.m >= 0) {
      const double n = number(row, row.at(columns.n), "n"), m = number(row, row.at(columns.m), "m");
      if (n != std::floor(n) || m != std::floor(m) || n < 0.0 || n > kMaxZernikeOrder ||
          std::abs(m) > n || std::fmod(n - m, 2.0) != 0.0) {
        fail(row.line, "n, m = " + exactText(n) + ", " + exactText(m) +
                           ": expected a term up to order 10, |m| at most n, n - m even");
      }
      return zernikeIndex({.n = static_cast<int>(n), .m = static_cast<int>(m)});
    }
    const int column = columns.name >= 0 ? columns.name : columns.index;
    if (column < 0) fail(rows_.front().line, "expected the columns n and m, or j, or term");
    if (const auto named = indexOf(row.at(column))) return *named;
    if (row.at(column).find(',') != std::string::npos) {
      fail(row.line,
           "index " + shown(row.at(column)) + ": expected 0 to 65, or a name such as Z2_0");
    }
    const double index = number(row, row.at(column), "index");
    if (index != std::floor(index))
      fail(row.line, "index " + exactText(index) + ": expected 0 to 65");
    return static_cast<int>(std::clamp(index, -1.0, 1000.0));
  }

  /// The diameter that every row of a long table repeats.
  double pupilOfColumn(const Row& head, int column) const {
    const auto at = static_cast<std::size_t>(column);
    std::optional<double> pupil_mm;
    for (std::size_t r = 1; r < rows_.size(); ++r) {
      const Row& row = rows_[r];
      if (row.cells.size() <= at) fail(row.line, "no pupil: expected one in each row");
      const double mm = pupilOf(row, head.cells[at], row.cells[at]);
      if (pupil_mm && *pupil_mm != mm) {
        fail(row.line, "a second pupil: expected one for the table");
      }
      pupil_mm = mm;
    }
    return pupil_mm ? *pupil_mm : pupilInForce();
  }

  void readLong() {
    bool has_heading = false;
    const Row head = rows_.front();
    const Columns columns = columnsOf(head, has_heading);
    const double pupil_mm =
        has_heading && columns.pupil >= 0 ? pupilOfColumn(head, columns.pupil) : pupilInForce();
    std::set<std::pair<int, int>> seen;  // term and side
    for (std::size_t r = has_heading ? 1 : 0; r < rows_.size(); ++r) {
      const Row& row = rows_[r];
      const int most = std::max({columns.n, columns.m, columns.index, columns.name, columns.value,
                                 columns.right, columns.left, columns.eye});
      if (static_cast<int>(row.cells.size()) <= most) {
        fail(row.line,
             counted(row.cells.size(), "cell") + ": expected at least " + std::to_string(most + 1));
      }
      const int term = termOf(row, columns);
      const int side = columns.eye < 0 ? 0 : sideOf(row, row.at(columns.eye));
      if (!seen.emplace(term, side).second) failTwice(row, term);
      const auto take = [&](int column, std::optional<Wavefront>& eye) {
        if (column < 0) return;
        const double unit = unitOf(head, has_heading ? column : -1, row, columns.unit);
        set(row, eye, term, unit * number(row, row.at(column), "coefficient"), pupil_mm);
      };
      if (side <= 0) take(columns.value, eyes_.left);
      if (side >= 0) take(columns.value, eyes_.right);
      take(columns.right, eyes_.right);
      take(columns.left, eyes_.left);
    }
  }

  std::string file_;
  std::optional<double> pupil_mm_;
  std::vector<Row> rows_;
  std::optional<double> unit_;  ///< micrometres in the unit that a row states
  std::vector<Row> comments_;   ///< each states the unit
  int wavelength_line_ = 0;     ///< of a row that states it
  bool decimal_comma_ = false;
  bool decimal_point_ = false;  ///< in some cell: 3,1 is then a term
  bool signed_names_ = false;   ///< some names are such as Z3-1; Z40 is then n = 4, m = 0
  MeasuredEyes eyes_;
};

}  // namespace

std::vector<std::string> cellsOf(std::string_view line, char separator) {
  std::vector<std::string> cells(1);
  int open = 0;
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == '(') ++open;
    if (c == ')') --open;
    const bool blank = separator == ' ' && (c == ' ' || c == '\t') && cells.back().empty();
    if (blank) continue;
    if (c == separator && open <= 0 && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  if (separator == ' ' && cells.back().empty()) cells.pop_back();
  for (std::string& cell : cells) cell = unquoted(cell);
  return cells;
}

MeasuredEyes readWavefronts(const std::filesystem::path& file, std::optional<double> pupil_mm) {
  return WavefrontTable(file, pupil_mm).read();
}

}  // namespace foci
