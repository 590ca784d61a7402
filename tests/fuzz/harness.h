// What every fuzzer of a reader shares: bytes as a file, and the limits that a reader keeps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>

namespace foci::fuzz {

/// Writes the bytes to a file of this name in a folder of the process's own, in memory where the
/// system has such a folder. The same name is the same file.
std::filesystem::path asFile(const std::string& name, const std::uint8_t* bytes, std::size_t size);

/// Calls a reader on an input of `size` bytes. It may throw InputError and nothing else; it stays
/// within a second of processor time and within 4 `size` + 256 MiB of memory. Else the process is
/// aborted, which is how a fuzzer finds.
void readWithinLimits(std::size_t size, const std::function<void()>& read);

}  // namespace foci::fuzz
