#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>
#include <string>

#include "app/eye/eye_report.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

TEST(EyePage, RefusesAFolderThatCannotBeMadeBeforeItComputes) {
  const TemporaryFolder scratch;
  std::ofstream(scratch.path() / "file") << "no folder";
  Study study;
  study.observer.wavefront.file = scratch.path() / "none.csv";  // read when the computation begins
  try {
    reportEye(study, {}, scratch.path() / "file" / "out", OutputGuard());
    FAIL() << "written";
  } catch (const std::runtime_error& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("cannot make the folder")) << error.what();
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
