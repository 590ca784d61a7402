// A folder for a test's files, and what a file holds.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace foci {

inline std::string textOf(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// A cache folder for tests: a file lies where foci would keep scenes, so that no test finds what
/// another one kept. Drivers may keep their shaders there.
inline std::filesystem::path cacheWithoutScenes() {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "foci_test_cache";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "foci", std::ios::app);
  return folder;
}

/// A folder of its own for a test, removed with it.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(
      const std::filesystem::path& parent = std::filesystem::temp_directory_path()) {
    std::string name = (parent / "foci_test_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }
  std::string read(const std::string& name) const { return textOf(path_ / name); }

 private:
  std::filesystem::path path_;
};

}  // namespace foci
