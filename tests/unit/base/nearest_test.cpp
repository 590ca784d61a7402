#include "base/nearest.h"

#include <gtest/gtest.h>

namespace foci {
namespace FOCI_FILE {

TEST(NearWord, IsAMisspellingOrNothing) {
  const std::vector<std::string> commands = {"replay", "render",  "live",    "calibrate",
                                             "chart",  "doctor",  "events",  "keys",
                                             "trace",  "prepare", "methods", "reproduce"};
  for (const auto& [word, expected] : {std::pair<const char*, const char*>{"rendr", "render"},
                                       {"rednder", "render"},
                                       {"repaly", "replay"},
                                       {"trcae", "trace"},
                                       {"calibrat", "calibrate"},
                                       {"method", "methods"},
                                       {"event", "events"},
                                       {"liev", "live"},
                                       {"help", ""},
                                       {"convert", ""},
                                       {"view", ""},
                                       {"", ""}}) {
    EXPECT_EQ(nearWord(word, commands).value_or(""), expected) << word;
  }
}

TEST(NearWord, ASwapOfNeighboursIsOneError) {
  EXPECT_TRUE(isMisspelt("fsp", "fps"));
  EXPECT_FALSE(isMisspelt("psf", "fps"));
}

}  // namespace FOCI_FILE
}  // namespace foci
