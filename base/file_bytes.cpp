#include "base/file_bytes.h"

#include <algorithm>
#include <fstream>
#include <system_error>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {

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

}  // namespace foci
