#include "app/replay/recordings.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/input_error.h"

namespace foci {
namespace {

using Names = std::vector<std::string>;

TEST(FolderNames, AreThoseOfTheFiles) {
  EXPECT_EQ(folderNames({"/data/anna.tsv", "/data/ben.asc"}), (Names{"anna", "ben"}));
}

TEST(FolderNames, HaveAsManyFoldersAsTellThemApart) {
  EXPECT_EQ(folderNames({"/d/sub-01/gaze.tsv", "/d/sub-02/gaze.tsv"}),
            (Names{"sub-01-gaze", "sub-02-gaze"}));
  EXPECT_EQ(folderNames({"/d/sub-01/a/gaze.tsv", "/d/sub-02/a/gaze.tsv"}),
            (Names{"sub-01-a-gaze", "sub-02-a-gaze"}));
}

TEST(FolderNames, HaveTheExtensionIfNothingElseDiffers) {
  EXPECT_EQ(folderNames({"/d/gaze.tsv", "/d/gaze.asc"}), (Names{"gaze.tsv", "gaze.asc"}));
}

TEST(FolderNames, OfAVideoAreThoseOfItsFile) {
  EXPECT_EQ(folderNames({"webcam:/d/face.mp4", "/d/gaze.tsv"}), (Names{"face", "gaze"}));
}

TEST(FolderNames, AreRefusedForAFileGivenTwice) {
  EXPECT_THROW(folderNames({"/d/gaze.tsv", "/d/../d/gaze.tsv"}), InputError);
}

}  // namespace
}  // namespace foci
