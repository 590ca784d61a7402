#include "app/graphics/video_writer.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

TEST(VideoWriter, SaysWhyAFileCannotBeWritten) {
  const TemporaryFolder scratch;
  const auto file = scratch.path() / "none" / "video.mp4";
  try {
    const VideoWriter video(file, {64, 48}, 30.0);
    FAIL() << "opened";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), "cannot write " + file.string() + ": No such file or directory");
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
