#include "app/platform/shell.h"

#include <gtest/gtest.h>

namespace foci {
namespace FOCI_FILE {

TEST(ShellWord, IsQuotedWhereAShellWouldReadItOtherwise) {
  EXPECT_EQ(shellWord("--set"), "--set");
  EXPECT_EQ(shellWord("observer.pupil_mm=3"), "observer.pupil_mm=3");
  EXPECT_EQ(shellWord("sp ace/a.tsv"), "'sp ace/a.tsv'");
  EXPECT_EQ(shellWord("scene.background=[0, 0, 0]"), "'scene.background=[0, 0, 0]'");
  EXPECT_EQ(shellWord("$HOME"), "'$HOME'");
  EXPECT_EQ(shellWord("it's"), R"('it'\''s')");
  EXPECT_EQ(shellWord("\xc3\xbc.tsv"), "'\xc3\xbc.tsv'");
  EXPECT_EQ(shellWord(""), "''");
}

}  // namespace FOCI_FILE
}  // namespace foci
