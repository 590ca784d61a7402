// Recognises files that are no recording as text, by their first bytes. Magic numbers are those of
// file(1) and of each format's own description.

#include <zlib.h>

#include <algorithm>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "gaze/sources/recording_formats.h"

namespace foci {
namespace {

using namespace std::string_view_literals;

struct Magic {
  std::string_view bytes;
  const char* kind;
  const char* advice;
  std::size_t at = 0;
};

constexpr const char* kVideo = "for a video of a face use webcam:FILE";
constexpr const char* kExportTable = "export a table as text (TSV or CSV)";
constexpr const char* kNoGaze = "expected a recording of gaze as text (TSV, CSV, ASC)";

constexpr Magic kMagics[] = {
    {"SR_RESEARCH"sv, "an EyeLink EDF file",
     "convert it with SR Research's edf2asc, then read the .asc file"},
    {"0       "sv, "a European Data Format file of biosignals (EDF)", kNoGaze},
    {"\xff"
     "BIOSEMI"sv,
     "a BioSemi file of biosignals (BDF)", kNoGaze},
    {"\x89HDF\r\n\x1a\n"sv, "an HDF5 file (PsychoPy ioHub, MATLAB 7.3)",
     "export its table of samples as CSV, for example with h5dump or pandas"},
    {"MATLAB 5.0 MAT-file"sv, "a MATLAB file",
     "write its table of samples as CSV, in MATLAB with writetable"},
    {"SQLite format 3\0"sv, "an SQLite database", kExportTable},
    {"PAR1"sv, "a Parquet file", kExportTable},
    {"ARROW1"sv, "an Arrow file", kExportTable},
    {"\x93NUMPY"sv, "a NumPy file", "write it as CSV with numpy.savetxt"},
    {"PK\x03\x04"sv, "a ZIP archive or an Excel or Calc workbook",
     "unpack it, or save the sheet as CSV"},
    {"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"sv, "an old Excel workbook or another Office file",
     "save the sheet as CSV"},
    {"7z\xbc\xaf\x27\x1c"sv, "a 7z archive", "unpack it"},
    {"Rar!"sv, "a RAR archive", "unpack it"},
    {"\xfd"
     "7zXZ"sv,
     "an xz file", "unpack it, or pack it with gzip"},
    {"BZh"sv, "a bzip2 file", "unpack it, or pack it with gzip"},
    {"\x28\xb5\x2f\xfd"sv, "a Zstandard file", "unpack it, or pack it with gzip"},
    {"%PDF"sv, "a PDF document", kNoGaze},
    {"\x89PNG"sv, "a PNG image", kNoGaze},
    {"\xff\xd8\xff"sv, "a JPEG image", kNoGaze},
    {"RIFF"sv, "a video or sound file", kVideo},
    {"\x1a\x45\xdf\xa3"sv, "a Matroska video", kVideo},
    {"\xff\xfe"sv, "text in UTF-16", "convert it: iconv -f UTF-16 -t UTF-8 FILE > NEW"},
    {"\xfe\xff"sv, "text in UTF-16", "convert it: iconv -f UTF-16 -t UTF-8 FILE > NEW"},
    {"<?xml"sv, "an XML file", kExportTable},
    {"<!DOCTYPE plist"sv, "an XML file", kExportTable},
    {"<REC "sv, "a log of the Open Gaze API", kExportTable},
    {"version https://git-lfs"sv, "a pointer of Git LFS", "git lfs pull fetches the recording"},
    {"\x7f"
     "ELF"sv,
     "a program", kNoGaze},
    {"ply\n"sv, "a scene (PLY)", "give it as --scene; a recording holds gaze"},
    {"ply\r"sv, "a scene (PLY)", "give it as --scene; a recording holds gaze"},
    {"ftyp"sv, "an MP4 or MOV video", kVideo, 4},
};

std::string kindText(const char* kind, const char* advice) {
  return std::string("is ") + kind + ": " + advice;
}

}  // namespace

std::optional<std::string> otherFileKind(std::string_view start,
                                         const std::filesystem::path& name) {
  for (const Magic& magic : kMagics) {
    const std::string_view bytes = start.substr(std::min(magic.at, start.size()));
    if (bytes.starts_with(magic.bytes)) return kindText(magic.kind, magic.advice);
  }
  // A pickle of protocol 2 or later; MessagePack has no magic number.
  if (start.size() >= 2 && start[0] == '\x80' && start[1] >= 2 && start[1] <= 5) {
    return kindText("a Python pickle", "write its table of samples as CSV");
  }
  const std::size_t first = start.find_first_not_of(" \t\r\n");
  const std::string text = lowered(start.substr(std::min(first, start.size())));
  if (text.starts_with("<!doctype html") || text.starts_with("<html")) {
    return kindText("a web page", "download the recording itself");
  }
  if (first != std::string_view::npos && start[first] == '[' && start.find('{') != start.npos) {
    return kindText("a JSON list (WebGazer, jsPsych)",
                    "write its samples as a table, with t, x and y of a sample in each row");
  }
  if (first != std::string_view::npos && start[first] == '{') {
    return kindText("a JSON file", "expected a table; from Tobii Pro Glasses export it in Pro Lab");
  }
  const std::string ending = lowerExtension(name);
  if (ending == ".idf") {
    return kindText("an SMI IDF file", "convert it to text with SMI's IDF Converter or BeGaze");
  }
  if (ending == ".edf" && start.find('\0') != start.npos) {
    return kindText("an EDF file", "an EyeLink EDF is converted with SR Research's edf2asc");
  }
  if (ending == ".pldata") {
    return kindText("Pupil Core's own recording", "export it in Pupil Player (gaze_positions.csv)");
  }
  return std::nullopt;
}

std::string unpackedStart(const std::filesystem::path& file, std::size_t count) {
  std::string bytes(count, '\0');
  gzFile in = gzopen(file.string().c_str(), "rb");
  const int read = in ? gzread(in, bytes.data(), static_cast<unsigned>(count)) : 0;
  if (in) gzclose(in);
  bytes.resize(static_cast<std::size_t>(std::max(read, 0)));
  return bytes;
}

void requireGazeText(const std::filesystem::path& file) {
  const std::string start = unpackedStart(file, 64);
  if (start.empty()) return;  // the reader reports it
  if (const auto kind = otherFileKind(start, file)) throw InputError(file.string(), *kind);
}

}  // namespace foci
