#include "app/platform/output_ledger.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <utility>

#include "base/file.h"

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

std::vector<std::string> linesOf(const fs::path& ledger) {
  std::vector<std::string> lines;
  std::error_code ignored;
  if (!fs::is_regular_file(ledger, ignored)) return lines;
  std::ifstream in(ledger, std::ios::binary);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with('#')) lines.push_back(line);
  }
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
  const auto line = lineOf(file, file.filename().string());
  if (!line) return false;
  const auto [list, is_new] = lists_.try_emplace(file.parent_path());
  if (is_new) {
    for (std::string& one : linesOf(file.parent_path() / kLedger)) {
      list->second.insert(std::move(one));
    }
  }
  return list->second.contains(*line);
}

OutputLedger::OutputLedger(fs::path folder) : folder_(std::move(folder)) {
  const fs::path ledger = folder_ / kLedger;
  is_new_ = !fs::exists(fs::symlink_status(ledger));
  file_ = ::open(ledger.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
  struct stat status {};
  if (file_ < 0 || ::fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) {
    if (file_ >= 0) ::close(file_);
    throw std::runtime_error(cannotWrite(ledger));
  }
  ::flock(file_, LOCK_EX);  // where a file system has no locks, the list works without
  lines_ = linesOf(ledger);
  const auto gone = [&](const std::string& line) { return !stillThere(folder_, line); };
  lines_.erase(std::remove_if(lines_.begin(), lines_.end(), gone), lines_.end());
}

OutputLedger::OutputLedger(OutputLedger&& other) noexcept
    : folder_(std::move(other.folder_)),
      lines_(std::move(other.lines_)),
      is_new_(other.is_new_),
      file_(std::exchange(other.file_, -1)) {}

OutputLedger::~OutputLedger() {
  if (file_ >= 0) ::close(file_);
}

void OutputLedger::add(const fs::path& temporary, const std::string& name) {
  auto line = lineOf(temporary, name);
  if (line) lines_.push_back(std::move(*line));
}

void OutputLedger::save() {
  std::string text(kFirstLine);
  text += '\n';
  for (const std::string& line : lines_) text += line + '\n';
  const bool written =
      ::pwrite(file_, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size()) &&
      ::ftruncate(file_, static_cast<off_t>(text.size())) == 0;
  if (!written) throw std::runtime_error(cannotWrite(folder_ / kLedger));
}

void OutputLedger::giveUp() noexcept {
  std::error_code ignored;
  if (is_new_) fs::remove(folder_ / kLedger, ignored);
}

}  // namespace foci
