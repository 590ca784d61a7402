// What `foci chart` has measured so far, kept in files, so that nothing is measured twice.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "render/image/frame.h"

namespace foci {

/// What was measured of one method with one setting, in one scene, at one blur.
struct ChartCell {
  double psnr_dB = 0.0;  ///< infinite where it is the reference to the bit
  double ssim = 0.0;
  std::optional<double> silhouette_psnr_dB = {};  ///< nothing where no silhouette is in view
  double coverage_error = 0.0;
  double visible_error = 0.0;  ///< that 95 % of the pixels stay within, just noticeable differences
  std::optional<double> expected_error =
      {};                 ///< what the method said of that; nothing: it does not
  double first_ms = 0.0;  ///< of the frame that the errors are of, at all threads
  std::map<unsigned, std::vector<double>> ms = {};  ///< of the timed frames, by threads
};

/// What cells are measured against.
struct ChartReference {
  int views = 0;
  double split_half_psnr_dB = 0.0;
  Frame frame = {};  ///< without depth
};

/// What every figure hangs on, besides what is in the plan: the program and the machine.
std::string programKey();

/// A folder of cells, a file each. Every file holds a key: all that its figures hang on. A file
/// with another key counts as absent and is overwritten; so does one that cannot be read. Files are
/// written aside and renamed: whenever the program ends, what was stored is whole.
class ChartCells {
 public:
  /// @param key  what all cells hang on: program, machine. The folder is made when needed.
  ChartCells(std::filesystem::path folder, std::string key);

  /// @param name  of the cell's file, without folder and extension
  /// @param key   what this cell hangs on besides
  std::optional<ChartCell> load(const std::string& name, const std::string& key) const;
  /// @throws std::runtime_error where the file cannot be written
  void store(const std::string& name, const std::string& key, const ChartCell& cell) const;

  /// Of a cell that is one figure, finite.
  std::optional<double> loadScore(const std::string& name, const std::string& key) const;
  void storeScore(const std::string& name, const std::string& key, double score) const;

  /// With its frame, to the bit.
  std::optional<ChartReference> loadReference(const std::string& name,
                                              const std::string& key) const;
  /// All but the frame.
  std::optional<ChartReference> loadReferenceFigures(const std::string& name,
                                                     const std::string& key) const;
  void storeReference(const std::string& name, const std::string& key,
                      const ChartReference& reference) const;

 private:
  std::filesystem::path folder_;
  std::string key_;
};

}  // namespace foci
