#include "app/platform/output_folder.h"

#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <stdexcept>

namespace foci {
namespace fs = std::filesystem;

namespace {

/// Removes the temporary files of killed runs: files whose name holds the id of a process that no
/// longer exists.
void removeLeftovers(const fs::path& folder, const std::string& before, const std::string& after) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(before) || !name.ends_with(after)) continue;
    pid_t process = 0;
    const char* end = name.data() + name.size() - after.size();
    const auto [rest, status] = std::from_chars(name.data() + before.size(), end, process);
    if (status != std::errc() || rest != end || process <= 0) continue;
    std::error_code ignored;
    if (kill(process, 0) != 0 && errno == ESRCH) fs::remove(entry.path(), ignored);
  }
}

}  // namespace

OutputFolder::OutputFolder(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  const fs::path absolute = fs::absolute(folder_, error);
  fs::path part;
  for (const fs::path& name : absolute) {
    part /= name;
    if (fs::is_directory(part, error)) continue;
    if (!fs::create_directory(part, error)) {
      for (auto made = made_.rbegin(); made != made_.rend(); ++made) {
        std::error_code ignored;
        fs::remove(*made, ignored);
      }
      throw std::runtime_error("cannot make the folder " + part.string() + ": " +
                               (error ? error.message() : "the name is taken"));
    }
    made_.push_back(part);
  }
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (committed_) return;
  for (const Staged& file : staged_) fs::remove(file.temporary, ignored);
  for (auto made = made_.rbegin(); made != made_.rend(); ++made) fs::remove(*made, ignored);
}

fs::path OutputFolder::stage(const std::string& name) {
  const fs::path final = folder_ / name;
  const std::string before = "." + final.stem().string() + ".";
  const std::string after = ".part" + final.extension().string();
  removeLeftovers(folder_, before, after);
  fs::path temporary = folder_ / (before + std::to_string(getpid()) + after);
  staged_.push_back({temporary, final});
  return temporary;
}

void OutputFolder::commit() {
  for (const Staged& file : staged_) fs::rename(file.temporary, file.final);
  committed_ = true;
}

}  // namespace foci
