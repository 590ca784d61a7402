// The shell: command lines that paste back into it, and bytes to a command's standard input.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

namespace foci {

/// `text` as one word of a POSIX shell: in single quotes where a shell would read it otherwise, and
/// as $'...' with escapes (POSIX.1-2024) where it has control characters.
std::string shellWord(std::string_view text);

class ShellPipe {
 public:
  ShellPipe() = default;
  ~ShellPipe() { close(); }
  ShellPipe& operator=(ShellPipe&&) = delete;  // nor copied

  /// @param command  for the shell
  /// @return false if it cannot be started
  bool open(const std::string& command);
  /// @return false if the command has ended
  bool write(const void* bytes, std::size_t count);
  /// Waits for the command.
  void close();

 private:
  std::FILE* pipe_ = nullptr;
};

}  // namespace foci
