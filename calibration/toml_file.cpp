#include "calibration/toml_file.h"

#include <algorithm>
#include <cctype>
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
    const int line = document.lineOf(lineOfError(error));
    throw InputError(where + ":" + std::to_string(line), firstLine(error));
  } catch (const std::exception& error) {
    throw InputError(where, firstLine(error));
  }
  return document;
}

TomlDocument readToml(const std::filesystem::path& path) {
  return parseToml(bytesOfFile(path, kMaxFile_bytes), path.string());
}

}  // namespace foci
