#include "calibration/toml_file.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string_view>

#include "base/input_error.h"

namespace foci {
namespace {

constexpr std::size_t kMaxFile_bytes = 4 << 20;  // a webcam's calibration holds a PNG in base64
constexpr int kMaxDepth = 16;                    // our own files nest 2 deep

/// Number of bytes of the UTF-8 character that `text` starts with; 0: it starts with none (RFC
/// 3629; Unicode, table 3-7).
std::size_t utf8Length(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<std::uint8_t>(text[i]) : std::uint8_t{0};
  };
  const std::uint8_t first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  std::uint8_t low = 0x80, high = 0xbf;  // of the second byte
  if (first == 0xe0) low = 0xa0;         // else overlong
  if (first == 0xed) high = 0x9f;        // else a surrogate
  if (first == 0xf0) low = 0x90;
  if (first == 0xf4) high = 0x8f;  // else beyond U+10FFFF
  if (first < 0xc2 || first > 0xf4 || byte(1) < low || byte(1) > high) return 0;
  for (std::size_t i = 2; i < length; ++i) {
    if (byte(i) < 0x80 || byte(i) > 0xbf) return 0;
  }
  return length;
}

/// toml11 recurses into nested values and dotted keys, and reads beyond its buffer when it reports
/// bytes that are not UTF-8. Both are refused before toml11 sees them.
void refuseUnsafeText(const std::string& text, const std::string& where) {
  int brackets = 0, dots = 0, line = 1;
  char quote = 0;
  const auto refuse = [&](const char* why) {
    throw InputError(where + ":" + std::to_string(line), why);
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const std::size_t length = utf8Length(std::string_view(text).substr(i, 4));
    if (length == 0) refuse("a byte that is not UTF-8: not TOML");
    if (c == '\0') refuse("holds a NUL byte: not TOML");
    if (c == '\n') {
      ++line;
      quote = 0;
      dots = 0;
    } else if (length > 1) {
      i += length - 1;
    } else if (quote) {
      const char next = i + 1 < text.size() ? text[i + 1] : '\0';
      if (c == '\\' && quote == '"' && (next == '"' || next == '\\')) {
        ++i;
      } else if (c == quote) {
        quote = 0;
      }
    } else if (c == '"' || c == '\'') {
      if (text.compare(i, 3, std::string(3, c)) == 0)
        refuse("strings of several lines are not supported");
      quote = c;
    } else if (c == '#') {
      quote = '\n';  // a comment, to the end of the line
    } else if (c == '[' || c == '{') {
      if (++brackets > kMaxDepth) refuse("nested too deeply");
    } else if (c == ']' || c == '}') {
      --brackets;
    } else if (c == '=' || c == ',') {
      dots = 0;
    } else if (c == '.' && ++dots > kMaxDepth) {
      refuse("nested too deeply");
    }
  }
}

/// The first line of toml11's report, without its function's name.
std::string firstLine(const std::exception& error) {
  std::string text = error.what();
  text = text.substr(0, text.find('\n'));
  if (text.starts_with("[error] ")) text = text.substr(8);
  if (text.starts_with("toml::")) text = text.substr(std::min(text.size(), text.find(": ") + 2));
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  return text.empty() ? "not TOML" : text.substr(0, 200);
}

}  // namespace

toml::value parseToml(const std::string& text, const std::string& where) {
  refuseUnsafeText(text, where);
  try {
    std::istringstream stream(text);
    return toml::parse(stream, where);
  } catch (const toml::exception& error) {
    throw InputError(where + ":" + std::to_string(error.location().line()), firstLine(error));
  } catch (const std::exception& error) {
    throw InputError(where, firstLine(error));
  }
}

toml::value readToml(const std::filesystem::path& path) {
  const std::string file = path.string();
  requireRegularFile(path);
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(file, "cannot be read");
  std::string text(kMaxFile_bytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > kMaxFile_bytes)
    throw InputError(file, "over 4 MiB: expected a smaller TOML file");
  return parseToml(text, file);
}

}  // namespace foci
