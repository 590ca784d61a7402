// SHA-256 of inputs and frames, for the manifest (OpenSSL's libcrypto).
#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>

namespace foci {

class Sha256 {
 public:
  Sha256();
  ~Sha256();
  void add(std::span<const unsigned char> bytes);
  /// The hash of all bytes added, 64 hexadecimal digits. Call it once.
  std::string hex();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A file that is open to be hashed: its name may vanish meanwhile.
class FileToHash {
 public:
  /// @throws InputError if the file cannot be read
  explicit FileToHash(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }
  /// Call it once.
  /// @param before_block  called before each MiB is read; it stops the work by throwing
  /// @throws InputError if the file cannot be read
  std::string sha256(const std::function<void()>& before_block = {});

 private:
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

std::string sha256Of(std::string_view bytes);

/// @throws InputError if the file cannot be read
std::string sha256OfFile(const std::filesystem::path& path);

}  // namespace foci
