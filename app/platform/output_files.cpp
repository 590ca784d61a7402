#include "app/platform/output_files.h"

#include <fcntl.h>
#include <unistd.h>
#include <cerrno>
#include <mutex>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "base/file.h"
#include "base/input_error.h"

namespace foci {

namespace fs = std::filesystem;

namespace {

/// All objects, for an interrupt, which removes what is not committed.
struct Unfinished {
  std::mutex mutex;
  std::set<OutputFiles*> all;
};

Unfinished& unfinished() {
  static auto* const objects =
      new Unfinished;  // never destroyed: an interrupt can come at any time
  return *objects;
}

}  // namespace

OutputFiles::OutputFiles(OutputGuard guard) : guard_(std::move(guard)) {
  const std::lock_guard lock(unfinished().mutex);
  unfinished().all.insert(this);
}

OutputFiles::~OutputFiles() {
  const std::lock_guard lock(unfinished().mutex);
  unfinished().all.erase(this);
  abandon();
}

void OutputFiles::abandon() noexcept {
  std::error_code ignored;
  stagings_.clear();
  for (auto made = made_.rbegin(); made != made_.rend(); ++made) fs::remove(*made, ignored);
}

void OutputFiles::makeFolder(const fs::path& folder) {
  const std::lock_guard lock(unfinished().mutex);
  makePlace(folder);
}

void OutputFiles::claimFolder(const fs::path& folder) {
  const std::lock_guard lock(unfinished().mutex);
  stagingIn(makePlace(folder)).claimAll();
}

fs::path OutputFiles::makePlace(const fs::path& folder) {
  std::error_code error;
  fs::path place = folderPlace(folder), part;
  for (const fs::path& name : place) {
    part /= name;
    if (fs::is_directory(part, error)) continue;
    if (!fs::create_directory(part, error)) {
      throw std::runtime_error("cannot make the folder " + part.string() + ": " +
                               (error ? error.message() : "the name is taken"));
    }
    made_.push_back(part);
  }
  if (access(place.c_str(), W_OK | X_OK) != 0) throw std::runtime_error(cannotWrite(place));
  return place;
}

StagingFolder& OutputFiles::stagingIn(const fs::path& place) {
  return stagings_.try_emplace(place, place).first->second;
}

fs::path OutputFiles::stage(const fs::path& file) {
  const std::lock_guard lock(unfinished().mutex);
  const fs::path folder = makePlace(file.parent_path());
  StagingFolder& staging = stagingIn(folder);
  const std::string name = file.filename().string();
  staging.claim(name);
  staged_.push_back({.output = file,
                     .temporary = staging.newFile(name),
                     .final = folder / name,
                     .old = staging.oldFile(name)});
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

void OutputFiles::place(Staged& file, const OutputLedger& ledger) {
  guard_.check(file.output, file.final, ledger.has(file.final));
  std::error_code error;
  fs::create_hard_link(file.final, file.old, error);
  const bool linked = !error;
  file.replaced = fs::exists(fs::symlink_status(file.final, error));
  if (!linked) file.old.clear();  // no old file, or no hard links on this file system
  if (!file.replaced && renameat2(AT_FDCWD, file.temporary.c_str(), AT_FDCWD, file.final.c_str(),
                                  RENAME_NOREPLACE) == 0) {
    file.placed = true;
    return;
  }
  if (!file.replaced && errno == EEXIST) {
    throw InputError(file.output.string(), "has just been made by another program");
  }
  fs::rename(file.temporary, file.final, error);  // not all file systems know RENAME_NOREPLACE
  if (error) {
    throw std::runtime_error("cannot write " + file.output.string() + ": " + error.message());
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
  }
}

void OutputFiles::commit() {
  const std::lock_guard lock(unfinished().mutex);
  std::map<fs::path, OutputLedger> ledgers;
  try {
    // In one order for all runs: each ledger keeps other runs waiting.
    std::set<fs::path> folders;
    for (const Staged& file : staged_) folders.insert(file.final.parent_path());
    for (const fs::path& folder : folders) ledgers.try_emplace(folder, folder);
    for (const Staged& file : staged_) {
      ledgers.at(file.final.parent_path()).add(file.temporary, file.final.filename().string());
    }
    for (auto& [folder, ledger] : ledgers) ledger.save();
    for (Staged& file : staged_) place(file, ledgers.at(file.final.parent_path()));
  } catch (const std::exception&) {
    undo();
    for (auto& [folder, ledger] : ledgers) ledger.giveUp();
    throw;
  }
  made_.clear();
  staged_.clear();
  stagings_.clear();
}

void writeOutput(const fs::path& file, const std::string& bytes, const OutputGuard& guard) {
  OutputFiles files(guard);
  files.write(file, bytes);
  files.commit();
}

void touchUnfinishedOutputs() {
  const std::lock_guard lock(unfinished().mutex);
  for (OutputFiles* files : unfinished().all) {
    for (auto& [folder, staging] : files->stagings_) staging.touch();
  }
}

void removeUnfinishedOutputs() {
  unfinished().mutex.lock();
  for (OutputFiles* files : unfinished().all) files->abandon();
}

OutputFolder::OutputFolder(std::filesystem::path folder, const OutputGuard& guard)
    : folder_(std::move(folder)), files_(guard) {
  files_.claimFolder(folder_);
}

}  // namespace foci
