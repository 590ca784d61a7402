// Libraries such as libpng and GStreamer write their warnings to standard error, past every error
// that foci reports itself.
#pragma once

namespace foci {

/// Standard error of the whole process leads nowhere while one of these lives. Keep its life short,
/// around calls of a library.
class QuietStderr {
 public:
  QuietStderr();
  ~QuietStderr();
  QuietStderr(const QuietStderr&) = delete;
  QuietStderr& operator=(const QuietStderr&) = delete;
};

}  // namespace foci
