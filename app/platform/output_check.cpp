#include <sys/stat.h>

#include <climits>
#include <map>
#include <set>
#include <string>

#include "app/platform/output_files.h"
#include "app/platform/output_ledger.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxName = NAME_MAX - 35;  // leaves room for the temporary name
constexpr std::size_t kMaxPath = PATH_MAX - 300;

/// The same for all names of one file: device and inode; of a file that does not exist yet, its
/// name without links.
std::string identityOf(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) == 0) {
    return std::to_string(status.st_dev) + ' ' + std::to_string(status.st_ino);
  }
  std::error_code error;
  const fs::path name = fs::weakly_canonical(fs::absolute(file, error), error);
  return error ? file.string() : name.string();
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
  const std::size_t name_bytes = output.filename().native().size();
  if (name_bytes > kMaxName) refuse("a name", name_bytes, kMaxName);
  if (output.native().size() > kMaxPath) refuse("a path", output.native().size(), kMaxPath);
  if (!output.has_filename()) throw InputError(output.string(), "a folder: expected a file");
}

void checkPlace(const fs::path& output, WrittenFiles& written, bool overwrite) {
  requireFolderOrNothing(output.parent_path());
  std::error_code ignored;
  const fs::file_status target = fs::status(output, ignored);
  if (fs::is_directory(target)) throw InputError(output.string(), "is a folder: expected a file");
  if (fs::exists(target)) requireRegularFile(output);
  if (!fs::exists(fs::symlink_status(output, ignored))) return;
  if (!overwrite && !written.has(output)) {
    throw InputError(output.string(),
                     "is there already, and not as foci left it: expected another name, or "
                     "--overwrite");
  }
}

}  // namespace

void requireFolderOrNothing(const fs::path& folder) {
  std::error_code ignored;
  for (fs::path part = folder; !part.empty(); part = part.parent_path()) {
    const fs::file_status status = fs::status(part, ignored);
    if (fs::is_directory(status)) return;
    if (fs::exists(status)) throw InputError(part.string(), "is a file: expected a folder");
  }
}

void checkOutputs(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs,
                  bool overwrite) {
  std::map<std::string, fs::path> input_of;
  for (const fs::path& input : inputs) {
    if (!input.empty()) input_of.emplace(identityOf(input), input);
  }
  std::set<std::string> seen;
  WrittenFiles written;
  for (const fs::path& output : outputs) {
    if (output.empty()) continue;
    checkName(output);
    const std::string identity = identityOf(output);
    if (const auto found = input_of.find(identity); found != input_of.end()) {
      const fs::path& input = found->second;
      throw InputError(output.string(), "would replace " +
                                            (input == output ? "an input" : input.string()) +
                                            ": expected another name for the output");
    }
    if (!seen.insert(identity).second) {
      throw InputError(output.string(), "named for two outputs: expected a file for each");
    }
    checkPlace(output, written, overwrite);
  }
}

}  // namespace foci
