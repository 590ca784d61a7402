// The one limit for memory: how much a file may make foci allocate.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace foci {

/// An input of n bytes may take 512 MiB + 64 n, and never more than three quarters of the memory of
/// the machine, the container or the process (`ulimit -v`). The first part holds a large texture,
/// the second one what the most verbose formats unpack to.
///
/// A reader calls `take` before it allocates what a header states, an archive unpacks to or an
/// image decodes to. What is at most some ten times the bytes that were read needs no call.
class MemoryBudget {
 public:
  /// @param file  the input, which messages name; of a folder or a missing file no bytes count
  explicit MemoryBudget(const std::filesystem::path& file);
  /// @param input_bytes  of the file of this name, or of the part of it that is read
  MemoryBudget(std::string name, std::uint64_t input_bytes);

  /// Counts a further file of the same input, e.g. a texture. Call it once for each.
  void addFile(const std::filesystem::path& file);
  void addInput(std::uint64_t bytes) { input_bytes_ += bytes; }

  /// Takes `count` times `bytes_each`; the product may overflow. Nothing is taken if it throws.
  /// @param what  "its textures"; the message goes on with "would take ..."
  /// @throws InputError if that is more than is left
  void take(std::uint64_t count, std::uint64_t bytes_each, const std::string& what);

  /// Frees what was taken for a short time. `bytes` is at most that (asserted).
  void giveBack(std::uint64_t bytes);

  /// Bytes that can still be taken.
  std::uint64_t left() const;

 private:
  std::uint64_t limit() const;

  std::string name_;
  std::uint64_t input_bytes_ = 0, taken_ = 0;
};

/// The memory that this process may use in all: of the machine, the container or `ulimit -v`.
std::uint64_t memoryOfMachine();

}  // namespace foci
