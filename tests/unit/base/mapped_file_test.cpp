#include "base/mapped_file.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "base/input_error.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

unsigned char lastByte(const MappedFile& file) {
  const volatile unsigned char* const last = &file.bytes().back();
  return *last;
}

TEST(MappedFile, HoldsTheBytesOfTheFile) {
  const TemporaryFolder folder;
  const MappedFile file(folder.write("a", "seven b"));
  EXPECT_EQ(std::string(file.bytes().begin(), file.bytes().end()), "seven b");
  readAhead(file.bytes());
  releasePages(file.bytes());
  EXPECT_EQ(lastByte(file), 'b');
  EXPECT_TRUE(MappedFile(folder.write("empty", "")).bytes().empty());
  EXPECT_THROW(MappedFile(folder.path() / "none"), InputError);
  EXPECT_THROW(MappedFile(folder.path()), InputError);
}

TEST(MappedFileDeathTest, AFileThatShrinksEndsTheProgramWithOneLine) {
  const TemporaryFolder folder;
  const auto path = folder.write("scene", std::string(100'000, 'x'));
  const auto readAfterShrinking = [&] {
    endOnLostPages();
    const MappedFile file(path), other(path);
    std::filesystem::resize_file(path, 10'000);
    lastByte(file);
  };
  EXPECT_EXIT(readAfterShrinking(), testing::ExitedWithCode(1),
              "^foci: [^\n]*scene: was cut short, or cannot be read any more, while foci used "
              "it\n$");
}

TEST(MappedFileDeathTest, AnotherFaultStaysASignal) {
  const auto fault = [] {
    endOnLostPages();
    std::raise(SIGBUS);
  };
  EXPECT_EXIT(fault(), testing::KilledBySignal(SIGBUS), "");
}

TEST(MappedFileDeathTest, AProgramsOwnHandlerIsKept) {
  const TemporaryFolder folder;
  const auto path = folder.write("scene", std::string(100'000, 'x'));
  const auto readAfterShrinking = [&](void (*own)(int)) {
    std::signal(SIGBUS, own);
    endOnLostPagesUnlessHandled();
    const MappedFile file(path);
    std::filesystem::resize_file(path, 10'000);
    lastByte(file);
  };
  EXPECT_EXIT(readAfterShrinking([](int) { std::_Exit(7); }), testing::ExitedWithCode(7), "^$");
  std::filesystem::resize_file(path, 100'000);
  EXPECT_EXIT(readAfterShrinking(SIG_DFL), testing::ExitedWithCode(1), "was cut short");
}

}  // namespace FOCI_FILE
}  // namespace foci
