// SHA-256 of inputs and frames, for the manifest (OpenSSL's libcrypto).
#pragma once

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

/// @param before_block  called before each MiB is read; it stops the work by throwing
/// @throws InputError if the file cannot be read
std::string sha256OfFile(const std::filesystem::path& path,
                         const std::function<void()>& before_block = {});

}  // namespace foci
