// A small table whose columns are known by their names.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/input_error.h"
#include "gaze/sources/rows.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

class NamedTables : public testing::Test {
 protected:
  std::vector<std::string> names(const std::string& text, bool comments) {
    NamedTable table(scratch.write("t.tsv", text), "object dwell_s");
    if (!comments) table.withoutComments();
    std::vector<std::string> found;
    const std::size_t object = table.column("object");
    while (table.next()) found.emplace_back(table.text(object));
    return found;
  }
  TemporaryFolder scratch;
};

TEST_F(NamedTables, ARowMayBeginWithAHashWhereThereAreNoComments) {
  const std::string text = "object\tdwell_s\nwall\t1\n#2\t0.5\n";
  EXPECT_EQ(names(text, true), (std::vector<std::string>{"wall"}));
  EXPECT_EQ(names(text, false), (std::vector<std::string>{"wall", "#2"}));
}

TEST_F(NamedTables, ARowOfAnotherNumberOfFieldsIsRefusedByLine) {
  try {
    names("object\tdwell_s\nwall\t1\nfloor\n", true);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("t.tsv:3: 1 field: expected 2"), std::string::npos)
        << error.what();
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
