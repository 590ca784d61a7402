#include "base/media.h"

#include "base/shared_library.h"

namespace foci {
namespace {

struct Opened {
  const Media* media = nullptr;
  std::string problem{};
};

const Opened& opened() {
  static const Opened found = [] {
    Opened result;
    for (const char* file : {"libfoci_media.so", FOCI_MEDIA_DIR "/libfoci_media.so"}) {
      if (void* const library = openLibrary(file)) {
        result.media = static_cast<const Media*>(symbolIn(library, "foci_media_1"));
        if (result.media) break;
      }
      if (result.problem.empty()) result.problem = whyNotOpened();
    }
    return result;
  }();
  return found;
}

}  // namespace

const Media* media() { return opened().media; }

std::string withoutMedia() {
  return media()
             ? ""
             : "; the library that reads cameras, videos and EXR is missing: " + opened().problem;
}

}  // namespace foci
