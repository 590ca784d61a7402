#include "app/platform/shell_pipe.h"

#include <csignal>

namespace foci {

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
