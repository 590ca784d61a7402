// A part of a run: frames `first` to `end` - 1, rendered by one process. `foci join` makes one run
// of all parts.
//
// The folder of a part holds the study, part.json, maps, and each image that was rendered as PNG. A
// part begins with an image, whether or not the run has rendered it there.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "app/replay/replay.h"
#include "app/replay/replayed_eye.h"
#include "app/replay/run_writer.h"
#include "app/study/study.h"

namespace foci {

/// Frames `first` to `end` - 1 of a run.
struct FrameSpan {
  std::size_t first = 0, end = 0;
  bool operator==(const FrameSpan&) const = default;
};

/// The frames that a part is asked for: a span, or one of `parts` equal parts, `part` from 1 on.
struct FramesAsked {
  FrameSpan span{};  ///< its end may lie behind that of the run
  std::size_t part = 0, parts = 0;
};

/// A frame of a part as its folder holds it.
struct PartFrame {
  SeenFrame seen;
  std::string image;                     ///< name of the PNG file; empty: that of the frame before
  std::string sha256;                    ///< of the image's pixels; empty with it
  std::vector<std::string> maps_sha256;  ///< of the files of its maps, in the order of output.maps
};

struct Part {
  std::filesystem::path folder{};
  std::string version{};        ///< of foci
  std::string configuration{};  ///< of the study, as JSON
  std::string study_sha256{};   ///< of the folder's study.toml
  FrameSpan span{};
  std::size_t frames = 0;  ///< of the whole run
  bool screen_is_default = false;
  std::string study_file{};  ///< of the run, which the folder's study comes from
  unsigned threads = 0;
  std::string device{};
  std::vector<std::string> warnings{};  ///< of rendering; the inputs' come again with the inputs
  std::vector<InputFile> inputs{};      ///< by the names that the run was given
  std::vector<std::filesystem::path> input_places{};  ///< of the inputs, absolute
  std::vector<PartFrame> all{};                       ///< the frames of the span
};

/// The files that a part of the study writes, and images that an earlier part left.
std::vector<std::filesystem::path> partFiles(const std::filesystem::path& out);

/// Renders a part into `out`. The eye looks at the frames before, but they are not rendered.
/// @return the part's span
/// @throws InputError as `replay`, and for frames that the run lacks or a study that has no parts
FrameSpan replayPart(const Study& study, const FramesAsked& asked, const std::filesystem::path& out,
                     unsigned threads, ReplayedScene& scene, const OutputGuard& guard);

/// @throws InputError
Part readPart(const std::filesystem::path& folder);

/// The study of a part, with absolute names of files.
/// @throws InputError
Study studyOf(const Part& part);

/// Puts parts in order.
/// @throws InputError unless they are the parts of one run, each frame in one of them
std::vector<Part> inOrder(std::vector<Part> parts);

/// Writes the files of a replay to `out`, with the bytes that one process would have written. Only
/// times (`render_ms`), and what the manifest says of command and machine, may differ.
/// @param parts  `inOrder`
/// @param study  `studyOf` a part
/// @throws InputError, std::runtime_error
RunResult join(const std::vector<Part>& parts, const Study& study, const std::filesystem::path& out,
               const std::string& command, const OutputGuard& guard);

}  // namespace foci
