// Writes a recording as BIDS 1.11: a table and its JSON for each eye, messages, and the screen.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/trace_reader.h"

struct gzFile_s;  // of zlib

namespace foci {

struct BidsMetadata {
  std::vector<std::filesystem::path> files{};     ///< from the data set's root to the recording
  nlohmann::ordered_json physio{};                ///< keys of nearer files replace those higher up
  nlohmann::ordered_json stimulus{};              ///< StimulusPresentation; null: none
  std::optional<std::filesystem::path> events{};  ///< `_events.tsv` of the task
  std::optional<std::filesystem::path> messages{};  ///< `_physioevents.tsv.gz` of the recording
  nlohmann::ordered_json physioevents{};            ///< of `messages`

  /// Of a key of `physio`; absent if it is no number.
  std::optional<double> number(const char* key) const;
  /// The same; empty if it is no text.
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

/// What the samples of a recording hold, so that only columns with values are written.
struct BidsContents {
  struct Values {
    std::size_t points = 0, pupils_mm = 0, pupils_own = 0;
  };
  Values both{};
  std::array<Values, 2> eyes{};
  std::size_t blinks = 0;

  void add(const GazeSample& sample);
  /// 0 left, 1 right; one entry without a value: the gaze of both eyes alone.
  std::vector<std::optional<std::size_t>> recordings() const;
};

/// The files of a recording, for `--out FOLDER/sub-01_task-look_physio.tsv.gz`.
struct BidsNames {
  /// @throws InputError for another ending than _physio.tsv.gz
  explicit BidsNames(const std::filesystem::path& out);

  /// recording-eye1: the left eye, or both together; recording-eye2: the right eye.
  /// @param suffix  "physio.tsv.gz", "physio.json", "physioevents.tsv.gz", ...
  std::filesystem::path ofEye(std::optional<std::size_t> side, const std::string& suffix) const;
  /// "events.json", "events.tsv"
  std::filesystem::path ofTask(const std::string& suffix) const;

 private:
  std::filesystem::path folder_;
  std::string stem_;  // without recording-LABEL
};

/// A gzip file that notices what it could not write.
class PackedOutput {
 public:
  /// @throws std::runtime_error if the file cannot be written
  explicit PackedOutput(const std::filesystem::path& file);

  void write(const std::string& text);
  /// @throws std::runtime_error if not everything could be written
  void close();

 private:
  std::string name_;
  std::unique_ptr<gzFile_s, int (*)(gzFile_s*)> file_;
  bool failed_ = false;
};

/// The table of one eye, packed, sample by sample, in constant memory. Throws as `PackedOutput`.
class BidsTable {
 public:
  BidsTable(const std::filesystem::path& file, const BidsContents& contents,
            std::optional<std::size_t> side);

  void add(const GazeSample& sample);
  void finish();

 private:
  PackedOutput file_;
  std::optional<std::size_t> side_;
  bool pupils_mm_, pupils_own_, blinks_;
  std::string text_{};
};

/// The JSON beside such a table.
std::string bidsPhysioJson(const TraceHeader& header, const BidsContents& contents,
                           std::optional<std::size_t> side, double rate_Hz);

/// The `_events.json` of the task: the screen. Quantities that are 0 are left out.
std::string bidsEventsJson(const Screen& screen);

/// Whether such a file states the same screen. Quantities that are 0 in `screen` may be stated.
bool statesScreen(const std::filesystem::path& events_json, const Screen& screen);

/// The messages of a recording: onset, duration, message. No header line; `bidsMessagesJson` names
/// the columns.
std::string bidsMessages(const std::vector<TraceMarker>& markers);
std::string bidsMessagesJson();

/// The JSON beside a table of onset, duration and one more column.
/// @param meaning  of the column
std::string bidsTableJson(const std::string& column, const std::string& description,
                          const std::string& meaning);

/// Packs a text with gzip. @throws std::runtime_error
void writePacked(const std::filesystem::path& file, const std::string& text);

}  // namespace foci
