#include "base/file.h"

#include <cctype>
#include <fstream>
#include <stdexcept>

namespace foci {
namespace fs = std::filesystem;

std::string lowerExtension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
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
  if (!out) throw std::runtime_error("cannot write " + path.string());
}

}  // namespace foci
