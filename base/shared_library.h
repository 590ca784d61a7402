// Libraries that are opened while the program runs, so that it starts without them.
#pragma once

#include <string>

namespace foci {

/// Null: there is none of this name. It stays open.
void* openLibrary(const std::string& file);

/// What the last `openLibrary` of this thread failed for.
std::string whyNotOpened();

/// The address of a function; null: the library has none of this name.
void* symbolIn(void* library, const char* name);

}  // namespace foci
