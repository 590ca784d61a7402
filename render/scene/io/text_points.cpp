#include "render/scene/io/point_formats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/file_bytes.h"
#include "render/scene/io/ply_header.h"
#include "render/scene/io/scan_values.h"

namespace foci {
namespace {

constexpr std::size_t kMaxColumns = 64;
constexpr float kUnitSlack = 0.02f;  // of a normal's length, which text rounds
constexpr int kNone = -1;
constexpr std::string_view kColmapNames = "POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[]";

/// Aria's points that are less certain are noise (MPS, "threshold the point cloud").
constexpr double kMaxDoubt_m = 0.15, kMaxInverseDoubt_per_m = 0.01;
// Aria's points lie on edges, so their distances say nothing of the surface: each gets the size of
// a pixel of the cameras that found it (150 degrees on 640 pixels) at 2.5 m.
constexpr float kAriaRadius_m = 0.01f;
using Three = std::array<int, 3>;  // columns
constexpr Three kNoThree = {kNone, kNone, kNone};

/// Which column has which value.
struct TextColumns {
  Three position = {0, 1, 2};
  std::array<Three, 2> triples = {kNoThree, kNoThree};  ///< each a colour or a normal
  std::array<char, 2> kinds = {' ', ' '};  ///< 'c' colour, 'n' normal; else its values tell
  int intensity = kNone;
  std::size_t count = 0;           ///< of numbers in a line
  bool more = false;               ///< any number of values may follow them
  bool either = false;             ///< one of the two triples is there: its values tell
  std::optional<double> unit_m{};  ///< of x, y and z
  Three doubt = kNoThree;          ///< standard deviations of distance and of its inverse
  std::string format{};            ///< a name of its own
  bool y_is_down = false;          ///< the convention of cameras
};

using TextWords = std::vector<std::string_view>;

/// Nothing between two commas or semicolons, or before the first, is an empty word.
void splitInto(TextWords& words, std::string_view line, std::string_view blanks = " \t",
               std::string_view marks = ",;") {
  const std::string between = std::string(blanks) + std::string(marks);
  words.clear();
  for (std::size_t at = 0; words.size() <= kMaxColumns; ++at) {  // over the mark behind a word
    at = line.find_first_not_of(blanks, at);
    if (at >= line.size()) return;
    const bool quoted = line[at] == '"';
    const std::size_t end =
        std::min(quoted ? line.find('"', at + 1) : line.find_first_of(between, at), line.size());
    words.push_back(line.substr(at + quoted, end - at - quoted));
    at = std::min(end + quoted, line.size());
    at = std::min(line.find_first_not_of(blanks, at), line.size());
    if (at < line.size() && marks.find(line[at]) == std::string_view::npos) --at;
  }
}

/// The first word between blanks or semicolons with one comma between two digits, as 0,5; empty if
/// there is none, or if commas alone separate the columns.
std::string_view decimalComma(std::string_view line) {
  constexpr std::string_view kBetween = " \t;";
  const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
  if (line.find(',') == std::string_view::npos) return {};  // as in most files
  if (line.find_first_of(kBetween) == std::string_view::npos) return {};
  for (const std::string_view word : wordsOf(line, kBetween)) {
    const std::size_t comma = word.find(',');
    if (comma != std::string_view::npos && comma == word.rfind(',') && comma > 0 &&
        comma + 1 < word.size() && isDigit(word[comma - 1]) && isDigit(word[comma + 1])) {
      return word;
    }
  }
  return {};
}

bool isComment(std::string_view line) { return line.starts_with('#') || line.starts_with("//"); }

/// A column's name in lower case, and the unit behind it: X [m], x(mm), y_ft.
struct ColumnName {
  std::string name, unit;
};

/// Metres, of a unit in brackets.
std::optional<double> metresOf(std::string_view unit) {
  constexpr std::pair<std::string_view, double> kUnits[] = {
      {"m", 1.0},      {"metre", 1.0},   {"meter", 1.0}, {"metres", 1.0},
      {"meters", 1.0}, {"mm", 0.001},    {"cm", 0.01},   {"km", 1000.0},
      {"ft", 0.3048},  {"feet", 0.3048}, {"in", 0.0254}};
  for (const auto& [name, metres] : kUnits) {
    if (name == unit) return metres;
  }
  return std::nullopt;
}

/// The columns that a line names. Blanks do not end a name if another mark does: "X [m];Y [m]".
std::vector<ColumnName> namesIn(std::string_view line) {
  const bool by_blanks = line.find_first_of(",;\t") == std::string_view::npos;
  TextWords words;
  splitInto(words, line, by_blanks ? " " : "\t", by_blanks ? "" : ",;");
  std::vector<ColumnName> names;
  for (const std::string_view word : words) {
    std::size_t open = std::min(word.find_first_of("[("), word.size());
    if (word.size() > 2 && word[1] == '_' && metresOf(lowered(word.substr(2)))) open = 1;
    const std::size_t close = std::min(word.find_first_of("])", open), word.size());
    const std::string unit =
        open < close ? lowered(trimmed(word.substr(open + 1, close - open - 1))) : "";
    if (by_blanks && open == 0 && !names.empty()) {
      names.back().unit = unit;
    } else {
      names.push_back({lowered(trimmed(word.substr(0, open))), unit});
    }
  }
  return names;
}

/// Whether a line names a longitude and a latitude.
bool namesDegrees(std::string_view line) {
  const std::vector<ColumnName> names = namesIn(line);
  const auto has = [&](std::string_view brief, std::string_view whole) {
    return std::ranges::any_of(names, [&](const ColumnName& column) {
      return column.name == brief || column.name.starts_with(whole);
    });
  };
  return (has("lon", "longitude") || has("lng", "longitude")) && has("lat", "latitude");
}

/// The columns that a line of names describes; absent if it does not name x, y and z.
std::optional<TextColumns> columnsNamed(std::string_view line) {
  const std::vector<ColumnName> names = namesIn(line);
  int last = kNone;  // column in use
  const auto columnOf = [&](std::initializer_list<std::string_view> any) {
    for (const std::string_view name : any) {
      const auto found = std::ranges::find(names, name, &ColumnName::name);
      if (found == names.end()) continue;
      const auto column = static_cast<int>(found - names.begin());
      last = std::max(last, column);
      return column;
    }
    return kNone;
  };
  TextColumns columns;
  columns.count = names.size();
  columns.position = {columnOf({"x", "px_world", "easting"}),
                      columnOf({"y", "py_world", "northing"}),
                      columnOf({"z", "pz_world", "elevation", "height"})};
  if (std::ranges::count(columns.position, kNone) > 0) return std::nullopt;
  const auto unitOf = [&](int column) {
    return metresOf(names[static_cast<std::size_t>(column)].unit);
  };
  columns.unit_m = unitOf(columns.position[0]);
  for (const int column : columns.position) {
    if (unitOf(column) != columns.unit_m) columns.unit_m.reset();
  }
  const Three color = {columnOf({"red", "r", "rf"}), columnOf({"green", "g", "gf"}),
                       columnOf({"blue", "b", "bf"})};
  const Three normal = {columnOf({"nx", "normal_x"}), columnOf({"ny", "normal_y"}),
                        columnOf({"nz", "normal_z"})};
  std::size_t triples = 0;
  for (const auto& [kind, three] : {std::pair('c', color), {'n', normal}}) {
    if (std::ranges::count(three, kNone) > 0) continue;
    columns.kinds[triples] = kind;
    columns.triples[triples++] = three;
  }
  columns.intensity = columnOf({"intensity", "i", "reflectance", "reflectivity"});
  if (columnOf({"px_world"}) != kNone) {
    columns.format = "Project Aria scan";
    columns.doubt = {columnOf({"dist_std"}), columnOf({"inv_dist_std"}), kNone};
  }
  const bool numbered = columnOf({"point3d_id"}) != kNone;
  const int before_track = last;
  if (const int track = columnOf({"track"}); numbered && track > before_track) {
    columns.format = "COLMAP points";
    columns.y_is_down = true;
    columns.count = static_cast<std::size_t>(track);
    columns.more = true;
  }
  return columns;
}

/// The columns of a file without names, by their number.
TextColumns columnsOf(std::size_t count, bool counted) {
  TextColumns columns{.count = count};
  if (count == 4 || (count == 7 && counted)) columns.intensity = 3;
  if (count >= 6) columns.triples[0] = {3, 4, 5};
  if (count == 7) columns.triples[counted ? 0 : 1] = {4, 5, 6};
  columns.either = count == 7 && !counted;
  if (count >= 9) columns.triples[1] = {6, 7, 8};
  return columns;
}

/// Values of three columns, which are colours or normals: the whole file decides.
struct Triples {
  std::vector<glm::vec3> values;
  bool unit = true, any = false, negative = false, whole = true;
  float max = 0.0f;

  void append(const glm::vec3& v) {
    const float length = glm::length(v);
    unit = unit && (length == 0.0f || std::abs(length - 1.0f) <= kUnitSlack);
    any = any || length > 0.0f;
    negative = negative || v.x < 0.0f || v.y < 0.0f || v.z < 0.0f;
    whole = whole && v == glm::round(v);
    max = std::max({max, v.x, v.y, v.z});
    values.push_back(v);
  }
  /// Whole numbers above 1, or nothing but 0, are rather a colour than what follows is a normal.
  bool isBytes() const { return !any || (whole && max > 1.0f); }
  bool isNormal() const { return unit && any; }
  bool isColor() const { return !negative && (max <= 1.0f || (whole && max <= 255.0f)); }
};

class TextPointsReader {
 public:
  explicit TextPointsReader(const std::filesystem::path& path)
      : input_(path), is_pts_(unpackedExtension(path) == ".pts") {
    // COLMAP's names stand in comments, which other programs leave out.
    if (path.stem() == "points3D") name(columnsNamed(kColmapNames));
  }

  PointCloud read() {
    if (input_.remaining() == 0) throw InputError(input_.name(), "is empty");
    while (input_.remaining() > 0) {
      ++line_;
      const std::string_view line = input_.line();
      takeLine(trimmed(line_ == 1 ? withoutByteOrderMark(line) : line));
    }
    if (counted_ && rows_ < *counted_) {
      throw InputError(where(), "ends after ", rows_, " of ", *counted_, " points");
    }
    if (counted_ && rows_ > *counted_) {
      points_.remarks.push_back("states " + counted(*counted_, "point") + ", and has " +
                                std::to_string(rows_) +
                                ": correct that number, or remove the lines that are no points");
    }
    if (points_.size() == 0 && uncertain_ > 0) {
      throw InputError(input_.name(), "none of its points is certain enough");
    }
    positions_.finish(input_.name());
    finishColumns();
    takeStatements();
    return std::move(points_);
  }

 private:
  std::string where() const { return input_.name() + ":" + std::to_string(line_); }

  void takeLine(std::string_view line) {
    const bool comment = isComment(line);
    if (comment) line.remove_prefix(std::min(line.find_first_not_of("#/ \t"), line.size()));
    splitInto(words_, line);
    if (std::ranges::all_of(words_, [](std::string_view word) { return word.empty(); })) return;
    // Spreadsheets write as many marks in each line as the longest has.
    const std::size_t least = columns_ ? columns_->count : 0;
    while (words_.size() > least && words_.back().empty()) words_.pop_back();
    if (line.ends_with(',') || line.ends_with(';')) words_.resize(std::max(words_.size(), least));
    if (words_.size() > kMaxColumns && !(columns_ && columns_->more)) {
      throw InputError(where(), "has more than ", kMaxColumns, " columns");
    }
    const bool names = !columns_ && !numberOf(words_[0]);
    if (names) name(columnsNamed(line));
    if (names && !columns_ && namesDegrees(line)) {
      throw InputError(where(),
                       "has longitude and latitude in degrees: expected x y z in one unit; project "
                       "them to metres, e.g. with QGIS or pdal's filters.reprojection");
    }
    if (names && line.find("f_dc_0") != std::string_view::npos) {
      throw InputError(where(), "has Gaussians as text: splat-transform makes a PLY of it");
    }
    if (comment || (names && columns_)) return;
    if (words_.size() == 1 && !(columns_ && columns_->more)) {
      if (const auto count = parseInteger<std::uint32_t>(words_[0])) {
        if (counted_ && rows_ == 0) {
          throw InputError(input_.name(),
                           "begins with two numbers, as PTX, which foci does not read: "
                           "CloudCompare, or pdal translate IN OUT.ply, makes a PLY of it");
        }
        counted_ = counted_.value_or(0) + *count;
        return;
      }
    }
    if (const std::string_view word = decimalComma(line); !word.empty()) {
      throw InputError(where(), shown(word),
                       " is a number with a decimal comma, or two columns: write decimal points "
                       "(sed 's/,/./g'), or separate all columns alike");
    }
    takeRow();
  }

  /// Whether a line without names has row and column of a scanner, x y z with decimals, then a
  /// colour or an intensity of whole numbers. Coordinates of a map have more digits.
  bool isGridOfFaro() const {
    constexpr std::size_t kDigits = 5;
    const bool fits = words_.size() == 8 || (words_.size() == 6 && row_[5] > 1.0);
    if (!fits || counted_) return false;
    for (std::size_t i = 0; i < words_.size(); ++i) {
      const bool whole = words_[i].find_first_not_of("0123456789") == std::string_view::npos;
      if (whole != (i < 2 || i > 4) || (whole && words_[i].size() > kDigits)) return false;
    }
    return true;
  }

  void takeRow() {
    row_.clear();
    for (const std::string_view word : words_) {
      if (columns_ && columns_->more && row_.size() == columns_->count) break;
      // Text, such as the name of a recording, may stand in a column that is not used.
      const auto value = isUsed(row_.size()) ? numberOf(word) : 0.0;
      if (!value) throw InputError(where(), "expected a number, found ", shown(word));
      row_.push_back(*value);
    }
    if (!columns_) {
      if (row_.size() < 3) throw InputError(where(), "expected x y z, a point in each line");
      if (row_.size() == 5) {
        throw InputError(where(),
                         "has 5 columns without names: put a line of names before the points, e.g. "
                         "x y z intensity class");
      }
      if (isGridOfFaro()) {
        name(columnsNamed(row_.size() == 8 ? "row column x y z r g b" : "row column x y z i"));
        points_.remarks.emplace_back(
            "its first two columns are taken for rows and columns of the scanner, as FARO writes "
            "them; if not, put a line of names before the points");
      } else {
        columns_ = columnsOf(row_.size(), counted_.has_value());
        const std::size_t used = row_.size() < 9 ? 6 : 9;
        if (row_.size() > 7 && row_.size() > used) {
          points_.remarks.push_back("the columns after the first " + std::to_string(used) +
                                    " have no names: left out");
        }
      }
    }
    if (row_.size() != columns_->count) {
      throw InputError(where(), "has ", row_.size(), " numbers: expected ", columns_->count,
                       ", as in the lines before");
    }
    ++rows_;
    if (isUncertain()) {
      ++uncertain_;
      return;
    }
    const auto at = [&](const Three& three) {
      const auto value = [&](int i) { return row_[static_cast<std::size_t>(three[i])]; };
      return glm::dvec3(value(0), value(1), value(2));
    };
    if (!positions_.append(at(columns_->position))) return;
    for (std::size_t t = 0; t < triples_.size(); ++t) {
      if (columns_->triples[t][0] == kNone) continue;
      const glm::dvec3 v = at(columns_->triples[t]);
      if (std::abs(v.x) < 1e6 && std::abs(v.y) < 1e6 && std::abs(v.z) < 1e6) {
        triples_[t].append(glm::vec3(v));
      } else if (columns_->either) {
        triples_[t].append(glm::vec3(-1.0f));  // no colour, no normal
      } else {
        throw InputError(where(), "expected a colour or a normal after the position");
      }
    }
    if (columns_->intensity != kNone) {
      const double value = row_[static_cast<std::size_t>(columns_->intensity)];
      intensity_.push_back(std::abs(value) < 1e30 ? static_cast<float>(value) : 0.0f);
    }
  }

  void name(std::optional<TextColumns> columns) {
    columns_ = std::move(columns);
    if (!columns_) return;
    used_.assign(columns_->count, false);
    const auto use = [&](int column) {
      if (column != kNone) used_[static_cast<std::size_t>(column)] = true;
    };
    for (const Three& three :
         {columns_->position, columns_->triples[0], columns_->triples[1], columns_->doubt}) {
      for (const int column : three) use(column);
    }
    use(columns_->intensity);
  }

  bool isUsed(std::size_t column) const { return column >= used_.size() || used_[column]; }

  /// Whether the row's point is less certain than kMaxDoubt_m or kMaxInverseDoubt_per_m.
  bool isUncertain() const {
    const auto exceeds = [&](int column, double most) {
      return column != kNone && row_[static_cast<std::size_t>(column)] > most;
    };
    return exceeds(columns_->doubt[0], kMaxDoubt_m) ||
           exceeds(columns_->doubt[1], kMaxInverseDoubt_per_m);
  }

  /// What the file says of its points, and what was left out.
  void takeStatements() {
    points_.format = columns_->format;
    points_.y_is_down = columns_->y_is_down;
    points_.unit_m = columns_->unit_m;
    if (columns_->doubt == kNoThree) return;
    points_.unit_m = 1.0;  // metres, and gravity along -z
    points_.up_axis = 2;
    points_.radius_m.assign(points_.size(), kAriaRadius_m);
    if (uncertain_ == 0) return;
    points_.remarks.push_back(thousands(static_cast<double>(uncertain_)) +
                              " points are less certain than " + exactText(kMaxDoubt_m) +
                              " m, or " + exactText(kMaxInverseDoubt_per_m) +
                              " per m of inverse distance: left out");
  }

  /// Of seven columns, the fourth may be an intensity, or the seventh another value.
  void chooseTriple() {
    Triples &first = triples_[0], &second = triples_[1];
    const bool second_fits = second.isNormal() || second.isColor();
    const bool is_first =
        !(is_pts_ && second_fits) &&
        (first.isNormal() || (first.isColor() && (first.isBytes() || !second.isNormal())));
    if (!is_pts_ && second_fits && !first.isNormal() && first.isColor()) {
      points_.remarks.push_back(std::string("its 7 columns have no names: taken for x y z, ") +
                                (is_first ? "a colour and a value that is left out"
                                          : "a value that is left out and a normal") +
                                "; if they are others, as x y z, intensity and a colour, put a "
                                "line of names before them");
    }
    if (!is_first && second_fits) std::swap(first, second);
    second.values.clear();
  }

  /// Colours and normals from the triples, once all are known.
  void finishColumns() {
    if (columns_->either) chooseTriple();
    for (std::size_t t = 0; t < triples_.size(); ++t) {
      Triples& triple = triples_[t];
      const char kind = columns_->kinds[t];
      if (triple.values.empty()) continue;
      if (!triple.any) {  // an exporter's place for what it did not have
        points_.remarks.push_back("the columns of colour or normal are all 0: left out");
        continue;
      }
      if (kind == 'n' || (kind == ' ' && triple.isNormal())) {
        if (!points_.normal.empty()) continue;
        for (glm::vec3& n : triple.values) n = unitNormal(n);
        points_.normal = std::move(triple.values);
      } else if (points_.color.empty()) {
        takeColors(triple);
      }
    }
    if (points_.color.empty() && !intensity_.empty()) points_.color = greyOf(intensity_);
    if (points_.color.empty()) {
      points_.color.assign(points_.size(), glm::vec3(kUncolouredLight));
    }
  }

  void takeColors(Triples& triple) {
    if (triple.negative || triple.max > 65535.0f) {
      throw InputError(
          input_.name(),
          "has numbers after its positions that are neither colours (0 to 1, 0 to 255 "
          "or 0 to 65535) nor normals (of length 1): put a line of names before the points");
    }
    const float white = triple.max <= 1.0f ? 1.0f : triple.max <= 255.0f ? 255.0f : 65535.0f;
    for (glm::vec3& c : triple.values) c = linearColor(c / white);
    points_.color = std::move(triple.values);
    remarkDark(points_);
  }

  ply::Input input_;
  PointCloud points_;
  ScanPositions positions_{points_};
  bool is_pts_;
  std::uint64_t line_ = 0, rows_ = 0;
  std::optional<std::uint64_t> counted_;
  std::uint64_t uncertain_ = 0;
  std::optional<TextColumns> columns_;
  std::vector<bool> used_;  // of the columns with names
  std::array<Triples, 2> triples_;
  std::vector<float> intensity_;
  TextWords words_;
  std::vector<double> row_;
};

}  // namespace

bool startsWithPoints(const std::filesystem::path& path) {
  try {
    ply::Input input(path);
    TextWords words;
    for (bool first = true; input.remaining() > 0; first = false) {
      std::string_view line = input.line();
      line = trimmed(first ? withoutByteOrderMark(line) : line);
      if (line.empty() || isComment(line)) continue;
      if (columnsNamed(line)) return true;
      splitInto(words, line);
      if (words.size() == 1) return parseInteger<std::uint32_t>(words[0]).has_value();
      return words.size() > 2 &&
             (namesDegrees(line) ||
              std::all_of(words.begin(), words.begin() + 3,
                          [](std::string_view word) { return numberOf(word).has_value(); }));
    }
  } catch (const InputError&) {
    // Not for this reader.
  }
  return false;
}

PointCloud readTextPoints(const std::filesystem::path& path) {
  return TextPointsReader(path).read();
}

}  // namespace foci
