#include "base/file.h"

#include <fcntl.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {

namespace fs = std::filesystem;

std::string lowerExtension(const fs::path& path) { return lowered(path.extension().string()); }

std::string cannotWrite(const fs::path& path) {
  const std::string text = "cannot write " + path.string();
  std::error_code error;
  fs::path folder = path;
  if (!fs::is_directory(folder, error)) {
    folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    return text + ": " + std::generic_category().message(errno);
  }
  const fs::space_info space = fs::space(folder, error);
  return !error && space.available == 0 ? text + ": the disk is full" : text;
}

void replaceFile(const fs::path& path, const std::string& bytes) {
  const fs::path aside = path.parent_path() / ("." + path.filename().string() + ".part");
  std::error_code ignored;
  try {
    writeText(aside, bytes);
    fs::rename(aside, path);
  } catch (const std::runtime_error&) {
    fs::remove(aside, ignored);
    throw;
  }
}

void writeText(const fs::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  if (!out) throw std::runtime_error(cannotWrite(path));
}

std::optional<fs::path> userFolder(const char* variable, const char* in_home) {
  const char* const named = std::getenv(variable);
  const char* const home = std::getenv("HOME");
  if (named != nullptr && *named != 0) return fs::path(named);
  if (home == nullptr || *home == 0) return std::nullopt;
  return fs::path(home) / in_home;
}

std::string bytesOfFile(const std::filesystem::path& file, std::uintmax_t most) {
  requireRegularFile(file);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::ifstream in(file, std::ios::binary);
  if (error || !in) throw InputError(file.string(), "cannot be read");
  if (size > most) {
    throw InputError(file.string(), "has " + thousands(static_cast<double>(size)) +
                                        " bytes: expected at most " +
                                        thousands(static_cast<double>(most)));
  }
  std::string bytes(static_cast<std::size_t>(size), '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
  return bytes;
}

SizedFile::SizedFile(const fs::path& path, std::uint64_t bytes)
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
