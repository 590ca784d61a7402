// Measures the paper's Table 1, Figure 1 and Figure 6 on this machine.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "app/evaluation/reproduce/ratios.h"
#include "app/platform/output_guard.h"

namespace foci {

struct ReproduceRequest {
  std::filesystem::path out;
  std::optional<ScanView> scan = {};  ///< instead of the statue
  bool quick = false;                 ///< fewer repetitions and views
  OutputGuard guard = {};
};

struct ReproduceSummary {
  std::filesystem::path out;
  double seconds = 0.0;
  std::vector<ReproduceRow> rows = {};
  std::vector<ReproduceRatio> ratios = {};
  std::optional<Growth> growth = {};
  bool quick = false;  ///< the figures scatter too much to be judged
};

/// The files in `out` that `reproduce` writes. The figures 6 are named for their scenes: these are
/// the figures that are there already.
std::vector<std::filesystem::path> reproduceFiles(const std::filesystem::path& out);

/// Writes table1.csv, reproduce.html, figure1.png and figure6_SCENE.png of both scenes to `out`. If
/// it throws, it leaves nothing there. Progress goes to standard error.
/// @throws InputError, std::runtime_error
ReproduceSummary reproduce(const ReproduceRequest& request);

}  // namespace foci
