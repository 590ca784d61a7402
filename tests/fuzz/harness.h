// Shared by all fuzzers of the readers: their names, bytes as a file, and the limits that a reader
// must keep.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>

/// Defines the fuzzer `name`, a function of `bytes` and `size`. FOCI_FUZZER in the environment
/// chooses one.
#define FOCI_FUZZ(name)                                                  \
  static int name##_fuzzer(const std::uint8_t* bytes, std::size_t size); \
  static const foci::fuzz::Known name##_known(#name, name##_fuzzer);     \
  static int name##_fuzzer(const std::uint8_t* bytes, std::size_t size)

namespace foci::fuzz {

using Fuzzer = int (*)(const std::uint8_t* bytes, std::size_t size);

struct Known {
  Known(const std::string& name, Fuzzer fuzzer);
};

/// Writes the bytes to a file of this name, in a folder that belongs to this process. The folder is
/// in memory if the system allows it. Another call with the same name replaces the file.
std::filesystem::path asFile(const std::string& name, const std::uint8_t* bytes, std::size_t size);

/// Calls a reader on an input of `size` bytes. The reader may throw InputError and nothing else. It
/// may take a second of processor time and 4 `size` + 256 MiB of memory. Otherwise the process
/// aborts, which the fuzzer reports as a finding.
void readWithinLimits(std::size_t size, const std::function<void()>& read);

}  // namespace foci::fuzz
