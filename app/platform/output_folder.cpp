#include "app/platform/output_folder.h"

#include <utility>

namespace foci {

OutputFolder::OutputFolder(std::filesystem::path folder, const OutputGuard& guard)
    : folder_(std::move(folder)), files_(guard) {
  files_.claimFolder(folder_);
}

std::filesystem::path OutputFolder::stage(const std::string& name) {
  return files_.stage(folder_ / name);
}

void OutputFolder::write(const std::string& name, const std::string& bytes) {
  files_.write(folder_ / name, bytes);
}

void OutputFolder::write(const std::string& name,
                         const std::function<void(const std::filesystem::path&)>& write_to) {
  files_.write(folder_ / name, write_to);
}

void OutputFolder::commit() { files_.commit(); }

}  // namespace foci
