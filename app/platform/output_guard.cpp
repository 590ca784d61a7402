#include "app/platform/output_guard.h"

#include <sys/stat.h>

#include <climits>
#include <set>

#include "app/platform/output_ledger.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxName = NAME_MAX - 35;   // leaves room for the names of helpers' files
constexpr std::size_t kMaxPath = PATH_MAX - 300;  // and for the staging folder

/// The same for all names of one file: device and inode; of a file that does not exist yet, its
/// place.
std::string identityOf(const fs::path& place) {
  struct stat status {};
  if (::stat(place.c_str(), &status) != 0) return place.string();
  return std::to_string(status.st_dev) + ' ' + std::to_string(status.st_ino);
}

void checkName(const fs::path& output) {
  const auto refuse = [&](const char* what, std::size_t length, std::size_t most) {
    throw InputError(shown(output.string()), std::string(what) + " of " + std::to_string(length) +
                                                 " bytes: expected at most " +
                                                 std::to_string(most));
  };
  for (const fs::path& folder : output.parent_path()) {
    const std::size_t bytes = folder.native().size();
    if (bytes > NAME_MAX) refuse("a folder's name", bytes, NAME_MAX);
  }
  const fs::path name = output.filename();
  if (name.native().size() > kMaxName) refuse("a name", name.native().size(), kMaxName);
  if (output.native().size() > kMaxPath) refuse("a path", output.native().size(), kMaxPath);
  if (name.empty() || name == "." || name == "..") {
    throw InputError(output.string(), "a folder: expected a file");
  }
}

}  // namespace

fs::path folderPlace(const fs::path& folder) {
  constexpr int kMaxPasses = 40;  // as many links as Linux follows
  std::error_code error;
  fs::path place = fs::absolute(folder.empty() ? "." : folder, error);
  // A `..` after a folder to be made can uncover a link, which the next pass follows.
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    fs::path next = fs::weakly_canonical(place, error);
    if (error) break;
    if (!next.has_filename()) next = next.parent_path();
    if (next == place) return place;
    place = std::move(next);
  }
  return place.lexically_normal();
}

fs::path filePlace(const fs::path& file) {
  return folderPlace(file.parent_path()) / file.filename();
}

void requireFolderOrNothing(const fs::path& folder) {
  std::error_code ignored;
  for (fs::path part = folder; !part.empty(); part = part.parent_path()) {
    const fs::file_status status = fs::status(part, ignored);
    if (fs::is_directory(status)) return;
    if (fs::exists(status)) throw InputError(part.string(), "is a file: expected a folder");
  }
}

OutputGuard::OutputGuard(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs,
                         bool overwrite)
    : overwrite_(overwrite) {
  for (const fs::path& input : inputs) {
    if (input.empty()) continue;
    const fs::path place = filePlace(input);
    inputs_.emplace(identityOf(place), input);
    inputs_.emplace(place.string(), input);
  }
  std::set<std::string> seen;
  WrittenFiles written;
  for (const fs::path& output : outputs) {
    if (output.empty()) continue;
    checkName(output);
    requireFolderOrNothing(output.parent_path());
    const fs::path place = filePlace(output);
    check(output, place, written.has(place));
    if (!seen.insert(identityOf(place)).second) {
      throw InputError(output.string(), "named for two outputs: expected a file for each");
    }
  }
}

void OutputGuard::check(const fs::path& output, const fs::path& place, bool ours) const {
  for (const std::string& key : {identityOf(place), place.string()}) {
    const auto found = inputs_.find(key);
    if (found == inputs_.end()) continue;
    const fs::path& input = found->second;
    throw InputError(output.string(), "would replace " +
                                          (input == output ? "an input" : input.string()) +
                                          ": expected another name for the output");
  }
  std::error_code ignored;
  const fs::file_status target = fs::status(place, ignored);
  if (fs::is_directory(target)) throw InputError(output.string(), "is a folder: expected a file");
  if (fs::exists(target)) requireRegularFile(place);
  if (overwrite_ || ours || !fs::exists(fs::symlink_status(place, ignored))) return;
  throw InputError(output.string(),
                   "is there already, and not as foci left it: expected another name, or "
                   "--overwrite");
}

}  // namespace foci
