#include "app/platform/output_files.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "app/platform/output_guard.h"
#include "base/file.h"
#include "base/input_error.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

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
    OutputFiles files{OutputGuard()};
    files.write(root_ / name, bytes);
    files.commit();
  }

  std::string refusal(const fs::path& output, const fs::path& input, bool overwrite = false) const {
    try {
      OutputGuard({output}, {input}, overwrite);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const TemporaryFolder temporary_;
  const fs::path& root_ = temporary_.path();
};

TEST_F(OutputFilesTest, AppearTogetherInSeveralFolders) {
  OutputFiles files{OutputGuard()};
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
    OutputFiles files{OutputGuard()};
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

/// A staging folder as another run has it, whose lock nobody holds.
/// @param start  of its machine
fs::path otherStaging(const fs::path& folder, const std::string& start, std::chrono::seconds age) {
  const fs::path staging = folder / ".foci-0123456789abcdef";
  for (const char* part : {"claims", "new", "old"}) fs::create_directories(staging / part);
  for (const fs::path& file : {staging / "claims/a.txt", staging / "all"}) writeText(file, "");
  writeText(staging / "lock", start + "\nprocess 7 on lab3 since noon\n");
  fs::last_write_time(staging / "lock", fs::file_time_type::clock::now() - age);
  return staging;
}

std::string thisStart() { return textOf("/proc/sys/kernel/random/boot_id").substr(0, 36); }

TEST_F(OutputFilesTest, RemoveWhatDeadRunsLeft) {
  using std::chrono::seconds;
  for (const auto& [start, age] : {std::pair(thisStart(), seconds(0)), {"other", seconds(3600)}}) {
    const fs::path staging = otherStaging(root_, start, age);
    OutputFiles{OutputGuard()}.stage(root_ / "a.txt");
    EXPECT_FALSE(fs::exists(staging)) << start;
  }
}

TEST_F(OutputFilesTest, AnotherMachinesRunKeepsItsNamesAndItsFolder) {
  const fs::path staging = otherStaging(root_, "other", std::chrono::seconds(5));
  const auto before = names();
  OutputFiles files{OutputGuard()};
  for (const auto& claim : std::vector<std::function<void()>>{[&] { files.stage(root_ / "a.txt"); },
                                                              [&] { files.claimFolder(root_); }}) {
    try {
      claim();
      ADD_FAILURE() << "two runs write one place";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("process 7 on lab3"), std::string::npos);
    }
  }
  make("b.txt", "1");  // a name that nobody has claimed
  EXPECT_TRUE(fs::exists(staging));
}

TEST_F(OutputFilesTest, TwoRunsOnOneMachineShareNoName) {
  OutputFiles first{OutputGuard()}, second{OutputGuard()};
  first.write(root_ / "a.txt", "1");
  EXPECT_THROW(second.stage(root_ / "a.txt"), InputError);
  second.write(root_ / "b.txt", "2");
  second.claimFolder(root_);
  EXPECT_THROW(first.claimFolder(root_), InputError);
  second.commit();
  first.commit();
  EXPECT_EQ(temporary_.read("a.txt") + temporary_.read("b.txt"), "12");
}

// The guard holds again at the moment of the rename.
TEST_F(OutputFilesTest, WhatAppearsDuringTheRunIsNotReplaced) {
  temporary_.write("in.txt", "in");
  for (const bool overwrite : {false, true}) {
    OutputFiles files(OutputGuard({root_ / "a.txt"}, {root_ / "in.txt"}, overwrite));
    files.write(root_ / "b.txt", "new");
    files.write(root_ / "a.txt", "new");
    fs::create_hard_link(root_ / "in.txt", root_ / "a.txt");
    EXPECT_THROW(files.commit(), InputError);
    EXPECT_EQ(temporary_.read("in.txt"), "in");
    EXPECT_FALSE(fs::exists(root_ / "b.txt"));
    fs::remove(root_ / "a.txt");
  }
}

TEST_F(OutputFilesTest, GoWherePathsLeadOnceTheirFoldersAreMade) {
  fs::create_directory(root_ / "sub");
  fs::create_directory_symlink("sub", root_ / "link");
  EXPECT_EQ(filePlace(root_ / "nope/../a.txt"), root_ / "a.txt");
  EXPECT_EQ(filePlace(root_ / "nope/../link/a.txt"), root_ / "sub/a.txt");
  EXPECT_EQ(filePlace(root_ / "link/../a.txt"), root_ / "a.txt");
  EXPECT_EQ(folderPlace(root_ / "nope/x/"), root_ / "nope/x");
  make("nope/../link/a.txt", "1");
  EXPECT_EQ(temporary_.read("sub/a.txt"), "1");
  EXPECT_FALSE(fs::exists(root_ / "nope"));
}

TEST_F(OutputFilesTest, AListThatFociDidNotWriteIsKept) {
  temporary_.write(".foci-outputs", "mine");
  EXPECT_NE(refusal(root_ / "a.txt", {}).find("is not a list that foci wrote"), std::string::npos);
  EXPECT_THROW(make("a.txt", "1"), InputError);
  EXPECT_EQ(temporary_.read(".foci-outputs"), "mine");
}

TEST_F(OutputFilesTest, AFailureLeavesNoListInANewFolder) {
  fs::create_directory(root_ / "taken.txt");
  {
    OutputFiles files{OutputGuard()};
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
  for (const char* name : {"in.txt", "soft", "hard", "nope/../in.txt", "nope/../hard"}) {
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

}  // namespace FOCI_FILE
}  // namespace foci
