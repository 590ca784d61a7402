#include "base/quiet_stderr.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace foci {
namespace FOCI_FILE {

TEST(QuietStderr, HidesWhatIsWrittenWhileItLives) {
  testing::internal::CaptureStderr();
  std::fputs("before ", stderr);
  {
    const QuietStderr outer;
    std::fputs("hidden", stderr);
    { const QuietStderr inner; }
    std::fputs("hidden", stderr);
  }
  std::fputs("after", stderr);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "before after");
}

}  // namespace FOCI_FILE
}  // namespace foci
