// Command lines that paste back into a shell.
#pragma once

#include <string>
#include <string_view>

namespace foci {

/// `text` as one word of a POSIX shell: in single quotes where a shell would read it otherwise, and
/// as $'...' with escapes (POSIX.1-2024) where it has control characters.
std::string shellWord(std::string_view text);

}  // namespace foci
