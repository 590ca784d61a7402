#include "calibration/toml_file.h"

#include <algorithm>
#include <cctype>
#include <regex>
#include <sstream>
#include <string_view>
#include <utility>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr std::size_t kMaxFile_bytes = 4 << 20;  // a webcam's calibration holds a PNG in base64
constexpr int kMaxDepth = 16;                    // our own files nest 2 deep
constexpr std::size_t kLongLine_bytes = 400, kMaxPart_bytes = 16 << 10;

/// Prepares a text for toml11, which recurses into nested values and dotted keys, reads beyond its
/// buffer when it reports bytes that are not UTF-8, and scans the line of each value. The first two
/// are refused, and long lists are broken into lines.
class SafeText {
 public:
  SafeText(const std::string& text, const std::string& where) : text_(text), where_(where) {
    lines_.push_back(1);
    for (std::size_t i = 0; i < text_.size(); ++i) i = take(i);
  }

  std::string text() && { return std::move(out_); }
  /// By line of `text`, the line of the original.
  std::vector<int> lines() && { return std::move(lines_); }

 private:
  [[noreturn]] void refuse(const char* why) const {
    throw InputError(where_ + ":" + std::to_string(line_), why);
  }

  void breakLine() {
    out_ += '\n';
    lines_.push_back(line_);
    value_from_ = out_.size();
  }

  /// @return the place of the last byte taken
  std::size_t take(std::size_t i) {
    const char c = text_[i];
    const std::size_t length = utf8Length(std::string_view(text_).substr(i, 4));
    if (length == 0) refuse("a byte that is not UTF-8: not TOML");
    if (c == '\0') refuse("holds a NUL byte: not TOML");
    out_.append(text_, i, length);
    if (c == '\n') {
      ++line_;
      lines_.push_back(line_);
      value_from_ = out_.size();
      quote_ = 0;
      dots_ = 0;
    } else if (length > 1) {
      return i + length - 1;
    } else if (quote_ != 0) {
      const char next = i + 1 < text_.size() ? text_[i + 1] : '\0';
      if (c == '\\' && quote_ == '"' && (next == '"' || next == '\\')) {
        out_ += next;
        return i + 1;
      }
      if (c == quote_) {
        value_from_ += out_.size() - quote_from_;  // a long text is one value, which costs nothing
        quote_ = 0;
      }
    } else {
      takePlain(i, c);
    }
    return i;
  }

  /// A character outside of texts and comments.
  void takePlain(std::size_t i, char c) {
    if (out_.size() > value_from_ + kMaxPart_bytes) {
      refuse("more than 16 KiB without a line break or a list: break the line");
    }
    if (c == '"' || c == '\'') {
      if (text_.compare(i, 3, std::string(3, c)) == 0) {
        refuse("strings of several lines are not supported");
      }
      quote_ = c;
      quote_from_ = out_.size();
    } else if (c == '#') {
      quote_ = '\n';  // a comment, to the end of the line
    } else if (c == '[' || c == '{') {
      open_ += c;
      if (static_cast<int>(open_.size()) > kMaxDepth) refuse("nested too deeply");
    } else if (c == ']' || c == '}') {
      if (!open_.empty()) open_.pop_back();
    } else if (c == '=' || c == ',') {
      dots_ = 0;
      const bool in_list = !open_.empty() && open_.find('{') == open_.npos;
      if (c == ',' && in_list && out_.size() > value_from_ + kLongLine_bytes) breakLine();
    } else if (c == '.' && ++dots_ > kMaxDepth) {
      refuse("nested too deeply");
    }
  }

  const std::string& text_;
  const std::string& where_;
  std::string out_{};
  std::vector<int> lines_{};
  std::string open_{};  // brackets
  std::size_t value_from_ = 0, quote_from_ = 0;
  int dots_ = 0, line_ = 1;
  char quote_ = 0;
};

/// The first line of toml11's report, without its function's name.
std::string firstLine(const std::exception& error) {
  std::string text = error.what();
  text = text.substr(0, text.find('\n'));
  if (text.starts_with("[error] ")) text = text.substr(8);
  if (text.starts_with("toml::")) text = text.substr(std::min(text.size(), text.find(": ") + 2));
  std::ranges::replace_if(
      text, [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  return text.empty() ? "not TOML" : text.substr(0, 200);
}

std::string_view withoutComment(std::string_view line) {
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote == 0 && c == '#') return line.substr(0, i);
    if (quote == '"' && c == '\\') {
      ++i;
    } else if (c == quote) {
      quote = 0;
    } else if (quote == 0 && (c == '"' || c == '\'')) {
      quote = c;
    }
  }
  return line;
}

/// What to do about a line that toml11 refuses; empty: unknown.
/// @param report  of toml11
std::string adviceFor(std::string_view line, std::string_view report) {
  static const std::pair<std::regex, const char*> kMistakes[] = {
      {std::regex("[^=]*"), "expected key = value, or a [table]"},
      {std::regex("=[+-]?\\d+,\\d+.*"), "expected a decimal point"},
      {std::regex("=[+-]?\\d*\\.?\\d+([eE][+-]?\\d+)?\\s*(%|[A-Za-z].*)"),
       "expected a number without a unit"},
      {std::regex("=([^\"']*[^\"'\\w])?(\\.\\d.*|\\d+\\.([^\\d].*)?)"),
       "expected a digit on both sides of the point"},
      {std::regex("=(T(rue|RUE)|F(alse|ALSE)|[Yy](es|ES)|[Nn][Oo]|[Oo]([Nn]|ff|FF))"),
       "expected true or false, in small letters"},
      {std::regex("=(None|null|NULL|nil)"), "expected a value, or no such line"},
      {std::regex("=\"([^\"\\\\]|\\\\[btnfruU\"\\\\])*"
                  "\\\\(?![btnfr\"\\\\]|u[\\da-fA-F]{4}|U[\\da-fA-F]{8}).*"),
       "expected single quotes around a text with \\"},
      {std::regex("=(\"([^\"\\\\]|\\\\.)*|'[^']*)"), "expected a quote at the end, too"},
      {std::regex("=[A-Za-z_./~].*"), "expected quotes around a text"}};
  constexpr std::size_t kLongest = 200;  // std::regex recurses
  const auto reports = [&](const char* what) { return report.find(what) != report.npos; };
  const std::string_view statement = trimmed(withoutComment(line));
  if (statement.empty() || statement.starts_with('[') || line.size() > kLongest) return "";
  if (reports("already exists") || reports("exists twice") || reports("array separator")) return "";
  const std::size_t at = statement.find('=');
  if (at == statement.npos && reports("array")) return "";  // a list of several lines
  std::string value(statement);
  if (at != statement.npos) value = "=" + std::string(trimmed(statement.substr(at + 1)));
  const auto found = std::ranges::find_if(
      kMistakes, [&](const auto& mistake) { return std::regex_match(value, mistake.first); });
  return found == std::end(kMistakes) ? "" : found->second;
}

/// The language of another program's file, by its first line; empty: unknown.
std::string otherLanguageOf(std::string_view text) {
  static const std::regex yaml("(%YAML|---|[\\w-]+:( |$)).*");
  const bool has_toml = text.find(" = ") != text.npos || text.find("\n[") != text.npos;
  for (std::string_view rest = withoutByteOrderMark(text); !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string line(trimmed(rest.substr(0, std::min<std::size_t>(end, 200))));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.empty() || line.starts_with('#')) continue;
    if (line[0] == '{') return "JSON";
    if (line[0] == '<') return "XML";
    return !has_toml && std::regex_match(line, yaml) ? "YAML" : "";
  }
  return "";
}

std::string_view lineAt(std::string_view text, int line) {
  while (--line > 0) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  return trimmed(text.substr(0, text.find('\n')));
}

template <class SyntaxError>
int lineOfError(const SyntaxError& error) {
  if constexpr (requires { error.location(); }) {
    return lineIn(error.location());
  } else {
    return lineIn(error.errors().at(0).locations().at(0).first);
  }
}

}  // namespace

TomlDocument parseToml(const std::string& text, const std::string& where) {
  SafeText safe(text, where);
  TomlDocument document{.root = {}, .lines = SafeText(safe).lines()};
  try {
    std::istringstream stream(std::move(safe).text());
    document.root = toml::parse(stream, where);
  } catch (const toml::syntax_error& error) {
    if (const std::string other = otherLanguageOf(text); !other.empty()) {
      throw InputError(where, other,
                       ", not TOML: expected a study, or a file that foci calibrate writes");
    }
    const int line = document.lineOf(lineOfError(error));
    const std::string_view content = lineAt(text, line);
    const std::string report = firstLine(error), advice = adviceFor(content, report);
    throw InputError(where + ":" + std::to_string(line),
                     content.empty() ? "" : shown(content) + ": ",
                     advice.empty() ? report : advice);
  } catch (const std::exception& error) {
    throw InputError(where, firstLine(error));
  }
  return document;
}

TomlDocument readToml(const std::filesystem::path& path) {
  return parseToml(bytesOfFile(path, kMaxFile_bytes), path.string());
}

}  // namespace foci
