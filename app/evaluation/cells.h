// The results of `foci chart` so far, in files: an interrupted run continues without measuring
// anything twice.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/graphics/image.h"
#include "app/platform/output_guard.h"
#include "render/image/frame.h"
#include "render/methods/quality_level.h"

namespace foci {

/// The errors of a frame against its reference, and what `auto` states of them.
struct ChartErrors {
  double psnr_dB = 0.0;  ///< infinite if every bit equals the reference's
  double ssim = 0.0;
  std::optional<double> silhouette_psnr_dB = {};  ///< absent without a silhouette in view
  std::optional<double> coverage_error = {};      ///< absent for another renderer
  double visible_error = 0.0;  ///< 95 % quantile over the pixels, just-noticeable differences
  double flip = 0.0;           ///< mean over the pixels (flip.h)
  /// The visible error that the method predicted; absent if the method predicts none.
  std::optional<double> expected_error = {};
  std::optional<bool> tolerance_met = {};          ///< whether it is within the tolerance
  std::optional<QualityLevel> quality_level = {};  ///< that `auto` chose
};

/// Results of one method with one setting, in one scene, at one blur.
struct ChartCell {
  ChartErrors errors = {};
  double first_ms = 0.0;  ///< time of the frame that the errors belong to, with all threads
  std::map<unsigned, std::vector<double>> ms = {};  ///< times of the timed frames, by threads
};

/// The frame that cells are compared with.
struct ChartReference {
  int views = 0;
  double split_half_psnr_dB = 0.0;
  Frame frame = {};  ///< without depth
};

/// The part of every key that does not depend on the plan: the program and the machine.
std::string programKey();

/// The cells of a chart, with one file for each. Every file states a key, which names everything
/// that its results depend on. A file with another key, or one that cannot be read, counts as
/// absent and is overwritten if the guard allows it. Files are renamed into place, so every file is
/// complete at any moment.
class ChartCells {
 public:
  /// @param chart  the chart's folder: cells go to `cells`, which is made with the first one
  /// @param key    what all cells depend on: program and machine
  ChartCells(std::filesystem::path chart, std::string key, OutputGuard guard);

  // Images of the chart, by their names in its folder.
  bool hasImage(const std::string& name) const;
  void writeImage(const std::string& name, const Image& image) const;
  /// Also writes `differenceFileOf` the image.
  void writeImages(const std::string& name, const Frame& frame, const Frame& reference) const;

  /// @param name  the cell's file name without folder and extension
  /// @param key   what this cell depends on in addition
  std::optional<ChartCell> load(const std::string& name, const std::string& key) const;
  /// @throws InputError, std::runtime_error if the file must not, or cannot be written
  void store(const std::string& name, const std::string& key, const ChartCell& cell) const;

  /// A cell that holds named lists of finite numbers.
  using Lists = std::map<std::string, std::vector<double>>;
  std::optional<Lists> loadLists(const std::string& name, const std::string& key) const;
  void storeLists(const std::string& name, const std::string& key, const Lists& lists) const;

  /// The reference with its frame, to the bit.
  std::optional<ChartReference> loadReference(const std::string& name,
                                              const std::string& key) const;
  /// The reference without the pixels of its frame.
  std::optional<ChartReference> loadReferenceFigures(const std::string& name,
                                                     const std::string& key) const;
  void storeReference(const std::string& name, const std::string& key,
                      const ChartReference& reference) const;

 private:
  std::filesystem::path chart_, folder_;
  std::string key_;
  OutputGuard guard_;
};

}  // namespace foci
