// The metadata of a BIDS recording, merged from all JSON files that apply to it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

struct BidsMetadata {
  std::vector<std::filesystem::path> files{};  ///< from the data set's root to the recording
  nlohmann::ordered_json physio{};             ///< keys of nearer files replace those higher up
  nlohmann::ordered_json stimulus{};           ///< StimulusPresentation; null: none

  /// Of a key of `physio`; empty if it is no text.
  std::string text(const char* key) const;
  /// What StimulusPresentation states of the screen.
  Screen screen() const;
  /// The unit of a column in the short form of `ColumnNames`; empty if none is stated.
  std::string unitOf(const std::string& column) const;
};

/// @param file  whose name ends in _physio.tsv or _physio.tsv.gz
/// @return nothing for another name, and if no `_physio.json` applies
/// @throws InputError if a JSON file cannot be read
std::optional<BidsMetadata> bidsMetadata(const std::filesystem::path& file);

}  // namespace foci
