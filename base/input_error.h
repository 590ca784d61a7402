// The one exception for bad outside input: files, options, messages from other programs.
// `app/base` is the only folder that every room may include.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

namespace foci {

/// Says in one line what was wrong: file, line or key, the value found and what was allowed, e.g.
/// `study.toml:12: observer.pupil_mm = 40: expected 0.5 to 12`. Caught once, in `main`: exit
/// code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;

  /// `where` is "file", "file:line" or "--option"; `what` the rest of the line.
  InputError(const std::string& where, const std::string& what)
      : std::runtime_error(where + ": " + what) {}
};

/// Refuses what is there but no regular file: a folder, a device, a pipe that would be waited on
/// for ever.
inline void requireRegularFile(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored)) {
    throw InputError(path.string(), "not a file");
  }
}

}  // namespace foci
