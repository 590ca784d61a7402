// The options that `foci chart` and `foci reproduce` share: a scan, its view, the number of
// threads.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/scene_in_view.h"

namespace foci {

struct ScanOptions {
  std::string scan{};
  std::vector<double> eye{-4.4, -1.1, 1.3}, look_at{-2.9, 3.9, -1.2}, up{0.0, 0.0, 1.0};
  std::string threads{};
};

/// Adds --scan, --eye, --look-at, --up and --threads.
void addScanOptions(CLI::App& command, ScanOptions& options);

/// The files of the scan; none without a scan.
std::vector<std::filesystem::path> scanFiles(const ScanOptions& options);

/// The scan, if the user gave one. @throws InputError for a pose without a direction of view
std::optional<ScanView> scanViewOf(const ScanOptions& options);

}  // namespace foci
