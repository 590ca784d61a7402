#include "base/shared_library.h"

#include <dlfcn.h>

namespace foci {

void* openLibrary(const std::string& file) { return dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL); }

std::string whyNotOpened() {
  const char* why = dlerror();
  return why ? why : "";
}

void* symbolIn(void* library, const char* name) { return dlsym(library, name); }

}  // namespace foci
