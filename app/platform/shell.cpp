#include "app/platform/shell.h"

#include <algorithm>
#include <cctype>
#include <csignal>

#include "base/text.h"

namespace foci {

std::string shellWord(std::string_view text) {
  const auto is_plain = [](unsigned char c) {
    constexpr std::string_view kPlain = "%+,-./:=@_";
    return (c < 0x80 && std::isalnum(c)) || kPlain.find(static_cast<char>(c)) != kPlain.npos;
  };
  if (!text.empty() && std::ranges::all_of(text, is_plain)) return std::string(text);
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  if (std::ranges::any_of(text, is_control)) {
    std::string quoted = "$'";
    for (const char c : text) {
      if (is_control(static_cast<unsigned char>(c))) {
        quoted += '\\';
        for (const int shift : {6, 3, 0}) quoted += static_cast<char>('0' + (c >> shift & 7));
      } else {
        if (c == '\'' || c == '\\') quoted += '\\';
        quoted += c;
      }
    }
    return quoted + '\'';
  }
  return '\'' + replaced(std::string(text), "'", "'\\''") + '\'';
}

bool ShellPipe::open(const std::string& command) {
  std::signal(SIGPIPE, SIG_IGN);  // writing fails instead
  pipe_ = popen(command.c_str(), "w");
  return pipe_ != nullptr;
}

bool ShellPipe::write(const void* bytes, std::size_t count) {
  return std::fwrite(bytes, 1, count, pipe_) == count;
}

void ShellPipe::close() {
  if (pipe_ != nullptr) pclose(pipe_);
  pipe_ = nullptr;
}

}  // namespace foci
