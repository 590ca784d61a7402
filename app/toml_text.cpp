#include "app/toml_text.h"

#include <fstream>

#include "app/base/input_error.h"

namespace foci {
namespace {

constexpr std::size_t kMaxFile_bytes = 4 << 20;
constexpr std::size_t kMaxLine_bytes = 2000;
constexpr int kMaxDepth = 16;

/// toml11 recurses into nested values and keys: what would exhaust its stack is refused before.
void refuseDeepNesting(const std::string& text, const std::string& file) {
  int depth = 0, line = 1;
  std::size_t line_start = 0;
  char quote = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto where = [&] { return file + ":" + std::to_string(line); };
    if (c == '\0') throw InputError(where(), "holds a NUL byte: not TOML");
    if (c == '\n') {
      ++line;
      line_start = i + 1;
      quote = 0;
    } else if (i - line_start > kMaxLine_bytes) {
      throw InputError(where(),
                       "expected lines of at most " + std::to_string(kMaxLine_bytes) + " bytes");
    } else if (quote) {
      if (c == '\\' && quote == '"')
        ++i;
      else if (c == quote)
        quote = 0;
    } else if (c == '"' || c == '\'') {
      if (text.compare(i, 3, std::string(3, c)) == 0) {
        throw InputError(where(), "strings of several lines are no values of a study");
      }
      quote = c;
    } else if (c == '#') {
      while (i + 1 < text.size() && text[i + 1] != '\n') ++i;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxDepth) throw InputError(where(), "nested too deeply");
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
}

}  // namespace

std::string readTomlText(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::error_code ignored;
  // A folder is no text, and a pipe that nobody writes to would never end.
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored)) {
    throw InputError(file, "not a file, expected a study (TOML)");
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(file, "cannot be read");
  std::string text(kMaxFile_bytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > kMaxFile_bytes) throw InputError(file, "over 4 MiB: not a study");
  refuseDeepNesting(text, file);
  return text;
}

}  // namespace foci
