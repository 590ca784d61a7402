// Whose rows a table holds: of several people, of one eye each, of other devices between the gaze.
// The limits were chosen by hand. Only the first rows are judged; whoever reads on notices a second
// person later.
#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "base/quantile.h"
#include "base/text.h"
#include "gaze/sources/column_names.h"
#include "gaze/sources/table_layout.h"

namespace foci {
namespace {

constexpr std::size_t kMaxValues = 12;   // of a column that tells groups apart
constexpr std::size_t kMinRuns = 3;      // of foreign rows; fewer are chance
constexpr std::size_t kMinPlaces = 100;  // fewer show no groups
constexpr double kAlternates = 0.3;      // share of rows whose value is not that before
constexpr double kFarApart = 5.0;        // times the distance within a group
constexpr double kBetween = 1.5;         // usual intervals: no sample is lost in between
// Samples have a clock: hardly any follows sooner than this share of the usual interval. Where
// samples are lost at random, a third of those that are left does.
constexpr double kSoon = 0.7, kMaxSoon = 0.2;

constexpr std::string_view kPeople =
    "participant subject sub subj person user respondent observer player patient recording pid "
    "ppid ppt vp recordingsession datafile edffile";
constexpr std::string_view kOfPeople = "name id no nr num number code label n";  // behind them
// Numbers tell the eye only in a column of such a name: "eye_open" has them, too.
constexpr std::string_view kEyeNames =
    "eye eyes eyeid eyeindex eyeidx eyenr eyeno eyenumber eyenum whicheye eyetracked recordedeye "
    "viewindex side";
constexpr std::string_view kDevices =
    "sensor sensortype device devicename source eventsource stream streamname modality datatype "
    "rowtype sampletype";

/// "participant", "subject_nr"
bool namesPeople(std::string_view key) {
  if (key == "username" || isWordOf(kPeople, key)) return true;
  return std::ranges::any_of(wordsOf(kOfPeople), [&](std::string_view end) {
    return key.ends_with(end) && isWordOf(kPeople, key.substr(0, key.size() - end.size()));
  });
}

/// 0: left, 1: right.
std::optional<std::size_t> sideNamed(std::string_view value) {
  std::string word = lowered(value);
  std::erase_if(word, [](char c) { return c == ' ' || c == '_'; });
  if (isWordOf("l left lefteye os", word)) return 0;
  if (isWordOf("r right righteye od", word)) return 1;
  return std::nullopt;
}

/// A surveyed row: its time, its gaze, and its values in the columns that may tell groups apart.
struct Seen {
  std::optional<double> time{};
  bool has_gaze = false, is_blank = true;  // blank: neither gaze nor validity
  std::optional<glm::dvec2> place{};
  std::vector<std::string> values{};
};

class Survey {
 public:
  Survey(Rows& rows, const ColumnNames& names, const TableLayout& layout)
      : rows_(rows), names_(names), layout_(layout) {
    findCandidates();
    std::vector<std::size_t> gaze;
    for (const ColumnRole& role : layout.roles) {
      if (role.kind == ColumnRole::Kind::gaze) gaze.push_back(role.column);
    }
    rows_.survey(kSurveyedRows, [&] {
      Seen seen{.has_gaze = layout.isFilled(rows, false), .is_blank = !layout.isFilled(rows, true)};
      if (layout_.time && *layout_.time < rows_.size()) seen.time = rows_.number(*layout_.time);
      seen.place = placeOf(gaze);
      for (const std::size_t at : candidates_) {
        seen.values.emplace_back(at < rows_.size() ? rows_.text(at) : "");
      }
      seen_.push_back(std::move(seen));
    });
  }

  const std::vector<Seen>& seen() const { return seen_; }
  const std::vector<std::size_t>& candidates() const { return candidates_; }

  /// The intervals between the rows that `isOf` picks.
  template <class IsOf>
  std::vector<double> intervals(const IsOf& isOf) const {
    std::vector<double> intervals;
    std::optional<double> before;
    for (const Seen& row : seen_) {
      if (!row.time || !isOf(row)) continue;
      if (before && *row.time > *before) intervals.push_back(*row.time - *before);
      before = row.time;
    }
    return intervals;
  }

  /// The usual one of them.
  template <class IsOf>
  std::optional<double> interval(const IsOf& isOf) const {
    auto all = intervals(isOf);
    return all.empty() ? std::nullopt : std::optional(quantile(all, 0.5));
  }

  /// Whether the rows that `isOf` picks may follow a clock of their own: their intervals are
  /// regular, or not even those of all rows are.
  template <class IsOf>
  bool mayHaveClock(const IsOf& isOf) const {
    return areRegular(isOf) || !areRegular([](const Seen&) { return true; });
  }

 private:
  template <class IsOf>
  bool areRegular(const IsOf& isOf) const {
    auto all = intervals(isOf);
    if (all.empty()) return true;
    const double soon = kSoon * quantile(all, 0.5);
    const auto count = std::ranges::count_if(all, [&](double each) { return each < soon; });
    return static_cast<double>(count) <= kMaxSoon * static_cast<double>(all.size());
  }

  std::optional<glm::dvec2> placeOf(const std::vector<std::size_t>& gaze) const {
    if (gaze.size() < 2 || std::max(gaze[0], gaze[1]) >= rows_.size()) return std::nullopt;
    const auto x = rows_.number(gaze[0]), y = rows_.number(gaze[1]);
    return x && y ? std::optional(glm::dvec2(*x, *y)) : std::nullopt;
  }

  /// Unused columns of few values.
  void findCandidates() {
    std::vector<std::vector<std::string>> values(names_.size());
    rows_.survey(kSurveyedRows, [&] {
      for (std::size_t i = 0; i < std::min(values.size(), rows_.size()); ++i) {
        if (values[i].size() > kMaxValues || rows_.areNumbers()) continue;
        const std::string_view text = rows_.text(i);
        if (std::ranges::find(values[i], text) == values[i].end()) values[i].emplace_back(text);
      }
    });
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!values[i].empty() && values[i].size() <= kMaxValues && !layout_.uses(i)) {
        candidates_.push_back(i);
      }
    }
  }

  Rows& rows_;
  const ColumnNames& names_;
  const TableLayout& layout_;
  std::vector<std::size_t> candidates_{};
  std::vector<Seen> seen_{};
};

/// The values of a candidate column that are not empty, in order of appearance.
std::vector<std::string> valuesOf(const Survey& survey, std::size_t candidate, bool with_gaze) {
  std::vector<std::string> values;
  for (const Seen& row : survey.seen()) {
    const std::string& value = row.values[candidate];
    if (value.empty() || (with_gaze && !row.has_gaze)) continue;
    if (std::ranges::find(values, value) == values.end()) values.push_back(value);
  }
  return values;
}

/// Whether a row often has another value than the row before that has one. The side of a stimulus
/// rests for long.
bool alternates(const Survey& survey, std::size_t candidate) {
  const std::string* before = nullptr;
  std::size_t changes = 0, count = 0;
  for (const Seen& row : survey.seen()) {
    const std::string& value = row.values[candidate];
    if (value.empty()) continue;
    changes += before && value != *before;
    before = &value;
    ++count;
  }
  return static_cast<double>(changes) >= kAlternates * static_cast<double>(count);
}

/// Whether rows of a column's values alternate and look at places far apart, each group at its own.
bool areApart(const Survey& survey, std::size_t candidate) {
  std::map<std::string, glm::dvec2> last_of;
  std::map<std::string, std::size_t> counts;
  std::vector<double> within, across;
  std::optional<glm::dvec2> before;
  std::string before_value;
  std::size_t changes = 0, count = 0;
  for (const Seen& row : survey.seen()) {
    const std::string& value = row.values[candidate];
    if (!row.place || value.empty()) continue;
    ++count;
    ++counts[value];
    const auto own = last_of.find(value);
    if (own != last_of.end()) within.push_back(glm::distance(own->second, *row.place));
    if (before && value != before_value) {
      across.push_back(glm::distance(*before, *row.place));
      ++changes;
    }
    last_of.insert_or_assign(value, *row.place);
    before = row.place;
    before_value = value;
  }
  if (counts.size() < 2) return false;
  const auto least =
      std::ranges::min_element(counts, {}, [](const auto& each) { return each.second; });
  const bool enough = count >= kMinPlaces && 10 * least->second >= count;
  if (!enough || within.empty() || across.empty()) return false;
  if (static_cast<double>(changes) < kAlternates * static_cast<double>(count)) return false;
  return quantile(across, 0.5) > kFarApart * quantile(within, 0.5);
}

class Grouper {
 public:
  Grouper(const Survey& survey, const ColumnNames& names, const TableLayout& layout,
          RowGroups& groups)
      : survey_(survey), names_(names), layout_(layout), groups_(groups) {}

  void group(bool of_samples) {
    findPeople();
    findEye();
    findDevice();
    if (!of_samples) findForeign();
    if (!groups_.eye) findOthers();
    findWatched();
  }

 private:
  /// Of people, or named by the study.
  bool isKnown(std::size_t column) const {
    return std::ranges::find(groups_.people, column) != groups_.people.end() ||
           std::ranges::find(groups_.only, column, &ValueColumn::at) != groups_.only.end();
  }

  void findPeople() {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (namesPeople(names_.key(i)) && !layout_.uses(i) && !isKnown(i))
        groups_.people.push_back(i);
    }
  }

  /// Plain tables' other columns of few values: whoever reads on sees whether they change.
  void findWatched() {
    if (!layout_.isPlain()) return;
    for (std::size_t i = 0; i < survey_.candidates().size(); ++i) {
      const std::size_t column = survey_.candidates()[i];
      const bool of_device = groups_.device && groups_.device->at == column;
      if (isKnown(column) || groups_.eye == column || of_device) continue;
      if (!valuesOf(survey_, i, false).empty()) groups_.watched.push_back(column);
    }
  }

  void findEye() {
    for (std::size_t i = 0; i < survey_.candidates().size(); ++i) {
      auto values = valuesOf(survey_, i, true);
      const bool has_both =
          std::erase_if(values, [](const std::string& value) {
            return isWordOf("b both binocular cyclopean combined average avg mean", lowered(value));
          }) > 0;
      if (values.size() != 2) continue;
      const auto first = sideNamed(values[0]), second = sideNamed(values[1]);
      const std::string& key = names_.key(survey_.candidates()[i]);
      const bool of_eye = isWordOf(kEyeNames, key);
      const auto a = parseNumber(values[0]), b = parseNumber(values[1]);
      const bool sides = first && second && *first != *second;
      const bool is_certain = of_eye && key != "side" && !has_both;
      if (sides && (is_certain || alternates(survey_, i))) {
        groups_.eyes[*first] = values[0];
        groups_.eyes[*second] = values[1];
      } else if (of_eye && a && b && std::abs(*a - *b) == 1.0) {
        groups_.eyes = {*a < *b ? values[0] : values[1], *a < *b ? values[1] : values[0]};
        groups_.eyes_assumed = true;
      } else {
        continue;
      }
      const auto interval =
          survey_.interval([&](const Seen& row) { return row.values[i] == groups_.eyes[0]; });
      if (!interval) continue;
      groups_.eye = survey_.candidates()[i];
      groups_.eye_interval = *interval;
      return;
    }
  }

  /// A column that names devices, some of which have gaze.
  void findDevice() {
    if (layout_.rows.column) return;
    for (std::size_t i = 0; i < survey_.candidates().size(); ++i) {
      const std::size_t column = survey_.candidates()[i];
      if (!isWordOf(kDevices, names_.key(column))) continue;
      ValueColumn device{.at = column, .values = valuesOf(survey_, i, true)};
      if (device.values.empty()) continue;
      groups_.device = std::move(device);
      return;
    }
  }

  /// Rows without gaze in a regular pattern: between samples that are a usual interval apart.
  void findForeign() {
    if (layout_.rows.column || groups_.device) return;
    const auto usual = survey_.interval([](const Seen& row) { return row.has_gaze; });
    if (!usual || groups_.eye) return;
    std::optional<double> before;
    std::size_t runs = 0, between = 0;
    bool in_run = false, any_blank = false, any_lost = false;
    for (const Seen& row : survey_.seen()) {
      any_blank |= row.is_blank;
      any_lost |= !row.has_gaze && !row.is_blank;
      if (!row.has_gaze) {
        in_run = true;
        continue;
      }
      if (in_run && before && row.time) {
        ++runs;
        between += *row.time - *before <= kBetween * *usual;
      }
      in_run = false;
      before = row.time;
    }
    if (any_blank && any_lost) {
      groups_.foreign_if_blank =
          survey_.mayHaveClock([](const Seen& row) { return !row.is_blank; });
    } else if (between >= kMinRuns && 3 * between >= runs &&
               survey_.mayHaveClock([](const Seen& row) { return row.has_gaze; })) {
      groups_.foreign_within = *usual;
    }
  }

  /// Columns whose names tell nothing, but whose groups look at places far apart.
  void findOthers() {
    for (std::size_t i = 0; i < survey_.candidates().size(); ++i) {
      const std::size_t column = survey_.candidates()[i];
      if (!isKnown(column) && areApart(survey_, i)) groups_.people.push_back(column);
    }
  }

  const Survey& survey_;
  const ColumnNames& names_;
  const TableLayout& layout_;
  RowGroups& groups_;
};

}  // namespace

SeveralPeople::SeveralPeople(const std::string& source, std::string of_column,
                             std::vector<std::string> all)
    : InputError(source, std::to_string(all.size()) + " people or recordings in column " +
                             shown(of_column) + ": " + listOf(all) +
                             "; read one with gaze.rows = { " + quotedText(of_column) + " = " +
                             quotedText(all.front()) + " }; foci replay --trace reads all"),
      column(std::move(of_column)),
      values(std::move(all)) {}

RowGroups groupRows(Rows& rows, const ColumnNames& names, const TableLayout& layout,
                    const TraceColumns& columns) {
  RowGroups groups;
  for (const auto& [name, value] : columns.rows) {
    groups.only.push_back({.at = names.at(name), .values = {value}});
  }
  const Survey survey(rows, names, layout);
  Grouper(survey, names, layout, groups).group(rows.before().of_samples);
  return groups;
}

}  // namespace foci
