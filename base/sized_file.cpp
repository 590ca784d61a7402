#include "base/sized_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>

namespace foci {

SizedFile::SizedFile(const std::filesystem::path& path, std::uint64_t bytes)
    : path_(path), file_(::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
  if (file_ < 0 || ::ftruncate(file_, static_cast<off_t>(bytes)) != 0) {
    if (file_ >= 0) ::close(file_);
    throw std::runtime_error(path.string() + ": cannot be written");
  }
}

SizedFile::~SizedFile() { ::close(file_); }

void SizedFile::put(std::uint64_t at, std::span<const unsigned char> bytes) {
  while (!bytes.empty()) {
    const ssize_t put = ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) throw std::runtime_error(path_.string() + ": cannot be written");
    at += static_cast<std::uint64_t>(put);
    bytes = bytes.subspan(static_cast<std::size_t>(put));
  }
}

}  // namespace foci
