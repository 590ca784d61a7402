#include "app/graphics/gnuplot.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <stdexcept>

#include "base/text.h"

namespace foci {
namespace {

using File = std::unique_ptr<std::FILE, decltype(&std::fclose)>;

File temporaryFile() {
  File file(std::tmpfile(), &std::fclose);
  if (!file) throw std::runtime_error("cannot make a temporary file");
  return file;
}

}  // namespace

std::string gnuplotString(const std::string& text) {
  std::string quoted = "('";
  for (const char c : visible(text)) {
    quoted += c == '\'' ? std::string("'.\"'\".'") : std::string(1, c);
  }
  return quoted + "')";
}

std::optional<std::string> runGnuplot(const std::string& script) {
  const File in = temporaryFile(), out = temporaryFile();
  if (std::fwrite(script.data(), 1, script.size(), in.get()) != script.size() ||
      std::fflush(in.get()) != 0) {
    throw std::runtime_error("cannot write a temporary file");
  }
  std::rewind(in.get());
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, fileno(in.get()), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(out.get()), STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  std::string name = "gnuplot", option = "-d";  // without the user's own settings
  char* arguments[] = {name.data(), option.data(), nullptr};
  pid_t child = 0;
  const int spawned = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (spawned != 0) return std::nullopt;
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127) return std::nullopt;

  std::string text;
  std::rewind(out.get());
  char block[65536];
  for (std::size_t n; (n = std::fread(block, 1, sizeof block, out.get())) > 0;)
    text.append(block, n);
  if (status != 0 || text.empty()) {
    throw std::runtime_error("gnuplot failed to draw a chart");
  }
  return text;
}

}  // namespace foci
