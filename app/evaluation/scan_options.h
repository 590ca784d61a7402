// The options of the commands that measure: a scan and from where it is seen, threads.
#pragma once

#include <tbb/global_control.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/scene_in_view.h"

namespace CLI {
class App;
}

namespace foci {

struct ScanOptions {
  std::string scan;
  std::vector<double> eye{-4.4, -1.1, 1.3}, look_at{-2.9, 3.9, -1.2}, up{0.0, 0.0, 1.0};
  std::optional<int> threads;
};

/// Adds --scan, --eye, --look-at, --up and --threads.
void addScanOptions(CLI::App& command, ScanOptions& options);

/// The scan, if one was given. @throws InputError for a view that is none
std::optional<ScanView> scanViewOf(const ScanOptions& options);

/// Holds the threads to what was given, if anything, as long as it lives.
/// @throws InputError for a number out of range
std::unique_ptr<tbb::global_control> threadLimit(const ScanOptions& options);

}  // namespace foci
