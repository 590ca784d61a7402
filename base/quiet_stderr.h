// Keeps the warnings of libraries off the terminal. Libraries such as libpng and GStreamer write
// them to standard error, beside the errors that foci reports.
#pragma once

namespace foci {

/// Discards the standard error of the whole process during its lifetime. Keep this lifetime short,
/// around calls of a library.
class QuietStderr {
 public:
  QuietStderr();
  ~QuietStderr();
  QuietStderr& operator=(QuietStderr&&) = delete;  // nor copied
};

}  // namespace foci
