#include "app/platform/output_files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>

#include "app/platform/output_ledger.h"
#include "base/file.h"
#include "base/input_error.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace {

namespace fs = std::filesystem;

bool wrote(const fs::path& file) { return WrittenFiles().has(file); }

class OutputFilesTest : public testing::Test {
 protected:
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(root_)) all.insert(entry.path().filename());
    return all;
  }

  void make(const std::string& name, const std::string& bytes) const {
    OutputFiles files;
    files.write(root_ / name, bytes);
    files.commit();
  }

  std::string refusal(const fs::path& output, const fs::path& input, bool overwrite = false) const {
    try {
      checkOutputs({output}, {input}, overwrite);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const TemporaryFolder temporary_;
  const fs::path& root_ = temporary_.path();
};

TEST_F(OutputFilesTest, AppearTogetherInSeveralFolders) {
  OutputFiles files;
  files.write(root_ / "a/one.txt", "1");
  files.write(root_ / "b/two.txt", "2");
  EXPECT_FALSE(fs::exists(root_ / "a/one.txt"));
  files.commit();
  EXPECT_EQ(temporary_.read("a/one.txt"), "1");
  EXPECT_EQ(temporary_.read("b/two.txt"), "2");
}

// The second name is taken by a folder, which no file can replace.
TEST_F(OutputFilesTest, AFailureRestoresWhatWasReplaced) {
  make("old.txt", "old");
  const auto before = names();
  {
    OutputFiles files;
    files.write(root_ / "old.txt", "new");
    files.write(root_ / "new.txt", "new");
    files.write(root_ / "taken.txt", "new");
    fs::create_directory(root_ / "taken.txt");
    EXPECT_THROW(files.commit(), std::runtime_error);
  }
  fs::remove(root_ / "taken.txt");
  EXPECT_EQ(temporary_.read("old.txt"), "old");
  EXPECT_EQ(names(), before);
  EXPECT_TRUE(wrote(root_ / "old.txt"));
}

// 2^30 is above the ids that Linux gives to processes.
TEST_F(OutputFilesTest, RemoveTheTemporaryFilesOfKilledRuns) {
  const std::string own = std::to_string(getpid());
  for (const std::string name : {".a.1073741824.part.txt", ".a.1073741824.old.txt"}) {
    temporary_.write(name, "left");
  }
  const std::set<std::string> kept = {".a." + own + ".old.txt", ".b.1073741824.part.txt",
                                      ".a.x.part.txt", "a.1073741824.part.txt"};
  for (const std::string& name : kept) temporary_.write(name, "kept");
  OutputFiles().stage(root_ / "a.txt");
  EXPECT_EQ(names(), kept);
}

TEST_F(OutputFilesTest, AFailureLeavesNoListInANewFolder) {
  fs::create_directory(root_ / "taken.txt");
  {
    OutputFiles files;
    files.write(root_ / "taken.txt", "new");
    EXPECT_THROW(files.commit(), std::runtime_error);
  }
  EXPECT_EQ(names(), std::set<std::string>{"taken.txt"});
}

TEST_F(OutputFilesTest, AFileIsOursWhileItIsAsWeLeftIt) {
  make("a.txt", "1");
  EXPECT_TRUE(wrote(root_ / "a.txt"));
  make("b.txt", "2");
  make("a.txt", "3");
  EXPECT_TRUE(wrote(root_ / "a.txt"));
  EXPECT_TRUE(wrote(root_ / "b.txt"));
  fs::last_write_time(root_ / "a.txt", fs::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_FALSE(wrote(root_ / "a.txt"));
  temporary_.write("b.txt", "longer");
  EXPECT_FALSE(wrote(root_ / "b.txt"));
  temporary_.write("c.txt", "3");
  EXPECT_FALSE(wrote(root_ / "c.txt"));
  EXPECT_FALSE(wrote(root_ / "absent.txt"));
}

// A run that is killed between its list and its renames leaves the old file, which is still ours.
TEST_F(OutputFilesTest, TheListNamesOldAndNewFileUntilTheNewOneIsThere) {
  make("a.txt", "old");
  temporary_.write("aside", "newer");
  {
    OutputLedger ledger(root_);
    ledger.add(root_ / "aside", "a.txt");
    ledger.save();
  }
  EXPECT_TRUE(wrote(root_ / "a.txt"));
  fs::rename(root_ / "aside", root_ / "a.txt");
  EXPECT_TRUE(wrote(root_ / "a.txt"));
}

TEST_F(OutputFilesTest, OddNamesAreListedToo) {
  for (const std::string name : {"tab\tname", "line\nname", "# name", "n\xe4me"}) {
    make(name, "1");
    EXPECT_TRUE(wrote(root_ / name)) << name;
  }
}

TEST_F(OutputFilesTest, ChecksRefuseInputsFoldersAndForeignFiles) {
  temporary_.write("in.txt", "in");
  fs::create_symlink("in.txt", root_ / "soft");
  fs::create_hard_link(root_ / "in.txt", root_ / "hard");
  for (const char* name : {"in.txt", "soft", "hard"}) {
    EXPECT_NE(refusal(root_ / name, root_ / "in.txt", true).find("would replace"),
              std::string::npos);
  }
  EXPECT_NE(refusal(root_, root_ / "in.txt", true).find("is a folder"), std::string::npos);
  EXPECT_NE(refusal(root_ / "in.txt/out.txt", {}).find("in.txt: is a file: expected a folder"),
            std::string::npos);
  EXPECT_NE(refusal(root_ / "in.txt/a/out.txt", {}).find("is a file"), std::string::npos);
  temporary_.write("foreign", "mine");
  fs::create_symlink("nowhere", root_ / "dangling");
  for (const char* name : {"foreign", "dangling"}) {
    EXPECT_NE(refusal(root_ / name, root_ / "in.txt").find("--overwrite"), std::string::npos);
    EXPECT_EQ(refusal(root_ / name, root_ / "in.txt", true), "");
  }
  EXPECT_EQ(refusal(root_ / "new", root_ / "in.txt"), "");
  EXPECT_EQ(refusal("", root_ / "in.txt"), "");
}

}  // namespace
}  // namespace foci
