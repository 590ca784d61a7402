// Runs the real binary and looks at what it leaves.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"

namespace foci::e2e {

struct Outcome {
  int exit_code = -1;  ///< 128 + signal where one ended it
  std::string out, err;
};

/// Runs `foci` with these arguments in `folder` and waits.
/// @param environment  variables to set, "NAME=value"
Outcome runFoci(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                const std::vector<std::string>& environment = {});

/// The same, sent SIGTERM as soon as `appears` exists.
Outcome terminateFoci(const std::vector<std::string>& arguments,
                      const std::filesystem::path& folder, const std::filesystem::path& appears);

/// What befalls a run.
struct Fault {
  std::optional<int> killed_after_ms{};         ///< by SIGKILL
  std::optional<std::size_t> max_file_bytes{};  ///< writing beyond fails, as on a full disk
  bool as_nobody = false;  ///< without rights of its own, where the test runs as root
  std::optional<std::filesystem::path> appears{};  ///< when it does,
  std::vector<std::filesystem::path> vanish{};     ///< these are removed
  std::vector<std::string> environment{};          ///< variables to set, "NAME=value"
};

Outcome runFociUnder(const Fault& fault, const std::vector<std::string>& arguments,
                     const std::filesystem::path& folder);

/// The real data, or nothing where they are not here.
std::optional<std::filesystem::path> dataFolder();

/// A PLY (ASCII) of a square of n x n points across the line of sight, `distance_m` before an eye
/// at the origin that looks along -z.
std::string squarePly(int n, double distance_m);

/// The same of 60 x 60 coloured points, a metre wide, each at a depth of its own, by column and
/// row.
std::string reliefPly(const std::function<double(int x, int y)>& depth_m);

/// A study of such a scene: a few small frames.
std::string smallStudy();

/// A recording (TSV) of a second at 100 Hz, at the middle of a 640x480 screen.
std::string steadyTrace();

/// Columns of a table, by row; the header is row 0.
std::vector<std::vector<std::string>> tableOf(const std::string& text);

}  // namespace foci::e2e
