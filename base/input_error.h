// The one exception for bad input from outside: files, options, messages from other programs.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

#include "base/text.h"

namespace foci {

/// One line that names the file, the line or key, the value found and the values allowed, e.g.
/// `study.toml:12: observer.pupil_mm = 40: expected 0.5 to 12`. `main` catches it, prints the line
/// and exits with code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;

  /// `where` is "file", "file:line" or "--option"; the parts are the rest of the line (`concat`).
  template <typename Part, typename... Parts>
  InputError(const std::string& where, const Part& part, const Parts&... more)
      : std::runtime_error(concat(where, ": ", part, more...)) {}
};

/// Throws if `path` exists but is not a regular file. A folder cannot be read, and a pipe could
/// keep the program waiting for ever.
inline void requireRegularFile(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored)) {
    throw InputError(path.string(), "not a file");
  }
}

}  // namespace foci
