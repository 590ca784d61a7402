// All bytes of a small file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace foci {

/// @throws InputError if it is no regular file, cannot be read, or has more than `most` bytes
std::string bytesOfFile(const std::filesystem::path& file, std::uintmax_t most);

}  // namespace foci
