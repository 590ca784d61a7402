#include "app/replay/recordings.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/input_error.h"

namespace foci {
namespace FOCI_FILE {

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

TEST(FolderNames, AreSafeFolders) {
  EXPECT_EQ(folderNames({"/d/...tsv", "/d/.tsv", "/d/..tsv"}), (Names{"__", "_tsv", "_"}));
  EXPECT_EQ(folderNames({"/d/index.html.tsv", "/d/recordings.tsv.asc"}),
            (Names{"index.html_", "recordings.tsv_"}));
  EXPECT_EQ(folderNames({"/d/a\nb\t:c.tsv", "/d/caf\xe9.tsv", "/d/caf\xc3\xa9.tsv"}),
            (Names{"a_nb_t_c", "caf_xe9", "caf\xc3\xa9"}));
  EXPECT_LE(folderNames({"/d/" + std::string(250, 'a')})[0].size(), 120u);
}

TEST(FolderNames, DifferByMoreThanCase) {
  EXPECT_EQ(folderNames({"/d/Gaze.tsv", "/d/gaze.asc"}), (Names{"Gaze.tsv", "gaze.asc"}));
  EXPECT_EQ(folderNames({"/d/Gaze.tsv", "/d/gaze.tsv"}), (Names{"Gaze", "gaze-2"}));
}

}  // namespace FOCI_FILE
}  // namespace foci
