#include "app/platform/output_ledger.h"

#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <utility>

#include "base/file.h"
#include "base/input_error.h"

namespace foci {
namespace fs = std::filesystem;
namespace {

constexpr const char* kLedger = ".foci-outputs";
constexpr const char* kFirstLine = "# Files that foci wrote here, and may replace.";

/// Size, time of modification in seconds and nanoseconds, and name, between tabs.
std::optional<std::string> lineOf(const fs::path& file, std::string name) {
  struct stat status {};
  if (::lstat(file.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  std::replace(name.begin(), name.end(), '\n', '?');
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
  lines_.erase(std::remove_if(lines_.begin(), lines_.end(), gone), lines_.end());
}

bool OutputLedger::has(const fs::path& file) const {
  const auto line = lineOf(file, file.filename().string());
  return line && std::find(lines_.begin(), lines_.end(), *line) != lines_.end();
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
