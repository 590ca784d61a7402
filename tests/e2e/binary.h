// Runs the real binary and collects its outputs.
#pragma once

#include <csignal>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"

namespace foci::e2e {

struct Outcome {
  int exit_code = -1;  ///< 128 + signal if a signal ended the process
  std::string out, err;
};

/// Runs `foci` with these arguments in `folder` and waits.
/// @param environment  variables to set, "NAME=value"
Outcome runFoci(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                const std::vector<std::string>& environment = {});

/// Runs `foci` and sends the signals as soon as the file `appears` exists.
Outcome terminateFoci(const std::vector<std::string>& arguments,
                      const std::filesystem::path& folder, const std::filesystem::path& appears,
                      const std::vector<int>& signals = {SIGTERM});

/// A fault from outside the process.
struct Fault {
  std::optional<int> killed_after_ms{};            ///< SIGKILL after this time
  unsigned max_s = 0;                              ///< SIGALRM after this time; 0: never
  std::optional<std::size_t> max_file_bytes{};     ///< longer files fail, as on a full disk
  bool as_nobody = false;                          ///< drops the rights of root
  std::optional<std::filesystem::path> appears{};  ///< as soon as this file exists,
  std::vector<std::filesystem::path> vanish{};     ///< these files are removed,
  std::vector<int> signals{};                      ///< and these signals are sent
  std::vector<std::string> environment{};          ///< variables to set, "NAME=value"
};

Outcome runFociUnder(const Fault& fault, const std::vector<std::string>& arguments,
                     const std::filesystem::path& folder);

/// The folder of the real data, if it is here.
std::optional<std::filesystem::path> dataFolder();

/// A PLY (ASCII) of a square of n x n points across the line of sight, `distance_m` before an eye
/// at the origin that looks along -z.
std::string squarePly(int n, double distance_m);

/// A PLY (ASCII) of 60 x 60 coloured points, 1 m wide.
/// @param depth_m  distance of the point in a column and a row
std::string reliefPly(const std::function<double(int x, int y)>& depth_m);

/// A study of scene.ply and trace.tsv with a few small frames.
std::string smallStudy();

/// A recording (TSV) of 1 s at 100 Hz, in the middle of a screen of 640x480 px.
std::string steadyTrace();

/// The fields of a TSV table by row; the header is row 0.
std::vector<std::vector<std::string>> tableOf(const std::string& text);

}  // namespace foci::e2e
