// Lines before a table of gaze that describe the recording.
#pragma once

#include <optional>
#include <string_view>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

struct TablePreamble {
  Screen screen{};
  std::optional<GazeUnits> units{};
  std::optional<double> rate_Hz{};
  bool smi = false;                 ///< the file begins like those of SMI's BeGaze or IDF Converter
  std::optional<char> separator{};  ///< between fields, as a first line `sep=;` states it
  bool tobii_studio = false;        ///< the file begins like those of Tobii Studio 1 and 2
};

/// "px", "deg", "normalised", "relative" and their usual synonyms.
std::optional<GazeUnits> unitsNamed(std::string_view name);

/// Reads a line that begins with '#': `# key=value ...`, or a BeGaze line such as
/// `## Calibration Area:<tab>1680<tab>1050`. Unknown keys are ignored.
/// @throws InputError if a value is out of range
void readPreambleLine(const LineReader& lines, std::string_view line, TablePreamble& preamble);

/// Reads a line `sep=;`, as Excel understands it. @return false at any other line
bool readSeparatorLine(std::string_view line, TablePreamble& preamble);

/// The first line that is not blank, no comment (#) and no line `sep=;`. @return false if there is
/// none
bool nextHeaderLine(LineReader& lines, std::string_view& line, TablePreamble& preamble);

/// The character between the fields of a table: of the line `sep=;`, else the first of tab,
/// semicolon and comma that the header line has, else a blank.
char delimiterOf(std::string_view header, const TablePreamble& before);

/// Reads a line of `KEY:<tab>VALUE` as Tobii Studio 1 and 2 write before the header.
/// @return false at the header line itself
/// @throws InputError if the resolution is out of range
bool readTobiiStudioLine(const LineReader& lines, std::string_view line, TablePreamble& preamble);

/// Whether a file that begins with this line is one of Tobii Studio 1 or 2.
bool startsTobiiStudio(std::string_view line);

/// "1280 x 1024". @return nothing for another text @throws InputError if it is out of range
std::optional<glm::ivec2> resolutionIn(const Place& place, std::string_view text);

/// A number from `low` to `high`. @param range  the limits as words, for the error
/// @throws InputError
double numberIn(const Place& place, std::string_view key, std::string_view text, double low,
                double high, const char* range);

}  // namespace foci
