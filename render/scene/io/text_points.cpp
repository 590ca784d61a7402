#include "render/scene/io/text_points.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/file.h"
#include "base/input_error.h"
#include "base/number.h"
#include "base/text.h"
#include "render/image/srgb.h"
#include "render/scene/io/ply_header.h"
#include "render/scene/io/scan_values.h"

namespace foci {
namespace {

constexpr std::size_t kMaxColumns = 64;
constexpr float kUnitSlack = 0.02f;  // of a normal's length, which text rounds
constexpr int kNone = -1;
using Three = std::array<int, 3>;  // columns
constexpr Three kNoThree = {kNone, kNone, kNone};

/// Which column has which value.
struct TextColumns {
  Three position = {0, 1, 2};
  std::array<Three, 2> triples = {kNoThree, kNoThree};  ///< each a colour or a normal
  int intensity = kNone;
  std::size_t count = 0;  ///< of numbers in a line
};

using TextWords = std::vector<std::string_view>;

void splitInto(TextWords& words, std::string_view line) {
  constexpr std::string_view kBetween = " \t,;";
  words.clear();
  for (std::size_t at = 0; words.size() <= kMaxColumns;) {
    at = line.find_first_not_of(kBetween, at);
    if (at == std::string_view::npos) return;
    const bool quoted = line[at] == '"';
    const std::size_t end =
        std::min(quoted ? line.find('"', at + 1) : line.find_first_of(kBetween, at), line.size());
    words.push_back(line.substr(at + quoted, end - at - quoted));
    at = std::min(end + quoted, line.size());
  }
}

/// The first word between blanks or semicolons with one comma between two digits, as 0,5; empty if
/// there is none, or if commas alone separate the columns.
std::string_view decimalComma(std::string_view line) {
  constexpr std::string_view kBetween = " \t;";
  const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
  if (line.find(',') == std::string_view::npos) return {};  // as in most files
  if (line.find_first_of(kBetween) == std::string_view::npos) return {};
  for (std::size_t at = 0; (at = line.find_first_not_of(kBetween, at)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBetween, at), line.size());
    const std::string_view word = line.substr(at, end - at);
    const std::size_t comma = word.find(',');
    if (comma != std::string_view::npos && comma == word.rfind(',') && comma > 0 &&
        comma + 1 < word.size() && isDigit(word[comma - 1]) && isDigit(word[comma + 1])) {
      return word;
    }
    at = end;
  }
  return {};
}

/// A number, "nan" and "inf" among them.
std::optional<double> numberOf(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error == std::errc::invalid_argument) return std::nullopt;
  return error == std::errc() ? value : HUGE_VAL;  // too small a number is as useless as too large
}

bool isComment(std::string_view line) { return line.starts_with('#') || line.starts_with("//"); }

/// Words of a line of names in lower case, without a unit such as [m] or (m).
std::vector<std::string> namesIn(const TextWords& words) {
  std::vector<std::string> names;
  names.reserve(words.size());
  for (const std::string_view word : words) {
    std::string name(trimmed(word.substr(0, word.find_first_of("[("))));
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    names.push_back(std::move(name));
  }
  return names;
}

/// Whether a line names a longitude and a latitude.
bool namesDegrees(const TextWords& words) {
  const std::vector<std::string> names = namesIn(words);
  const auto has = [&](std::string_view brief, std::string_view whole) {
    return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      return name == brief || name.starts_with(whole);
    });
  };
  return (has("lon", "longitude") || has("lng", "longitude")) && has("lat", "latitude");
}

/// The columns that a line of names describes; absent if it does not name x, y and z.
std::optional<TextColumns> columnsNamed(const TextWords& words) {
  const std::vector<std::string> names = namesIn(words);
  const auto columnOf = [&](std::initializer_list<std::string_view> any) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (std::find(any.begin(), any.end(), names[i]) != any.end()) return static_cast<int>(i);
    }
    return kNone;
  };
  TextColumns columns;
  columns.count = words.size();
  columns.position = {columnOf({"x"}), columnOf({"y"}), columnOf({"z"})};
  if (std::count(columns.position.begin(), columns.position.end(), kNone) > 0) return std::nullopt;
  const Three color = {columnOf({"r", "red"}), columnOf({"g", "green"}), columnOf({"b", "blue"})};
  const Three normal = {columnOf({"nx"}), columnOf({"ny"}), columnOf({"nz"})};
  std::size_t triples = 0;
  for (const Three& three : {color, normal}) {
    if (std::count(three.begin(), three.end(), kNone) == 0) columns.triples[triples++] = three;
  }
  columns.intensity = columnOf({"intensity", "i", "reflectance"});
  return columns;
}

/// The columns of a file without names, by their number.
TextColumns columnsOf(std::size_t count, bool counted) {
  TextColumns columns{.count = count};
  if (count == 4 || (count == 7 && counted)) columns.intensity = 3;
  if (count >= 6) columns.triples[0] = {3, 4, 5};
  if (count == 7 && counted) columns.triples[0] = {4, 5, 6};
  if (count >= 9) columns.triples[1] = {6, 7, 8};
  return columns;
}

/// Values of three columns, which are colours or normals: the whole file decides.
struct Triples {
  std::vector<glm::vec3> values;
  bool unit = true, any = false, negative = false;
  float max = 0.0f;

  void append(const glm::vec3& v) {
    const float length = glm::length(v);
    unit = unit && (length == 0.0f || std::abs(length - 1.0f) <= kUnitSlack);
    any = any || length > 0.0f;
    negative = negative || v.x < 0.0f || v.y < 0.0f || v.z < 0.0f;
    max = std::max({max, v.x, v.y, v.z});
    values.push_back(v);
  }
  bool isNormal() const { return unit && any; }
};

class TextPointsReader {
 public:
  explicit TextPointsReader(const std::filesystem::path& path) : input_(path) {}

  PointCloud read() {
    if (input_.remaining() == 0) throw InputError(input_.name(), "is empty");
    while (input_.remaining() > 0) {
      ++line_;
      const std::string_view line = input_.line();
      takeLine(trimmed(line_ == 1 ? withoutByteOrderMark(line) : line));
    }
    if (counted_ && rows_ < *counted_) {
      throw InputError(where(), "ends after " + std::to_string(rows_) + " of " +
                                    std::to_string(*counted_) + " points");
    }
    if (points_.size() == 0) {
      throw InputError(input_.name(), points_.dropped == 0
                                          ? "has no points"
                                          : "none of its points has a finite position");
    }
    positions_.finish();
    finishColumns();
    return std::move(points_);
  }

 private:
  std::string where() const { return input_.name() + ":" + std::to_string(line_); }

  void takeLine(std::string_view line) {
    const bool comment = isComment(line);
    if (comment) line.remove_prefix(std::min(line.find_first_not_of("#/ \t"), line.size()));
    splitInto(words_, line);
    if (words_.empty()) return;
    if (words_.size() > kMaxColumns) {
      throw InputError(where(), "has more than " + std::to_string(kMaxColumns) + " columns");
    }
    const bool names = !columns_ && !numberOf(words_[0]);
    if (names) columns_ = columnsNamed(words_);
    if (names && !columns_ && namesDegrees(words_)) {
      throw InputError(where(),
                       "has longitude and latitude in degrees: expected x y z in one unit; project "
                       "them to metres, e.g. with QGIS or pdal's filters.reprojection");
    }
    if (comment || (names && columns_)) return;
    if (words_.size() == 1) {
      if (const auto count = parseInteger<std::uint32_t>(words_[0])) {
        counted_ = counted_.value_or(0) + *count;
        return;
      }
    }
    if (const std::string_view word = decimalComma(line); !word.empty()) {
      throw InputError(where(),
                       shown(word) +
                           " is a number with a decimal comma, or two columns: write "
                           "decimal points (sed 's/,/./g'), or separate all columns alike");
    }
    takeRow();
  }

  void takeRow() {
    row_.clear();
    for (const std::string_view word : words_) {
      const auto value = numberOf(word);
      if (!value) throw InputError(where(), "expected a number, found " + shown(word));
      row_.push_back(*value);
    }
    if (!columns_) {
      if (row_.size() < 3) throw InputError(where(), "expected x y z, a point in each line");
      if (row_.size() == 5) {
        throw InputError(where(),
                         "has 5 columns without names: put a line of names before the points, e.g. "
                         "x y z intensity class");
      }
      columns_ = columnsOf(row_.size(), counted_.has_value());
      if (const std::size_t used = row_.size() < 9 ? 6 : 9; row_.size() > 7 && row_.size() > used) {
        points_.remarks.push_back("the columns after the first " + std::to_string(used) +
                                  " have no names: left out");
      }
    }
    if (row_.size() != columns_->count) {
      throw InputError(where(), "has " + std::to_string(row_.size()) + " numbers: expected " +
                                    std::to_string(columns_->count) + ", as in the lines before");
    }
    ++rows_;
    const auto at = [&](const Three& three) {
      const auto value = [&](int i) { return row_[static_cast<std::size_t>(three[i])]; };
      return glm::dvec3(value(0), value(1), value(2));
    };
    if (!positions_.append(at(columns_->position))) return;
    for (std::size_t t = 0; t < triples_.size(); ++t) {
      if (columns_->triples[t][0] == kNone) continue;
      const glm::dvec3 v = at(columns_->triples[t]);
      if (!(std::abs(v.x) < 1e6 && std::abs(v.y) < 1e6 && std::abs(v.z) < 1e6)) {
        throw InputError(where(), "expected a colour or a normal after the position");
      }
      triples_[t].append(glm::vec3(v));
    }
    if (columns_->intensity != kNone) {
      const double value = row_[static_cast<std::size_t>(columns_->intensity)];
      intensity_.push_back(std::abs(value) < 1e30 ? static_cast<float>(value) : 0.0f);
    }
  }

  /// Colours and normals from the triples, once all are known.
  void finishColumns() {
    for (Triples& triple : triples_) {
      if (triple.values.empty()) continue;
      if (!triple.any) {  // an exporter's place for what it did not have
        points_.remarks.push_back("the columns of colour or normal are all 0: left out");
        continue;
      }
      if (triple.isNormal()) {
        if (!points_.normal.empty()) continue;
        for (glm::vec3& n : triple.values) {
          if (n != glm::vec3(0.0f)) n = glm::normalize(n);
        }
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
      throw InputError(input_.name(),
                       "has numbers after its positions that are neither colours (0 to 1, 0 to "
                       "255 or 0 to 65535) nor normals (of length 1)");
    }
    const float white = triple.max <= 1.0f ? 1.0f : triple.max <= 255.0f ? 255.0f : 65535.0f;
    for (glm::vec3& c : triple.values) {
      c = {linearFromSrgb(c.x / white), linearFromSrgb(c.y / white), linearFromSrgb(c.z / white)};
    }
    points_.color = std::move(triple.values);
    remarkDark(points_);
  }

  ply::Input input_;
  PointCloud points_;
  ScanPositions positions_{points_};
  std::uint64_t line_ = 0, rows_ = 0;
  std::optional<std::uint64_t> counted_;
  std::optional<TextColumns> columns_;
  std::array<Triples, 2> triples_;
  std::vector<float> intensity_;
  TextWords words_;
  std::vector<double> row_;
};

/// Whether the first line that is no comment starts with a number, or names x, y and z.
bool startsWithPoints(const std::filesystem::path& path) {
  ply::Input input(path);
  TextWords words;
  for (bool first = true; input.remaining() > 0; first = false) {
    std::string_view line = input.line();
    line = trimmed(first ? withoutByteOrderMark(line) : line);
    if (line.empty() || isComment(line)) continue;
    splitInto(words, line);
    return !words.empty() &&
           (numberOf(words[0]) || columnsNamed(words) || (words.size() > 2 && namesDegrees(words)));
  }
  return false;
}

}  // namespace

bool isTextPointsFile(const std::filesystem::path& path) {
  const std::string extension = lowerExtension(path);
  if (extension == ".xyz" || extension == ".pts" || extension == ".asc" || extension == ".pwn") {
    return true;
  }
  if (extension != ".txt" && extension != ".csv") return false;
  try {
    return startsWithPoints(path);
  } catch (const InputError&) {
    return false;
  }
}

PointCloud readTextPoints(const std::filesystem::path& path) {
  return TextPointsReader(path).read();
}

}  // namespace foci
