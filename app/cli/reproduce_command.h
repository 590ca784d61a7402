// foci reproduce: the paper's Table 1, Figure 1 and Figure 6, measured on this machine.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "app/evaluation/reproduce/growth.h"
#include "app/evaluation/reproduce/ratios.h"
#include "app/evaluation/reproduce/scenes.h"

namespace CLI {
class App;
}

namespace foci {

struct ReproduceRequest {
  std::filesystem::path out;
  std::optional<ScanView> scan = {};  ///< in place of the statue
  bool quick = false;                 ///< fewer repetitions and views
};

struct ReproduceSummary {
  std::filesystem::path out;
  double seconds = 0.0;
  std::vector<ReproduceRow> rows = {};
  std::vector<ReproduceRatio> ratios = {};
  std::optional<Growth> growth = {};
};

/// Writes table1.csv, reproduce.html, figure1.png and a figure6_SCENE.png each to `out`; nothing is
/// left there when it throws. Progress goes to standard error.
/// @throws InputError, std::runtime_error
ReproduceSummary reproduce(const ReproduceRequest& request);

/// Adds `reproduce` to the command line; it runs as the arguments are parsed.
void addReproduceCommand(CLI::App& app);

}  // namespace foci
