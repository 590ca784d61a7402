#include "base/media.h"

#include "base/shared_library.h"

namespace foci {

const Media* media() {
  static const Media* const opened = []() -> const Media* {
    void* const library = openLibrary("libfoci_media.so");
    return library ? static_cast<const Media*>(symbolIn(library, "foci_media")) : nullptr;
  }();
  return opened;
}

std::string withoutMedia() {
  return media()
             ? ""
             : "; this foci has no libfoci_media, which reads cameras, videos and EXR: build it "
               "with FOCI_MEDIA";
}

}  // namespace foci
