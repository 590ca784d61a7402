#include "gaze/sources/rows.h"

#include <algorithm>
#include <utility>

#include "base/text.h"

namespace foci {

std::optional<GazeUnits> unitsNamed(std::string_view name) {
  if (name == "px" || name == "pixels") return GazeUnits::px;
  if (name == "deg" || name == "dva" || name == "degrees") return GazeUnits::deg;
  if (name == "normalised" || name == "normalized" || name == "norm") return GazeUnits::normalised;
  if (name == "relative") return GazeUnits::relative;
  return std::nullopt;
}

double numberIn(const Place& place, std::string_view key, std::string_view text, double low,
                double high, const char* range) {
  const auto value = parseNumber(text);
  if (value && *value >= low && *value <= high) return *value;
  throw place.error(std::string(key) + " = " + shown(text) + ": expected " + range);
}

int pixelsIn(const Place& place, std::string_view key, std::string_view text) {
  return static_cast<int>(numberIn(place, key, text, 16, 16384, "16 to 16384 px"));
}

std::optional<glm::ivec2> resolutionIn(const Place& place, std::string_view text) {
  const std::size_t times = text.find_first_of("xX");
  if (times == text.npos) return std::nullopt;
  const auto side = [&](std::string_view number) {
    return pixelsIn(place, "resolution", trimmed(number));
  };
  return glm::ivec2(side(text.substr(0, times)), side(text.substr(times + 1)));
}

namespace {

constexpr std::size_t kMaxSurveyed_B = 8 << 20;

bool hasOpenQuote(std::string_view line) {
  return line.find('"') != line.npos && std::ranges::count(line, '"') % 2 != 0;
}

/// `# key=value ...`. Unknown keys are ignored.
void readKeys(const LineReader& lines, std::string_view line, TablePreamble& preamble) {
  for (const std::string_view word : wordsOf(line.substr(1))) {
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos) continue;
    const auto key = word.substr(0, equals), text = word.substr(equals + 1);
    if (key == "units") {
      preamble.units = unitsNamed(text);
      if (!preamble.units) {
        throw lines.error("units = " + shown(text) + ": expected px, deg, normalised or relative");
      }
      continue;
    }
    const auto pixels = [&] { return pixelsIn(lines, key, text); };
    const auto metres = [&] { return numberIn(lines, key, text, 0.01, 20.0, "0.01 to 20 m"); };
    if (key == "sampling_Hz") {
      preamble.rate_Hz = numberIn(lines, key, text, 5.0, 20000.0, "5 to 20000");
    }
    if (key == "rows") preamble.of_samples = text == "samples";
    if (key == "screen_width_px") preamble.screen.size_px.x = pixels();
    if (key == "screen_height_px") preamble.screen.size_px.y = pixels();
    if (key == "screen_width_m") preamble.screen.size_m.x = metres();
    if (key == "screen_height_m") preamble.screen.size_m.y = metres();
    if (key == "viewing_distance_m") preamble.screen.distance_m = metres();
  }
}

/// A line of SMI's BeGaze or IDF Converter. Its lengths are in millimetres; 0 means unknown.
void readSmi(const LineReader& lines, std::string_view line, TablePreamble& preamble) {
  const std::size_t colon = line.find(':');
  const std::string_view key = trimmed(line.substr(2, colon == line.npos ? colon : colon - 2));
  const auto names = [&](std::string_view part) { return key.find(part) != key.npos; };
  preamble.smi |= names("BeGaze") || names("iView") || names("Calibration Area") ||
                  line.find("IDF Converter") != line.npos;
  if (colon == line.npos) return;
  const auto values = wordsOf(line.substr(colon + 1));
  const auto known = [&](std::size_t count) {
    return values.size() >= count &&
           std::ranges::none_of(std::span(values).first(count),
                                [](std::string_view text) { return parseNumber(text) == 0.0; });
  };
  const auto metres = [&](std::size_t i) {
    return 1e-3 * numberIn(lines, key, values[i], 10, 20000, "10 to 20000 mm");
  };
  if (names("Calibration Area") && known(2)) {
    preamble.screen.size_px = {pixelsIn(lines, key, values[0]), pixelsIn(lines, key, values[1])};
  } else if (names("Stimulus Dimension") && known(2)) {
    preamble.screen.size_m = {metres(0), metres(1)};
  } else if (names("Head Distance") && known(1)) {
    preamble.screen.distance_m = metres(0);
  }
}

/// Reads a line `sep=;`, as Excel understands it. @return false at any other line
bool readSeparatorLine(std::string_view line, TablePreamble& preamble) {
  constexpr std::string_view kKey = "sep=";
  if (!line.starts_with(kKey) || line.size() != kKey.size() + 1) return false;
  preamble.separator = line.back();
  return true;
}

/// Reads a line of `KEY:<tab>VALUE` as Tobii Studio 1 and 2 write before the header.
/// @return false at the header line itself
bool readTobiiStudioLine(const LineReader& lines, std::string_view line, TablePreamble& preamble) {
  if (line.starts_with("Timestamp\t")) return false;
  constexpr std::string_view kResolution = "Recording resolution:";
  if (line.starts_with(kResolution)) {
    const auto size_px = resolutionIn(lines, trimmed(line.substr(kResolution.size())));
    if (size_px) preamble.screen.size_px = *size_px;
  }
  return true;
}

/// The first line that is not blank, no comment (#) and no line `sep=;`; empty if there is none.
/// @param of_recording  the lines before it may describe a recording
std::string headerIn(LineReader& lines, TablePreamble& preamble, bool of_recording) {
  std::string_view line;
  while (lines.next(line)) {
    if (readSeparatorLine(line, preamble)) continue;
    preamble.tobii_studio |= of_recording && line.starts_with("System Properties:");
    if (preamble.tobii_studio && readTobiiStudioLine(lines, line, preamble)) continue;
    if (of_recording && line.starts_with("##")) {
      readSmi(lines, line, preamble);
    } else if (of_recording && line.starts_with('#')) {
      readKeys(lines, line, preamble);
    }
    if (!trimmed(line).empty() && line.front() != '#') return std::string(line);
  }
  return {};
}

/// The character between the fields of a table: of the line `sep=;`, else the first of tab,
/// semicolon and comma that the header line has, else a blank.
char delimiterOf(std::string_view header, const TablePreamble& before) {
  if (before.separator) return *before.separator;
  const auto has = [&](char c) { return header.find(c) != std::string_view::npos; };
  return has('\t') ? '\t' : has(';') ? ';' : has(',') ? ',' : ' ';
}

/// "1,271": a separator of thousands, or a decimal comma.
bool mayBeThousands(std::string_view text) {
  if (text.starts_with('-')) text.remove_prefix(1);
  const std::size_t comma = text.find(',');
  return comma >= 1 && comma <= 3 && text.size() == comma + 4 && text[0] != '0';
}

}  // namespace

std::optional<double> CommaNumbers::parse(std::string_view text) {
  if (!decimal_allowed_ || text.find(',') == std::string_view::npos) return parseNumber(text);
  std::string pointed(text.substr(0, 64));
  std::ranges::replace(pointed, ',', '.');
  const auto number = parseNumber(pointed);
  if (number && example_.empty()) example_ = text;
  if (number) decimal_ |= !mayBeThousands(text);
  return number;
}

void CommaNumbers::note(const Place& place, std::size_t column, std::string_view text,
                        std::size_t axis, double number) {
  constexpr double kPlain = 100.0;  // above codes for data loss; 0 and -1 stand beside "410,492"
  if (plain_[axis] && (example_.empty() || thousands_[axis])) return;
  if (text.find(',') == std::string_view::npos) {
    plain_[axis] |= number >= kPlain;
  } else if (!thousands_[axis] && mayBeThousands(text)) {
    thousands_[axis] = place.error(
        "column " + std::to_string(column + 1) + " = " + shown(text) +
        ": a decimal comma, or a separator of thousands? Other numbers of the column have no "
        "comma: write them without separators of thousands");
  }
}

const std::string& CommaNumbers::example() const {
  for (const std::size_t axis : {0, 1}) {
    if (thousands_[axis] && plain_[axis] && !decimal_) throw *thousands_[axis];
  }
  return example_;
}

std::string_view Rows::textOf(double number) const {
  text_ = exactText(number);
  return text_;
}

std::string Rows::hint() const {
  const std::size_t line = open_before_ != 0 ? open_before_ : open_here_;
  if (line == 0) return {};
  return "; a quote is left open at line " + std::to_string(line) +
         ": line breaks inside quotes are not read, so write each row in one line";
}

TextRows::TextRows(LineReader& lines) : lines_(lines) {
  source_ = lines.fileName();
  header_ = headerIn(lines_, before_, true);
  if (header_.empty()) throw InputError(source_, "empty: expected a header line and samples");
  takeNames();
}

TextRows::TextRows(LineReader& lines, const TablePreamble& before, const std::string& header)
    : lines_(lines), header_(header) {
  source_ = lines.fileName();
  before_ = before;
  takeNames();
}

void TextRows::skipNames() {
  bool is_header = false;
  survey(1, [&] {
    const auto is_name = [&](std::string_view name) { return names_[0].starts_with(name); };
    is_header = !text(0).empty() && !parseNumber(text(0)) && is_name(text(0));
  });
  if (is_header) held_.clear();
}

void TextRows::takeNames() {
  number_ = lines_.number();
  delimiter_ = delimiterOf(header_, before_);
  splitRow(header_, delimiter_, fields_);
  names_.assign(fields_.begin(), fields_.end());
}

void TextRows::readNamesAsRow() {
  held_.insert(held_.begin(), {.text = header_, .number = number_});
}

void TextRows::nameRowNumbers() {
  constexpr std::size_t kEnoughRows = 64;
  double last = -1.0;
  bool are_numbers = true;
  survey(kEnoughRows, [&] {
    const bool is_longer = sizeUpToText(names_.size()) == names_.size() + 1;
    const double number = is_longer ? parseNumber(text(0)).value_or(-1.0) : -1.0;
    are_numbers = are_numbers && number > last && number == std::floor(number);
    last = number;
  });
  // R writes them in quotes, pandas below blanks.
  const bool are_set_off =
      !held_.empty() && (held_[0].text[0] == '"' || (delimiter_ == ' ' && header_[0] == ' '));
  if (are_numbers && are_set_off) names_.insert(names_.begin(), "");
}

bool TextRows::readLine(std::string_view& line) {
  while (lines_.next(line)) {
    if (trimmed(line).empty()) continue;
    const bool is_comment =
        has_comments_ && line.front() == '#' && !equalsIgnoringCase(line.substr(0, 4), "#n/a");
    if (!is_comment) return true;
  }
  return false;
}

void TextRows::split(std::string_view line, std::size_t number, bool is_ended) {
  splitRow(line, delimiter_, fields_, used_);
  number_ = number;
  may_be_cut_ = !is_ended;
  open_before_ = open_here_;
  open_here_ = hasOpenQuote(line) ? number : 0;
}

bool TextRows::next() {
  if (next_held_ < held_.size()) {
    const Line& line = held_[next_held_++];
    split(line.text, line.number, line.is_ended);
    return true;
  }
  std::string_view line;
  if (!readLine(line)) return false;
  split(line, lines_.number(), lines_.isEnded());
  return true;
}

void TextRows::survey(std::size_t most, const std::function<void()>& visit) {
  std::string_view line;
  std::size_t bytes = 0;
  while (held_.size() < most && bytes < kMaxSurveyed_B && readLine(line)) {
    bytes += line.size();
    held_.push_back(
        {.text = std::string(line), .number = lines_.number(), .is_ended = lines_.isEnded()});
  }
  const std::size_t header = number_;
  const std::size_t count = std::min(most, held_.size());
  for (next_held_ = 0; next_held_ < count;) {
    next();
    visit();
  }
  next_held_ = open_here_ = 0;
  number_ = header;
}

InputError TextRows::error(const std::string& what) const {
  return {source_ + ":" + std::to_string(number_), what};
}

NamedTable::NamedTable(const std::filesystem::path& file, std::string expected, bool may_be_cut)
    : lines_(file), expected_(std::move(expected)), may_be_cut_(may_be_cut) {
  TablePreamble before;
  const std::string header = headerIn(lines_, before, false);
  if (header.empty()) throw InputError(fileName(), "empty: expected " + expected_);
  rows_.emplace(lines_, before, header);
  commas_ = CommaNumbers(rows_->delimiter());
}

NamedTable::NamedTable(const std::filesystem::path& file, std::size_t columns) : lines_(file) {
  rows_.emplace(lines_, TablePreamble{}, std::string(columns - 1, ','));
}

std::optional<std::size_t> NamedTable::find(std::string_view name) const {
  const auto& names = rows_->names();
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return std::nullopt;
  if (std::find(found + 1, names.end(), name) != names.end()) {
    throw error("column " + std::string(name) + " twice");
  }
  return static_cast<std::size_t>(found - names.begin());
}

std::size_t NamedTable::column(std::string_view name) const {
  if (const auto found = find(name)) return *found;
  throw error("no column " + std::string(name) + ": expected " + expected_);
}

bool NamedTable::next() {
  const std::size_t columns = rows_->names().size();
  while (rows_->next()) {
    if (cut_) throw *cut_;
    const std::size_t fields = rows_->sizeUpToText(columns);
    if (fields == columns) return any_ = true;
    cut_ = error(counted(fields, "field") + ": expected " + std::to_string(columns));
    if (!may_be_cut_ || !any_ || fields > columns) throw *cut_;
  }
  commas_.example();
  return false;
}

std::optional<double> NamedTable::number(std::size_t column, double low, double high) {
  auto value = rows_->number(column);
  if (!value && rows_->isAbsent(column)) return std::nullopt;
  if (!value) value = commas_.parse(text(column));
  if (!value || !(*value >= low && *value <= high)) throw unexpected(column, low, high);
  return value;
}

std::optional<double> NamedTable::position(std::size_t column, std::size_t axis, double low,
                                           double high) {
  const auto value = number(column, low, high);
  if (value) commas_.note(*this, column, text(column), axis, *value);
  return value;
}

double NamedTable::needed(std::size_t column, double low, double high) {
  const auto value = number(column, low, high);
  if (!value) throw unexpected(column, low, high);
  return *value;
}

InputError NamedTable::unexpected(std::size_t column, double low, double high) const {
  const std::string& name = rows_->names()[column];
  return error((name.empty() ? "column " + std::to_string(column + 1) : name) + " = " +
               shown(text(column)) + ": expected a number" +
               (high < INFINITY ? " from " + exactText(low) + " to " + exactText(high) : ""));
}

NumberRows::NumberRows(std::string source, std::vector<std::string> names,
                       std::vector<double> values, const TablePreamble& before)
    : values_(std::move(values)) {
  before_ = before;
  before_.of_samples = true;
  source_ = std::move(source);
  names_ = std::move(names);
}

bool NumberRows::next() {
  const std::size_t columns = names_.size(), at = taken_ * columns;
  if (columns == 0 || at + columns > values_.size()) return false;
  numbers_ = std::span<const double>(values_).subspan(at, columns);
  ++taken_;
  return true;
}

void NumberRows::survey(std::size_t most, const std::function<void()>& visit) {
  while (taken_ < most && next()) visit();
  taken_ = 0;
}

InputError NumberRows::error(const std::string& what) const {
  return {source_ + ", sample " + std::to_string(taken_), what};
}

}  // namespace foci
