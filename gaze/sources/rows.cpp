#include "gaze/sources/rows.h"

#include <algorithm>
#include <utility>

#include "base/text.h"

namespace foci {
namespace {

constexpr std::size_t kMaxSurveyed_B = 8 << 20;

bool hasOpenQuote(std::string_view line) {
  return line.find('"') != line.npos && std::count(line.begin(), line.end(), '"') % 2 != 0;
}

}  // namespace

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
  std::string_view line;
  while (header_.empty() && lines_.next(line)) {
    if (readSeparatorLine(line, before_)) continue;
    before_.tobii_studio |= startsTobiiStudio(line);
    if (before_.tobii_studio && readTobiiStudioLine(lines_, line, before_)) continue;
    if (line.starts_with('#')) {
      readPreambleLine(lines_, line, before_);
    } else if (!trimmed(line).empty()) {
      header_ = line;
    }
  }
  if (header_.empty()) throw InputError(source_, "empty: expected a header line and samples");
  takeNames();
}

TextRows::TextRows(LineReader& lines, const TablePreamble& before, const std::string& header)
    : lines_(lines), header_(header) {
  source_ = lines.fileName();
  before_ = before;
  takeNames();
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
  held_.insert(held_.begin(),
               {.text = header_ + std::string(kNumberPadding, ' '), .number = number_});
}

bool TextRows::readLine(std::string_view& line) {
  while (lines_.next(line)) {
    if (!trimmed(line).empty() && line.front() != '#') return true;
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
    split(std::string_view(line.text).substr(0, line.text.size() - kNumberPadding), line.number,
          line.is_ended);
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
    held_.push_back({.text = std::string(line).append(kNumberPadding, ' '),
                     .number = lines_.number(),
                     .is_ended = lines_.isEnded()});
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

bool FixedLines::next() {
  std::string_view line;
  while (lines_.next(line)) {
    if (trimmed(line).empty()) continue;
    if (cut_) throw *cut_;
    splitFields(line, ',', fields_);
    if (fields_.size() >= count_) return ++taken_ > 0;
    cut_ = error(std::to_string(fields_.size()) + " fields: expected " + std::to_string(count_));
    if (taken_ < 2) throw *cut_;
  }
  return false;
}

double FixedLines::number(std::size_t column, double limit) const {
  const auto value = fieldNumber(fields_[column]);
  if (value && std::abs(*value) <= limit) return *value;
  throw error("column " + std::to_string(column + 1) + " = " + shown(fields_[column]) +
              ": expected a number" +
              (limit < INFINITY ? " up to " + significant(limit) : std::string()));
}

void FixedLines::warnIfCut(TraceHeader& header) const {
  if (cut_) header.warnings.emplace_back(kCutOff);
}

NumberRows::NumberRows(std::string source, std::vector<std::string> names,
                       std::vector<double> values, std::optional<double> rate_Hz)
    : values_(std::move(values)) {
  before_.rate_Hz = rate_Hz;
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
