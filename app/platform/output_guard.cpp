#include "app/platform/output_guard.h"

#include <sys/stat.h>
#include <algorithm>
#include <climits>
#include <fstream>
#include <optional>
#include <utility>

#include "base/file.h"
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

namespace {

constexpr const char* kLedger = ".foci-outputs";
constexpr const char* kFirstLine = "# Files that foci wrote here, and may replace.";

/// Size, time of modification in seconds and nanoseconds, and name, between tabs.
std::optional<std::string> lineOf(const fs::path& file, std::string name) {
  struct stat status {};
  if (::lstat(file.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  std::ranges::replace(name, '\n', '?');
  return std::to_string(status.st_size) + '\t' + std::to_string(status.st_mtim.tv_sec) + '\t' +
         std::to_string(status.st_mtim.tv_nsec) + '\t' + name;
}

/// @throws InputError if the list is not one of foci's
std::vector<std::string> linesOf(const fs::path& ledger) {
  std::vector<std::string> lines;
  std::error_code ignored;
  const fs::file_status status = fs::symlink_status(ledger, ignored);
  if (!fs::exists(status)) return lines;
  std::ifstream in(ledger, std::ios::binary);
  std::string line;
  const bool is_ours =
      fs::is_regular_file(status) && in && std::getline(in, line) && line == kFirstLine;
  if (!is_ours) {
    throw InputError(ledger.string(),
                     "is not a list that foci wrote: expected another folder, or to remove it");
  }
  while (std::getline(in, line)) lines.push_back(line);
  return lines;
}

/// Whether the folder has a file as the line says.
bool stillThere(const fs::path& folder, const std::string& line) {
  std::size_t at = 0;
  for (int field = 0; field < 3; ++field) at = line.find('\t', at) + 1;
  const std::string name = line.substr(at);
  return lineOf(folder / name, name) == line;
}

}  // namespace

bool WrittenFiles::has(const fs::path& file) {
  const auto [list, is_new] = lists_.try_emplace(file.parent_path());
  if (is_new) {
    for (std::string& one : linesOf(file.parent_path() / kLedger)) {
      list->second.insert(std::move(one));
    }
  }
  const auto line = lineOf(file, file.filename().string());
  return line && list->second.contains(*line);
}

OutputLedger::OutputLedger(const fs::path& folder)
    : folder_(folder),
      lock_(folder_),
      lines_(linesOf(folder_ / kLedger)),
      is_new_(!fs::exists(folder_ / kLedger)) {
  const auto gone = [&](const std::string& line) { return !stillThere(folder_, line); };
  std::erase_if(lines_, gone);
}

bool OutputLedger::has(const fs::path& file) const {
  const auto line = lineOf(file, file.filename().string());
  return line && std::ranges::find(lines_, *line) != lines_.end();
}

void OutputLedger::add(const fs::path& temporary, const std::string& name) {
  auto line = lineOf(temporary, name);
  if (line) lines_.push_back(std::move(*line));
}

void OutputLedger::save() {
  std::string text(kFirstLine);
  text += '\n';
  for (const std::string& line : lines_) text += line + '\n';
  replaceFile(folder_ / kLedger, text);
}

void OutputLedger::giveUp() noexcept {
  std::error_code ignored;
  if (is_new_) fs::remove(folder_ / kLedger, ignored);
}

}  // namespace foci
