// Eye tracking in the Brain Imaging Data Structure (BIDS 1.11): `*_physio.tsv.gz` without a header
// line, described by JSON files beside it and higher up in the data set.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "gaze/sources/trace_reader.h"

namespace foci {

/// The JSON files that describe a recording whose name ends in _physio.tsv or _physio.tsv.gz, from
/// the data set's root to the recording: `_physio.json` and `_events.json` whose entities the
/// recording has, too (the inheritance principle). Empty for another file, and without a
/// `_physio.json`.
std::vector<std::filesystem::path> bidsMetadataOf(const std::filesystem::path& file);

/// The recording of the other eye: `recording-eye2` beside `recording-eye1`, or the reverse, if
/// there is one.
std::optional<std::filesystem::path> bidsOtherEyeOf(const std::filesystem::path& file);

/// Reads the columns timestamp, x_coordinate, y_coordinate, pupil_size and blink, with the
/// metadata's units. Names that begin with left_ or right_ belong to one eye, and so do all columns
/// if RecordedEye is left or right. A pupil that is not in millimetres keeps its unit. The screen
/// is that of StimulusPresentation in `_events.json`, in older data sets in `_physio.json`.
/// Positions count from ScreenOrigin: a corner of the screen, or its centre with y up.
///
/// With a recording of the other eye, samples have both eyes if their times agree within half of an
/// interval; their point is the `Cyclopean` point.
/// @param described  as in `streamTrace`
/// @throws InputError also for a file without rows; it names the metadata
TraceHeader readBids(const std::filesystem::path& file, const TraceColumns& described,
                     const Screen& fallback_screen, const TakeSample& take);

}  // namespace foci
