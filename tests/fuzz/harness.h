// Shared by all fuzzers of the readers: bytes as a file, and the limits that a reader must keep.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>

namespace foci::fuzz {

/// Writes the bytes to a file of this name, in a folder that belongs to this process. The folder is
/// in memory if the system allows it. Another call with the same name replaces the file.
std::filesystem::path asFile(const std::string& name, const std::uint8_t* bytes, std::size_t size);

/// Calls a reader on an input of `size` bytes. The reader may throw InputError and nothing else. It
/// may take a second of processor time and 4 `size` + 256 MiB of memory. Otherwise the process
/// aborts, which the fuzzer reports as a finding.
void readWithinLimits(std::size_t size, const std::function<void()>& read);

}  // namespace foci::fuzz
