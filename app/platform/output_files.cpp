#include "app/platform/output_files.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <map>
#include <stdexcept>
#include <utility>

#include "app/platform/output_ledger.h"
#include "base/file.h"

namespace foci {
namespace fs = std::filesystem;

namespace {

/// The id of a process between two parts of a name; 0 if there is none.
pid_t processIn(const std::string& name, const std::string& before, const std::string& after) {
  if (!name.starts_with(before) || !name.ends_with(after)) return 0;
  if (name.size() <= before.size() + after.size()) return 0;
  pid_t process = 0;
  const char* end = name.data() + name.size() - after.size();
  const auto [rest, status] = std::from_chars(name.data() + before.size(), end, process);
  return status == std::errc() && rest == end ? process : 0;
}

fs::path folderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

}  // namespace

OutputFiles::~OutputFiles() {
  std::error_code ignored;
  if (committed_) return;
  for (const Staged& file : staged_) fs::remove(file.temporary, ignored);
  for (auto made = made_.rbegin(); made != made_.rend(); ++made) fs::remove(*made, ignored);
}

void OutputFiles::makeFolder(const fs::path& folder) {
  std::error_code error;
  fs::path part;
  for (const fs::path& name : fs::absolute(folder, error)) {
    part /= name;
    if (fs::is_directory(part, error)) continue;
    if (!fs::create_directory(part, error)) {
      throw std::runtime_error("cannot make the folder " + part.string() + ": " +
                               (error ? error.message() : "the name is taken"));
    }
    made_.push_back(part);
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    throw std::runtime_error(cannotWrite(folder));
  }
}

void OutputFiles::removeLeftovers(const fs::path& folder, const std::string& before,
                                  const std::string& after) {
  std::error_code error;
  const auto [names, is_new] = hidden_.try_emplace(folder);
  if (is_new) {
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with('.')) names->second.push_back(name);
    }
  }
  for (const std::string& name : names->second) {
    const pid_t process = processIn(name, before, after);
    if (process <= 0 || kill(process, 0) == 0 || errno != ESRCH) continue;
    fs::remove(folder / name, error);
  }
}

fs::path OutputFiles::stage(const fs::path& file) {
  const fs::path folder = folderOf(file);
  makeFolder(folder);
  const std::string before = "." + file.stem().string() + ".";
  const std::string extension = file.extension().string();
  const std::string process = std::to_string(getpid());
  for (const char* what : {".part", ".old"}) removeLeftovers(folder, before, what + extension);
  staged_.push_back({.temporary = folder / (before + process + ".part" + extension),
                     .final = file,
                     .old = folder / (before + process + ".old" + extension)});
  return staged_.back().temporary;
}

void OutputFiles::write(const fs::path& file,
                        const std::function<void(const fs::path&)>& write_to) {
  const fs::path temporary = stage(file);
  try {
    write_to(temporary);
  } catch (const std::runtime_error&) {
    throw std::runtime_error(cannotWrite(file));
  }
}

void OutputFiles::write(const fs::path& file, const std::string& bytes) {
  write(file, [&](const fs::path& temporary) { writeText(temporary, bytes); });
}

void OutputFiles::place(Staged& file) {
  std::error_code error;
  fs::create_hard_link(file.final, file.old, error);
  const bool linked = !error;
  file.replaced = fs::exists(fs::symlink_status(file.final, error));
  if (!linked) file.old.clear();  // no old file, or no hard links on this file system
  fs::rename(file.temporary, file.final, error);
  if (error) {
    throw std::runtime_error("cannot write " + file.final.string() + ": " + error.message());
  }
  file.placed = true;
}

void OutputFiles::undo() noexcept {
  std::error_code ignored;
  for (auto file = staged_.rbegin(); file != staged_.rend(); ++file) {
    if (file->placed && !file->old.empty() && file->replaced) {
      fs::rename(file->old, file->final, ignored);
    } else if (file->placed && !file->replaced) {
      fs::remove(file->final, ignored);
    }
    if (!file->old.empty()) fs::remove(file->old, ignored);
  }
}

void OutputFiles::commit() {
  std::map<fs::path, OutputLedger> ledgers;
  try {
    for (const Staged& file : staged_) {
      const fs::path folder = fs::canonical(folderOf(file.final));
      const auto ledger = ledgers.try_emplace(folder, folder).first;
      ledger->second.add(file.temporary, file.final.filename().string());
    }
    for (auto& [folder, ledger] : ledgers) ledger.save();
    for (Staged& file : staged_) place(file);
  } catch (const std::exception&) {
    undo();
    for (auto& [folder, ledger] : ledgers) ledger.giveUp();
    throw;
  }
  committed_ = true;
  std::error_code ignored;
  for (const Staged& file : staged_) {
    if (!file.old.empty()) fs::remove(file.old, ignored);
  }
}

}  // namespace foci
