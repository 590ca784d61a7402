#include "app/live/opened_file.h"

#include <utility>

#include "app/live/sources.h"
#include "base/file.h"

namespace foci {

LiveNext openedFile(const std::filesystem::path& file, const StudyRequest& options,
                    const std::string& source, const Study& now) {
  if (isScene(file) || lowerExtension(file) == ".toml") {
    StudyAsked asked = studyOf({.study = file.string(),
                                .size = options.size,
                                .device = options.device,
                                .no_cache = options.no_cache});
    return {.study = std::move(asked.study),
            .scene = std::move(asked.scene),
            .source = source.starts_with("trace:") ? "mouse" : source,
            .title = file.filename().string()};
  }
  LiveNext next{.study = now,
                .source = "trace:" + file.string(),
                .title = now.file.filename().string() + ", " + file.filename().string()};
  openLiveSource(next.source, next.study);  // or says what is wrong with it
  return next;
}

}  // namespace foci
