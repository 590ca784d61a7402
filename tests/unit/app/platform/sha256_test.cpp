#include "app/platform/sha256.h"

#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>

#include "base/input_error.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

TEST(Sha256, OfAFileIsThatOfItsBytes) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "abc";
  std::ofstream(file) << "abc";
  EXPECT_EQ(sha256OfFile(file), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_THROW(sha256OfFile(folder.path() / "none"), InputError);
  EXPECT_THROW(sha256OfFile(folder.path()), InputError);
}

TEST(Sha256, OfAFileThatVanishesOnceItIsOpen) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "abc";
  std::ofstream(file) << "abc";
  FileToHash opened(file);
  const std::string whole = sha256OfFile(file);
  std::filesystem::remove(file);
  EXPECT_EQ(opened.sha256(), whole);
}

TEST(Sha256, OfAFileStopsBetweenBlocks) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "zeros";
  std::ofstream(file) << std::string(std::size_t{3} << 20, '\0');
  int blocks = 0;
  FileToHash(file).sha256([&] { ++blocks; });
  EXPECT_EQ(blocks, 4);  // the last one finds the end
  const auto stop = [&] {
    if (--blocks == 2) throw std::runtime_error("stopped");
  };
  EXPECT_THROW(FileToHash(file).sha256(stop), std::runtime_error);
  EXPECT_EQ(blocks, 2);
}

}  // namespace FOCI_FILE
}  // namespace foci
