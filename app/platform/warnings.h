// What foci says to the user on standard error, and the warnings of a run among it.
#pragma once

#include <string>
#include <vector>

namespace foci {

/// Prints "foci: TEXT" as one line on standard error. Control characters become escapes.
void say(const std::string& text);
/// Another function hears it instead.
void sayTo(void (*listener)(const std::string& text));
/// Silences OpenCV and its encoders, unless the environment sets their log levels
/// (OPENCV_LOG_LEVEL, OPENCV_FFMPEG_LOGLEVEL). Libraries without such a switch are silenced where
/// they are called (base/quiet_stderr.h).
void quietLibraries();

/// The warnings of a run: what makes its results other than the user may expect. Each is printed
/// when it comes, and stands at the top of the run's report and in its manifest.
class Warnings {
 public:
  /// An empty text, or one that is there already, is not added or printed.
  void add(const std::string& text);
  /// "WHERE: TEXT"
  void add(const std::string& where, const std::string& text) {
    if (!text.empty()) add(where + ": " + text);
  }
  void addAll(const std::string& where, const std::vector<std::string>& texts) {
    for (const std::string& text : texts) add(where, text);
  }

  /// Takes over warnings that were printed before, e.g. those of a scene that several runs share.
  void include(const std::vector<std::string>& printed);

  /// In the order in which they came.
  const std::vector<std::string>& all() const { return all_; }

 private:
  bool keep(const std::string& text);

  std::vector<std::string> all_{};
};

}  // namespace foci
