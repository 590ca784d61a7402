#include "gaze/sources/recording_formats.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include "base/input_error.h"
#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

using namespace std::string_view_literals;

TEST(FileKind, NamesTheFormatAndWhatToDo) {
  const struct {
    std::string_view start;
    const char *name, *says;
  } cases[] = {{"SR_RESEARCH_COMBFILE\0\x01"sv, "a.edf",
                "EyeLink EDF file: convert it with SR Research's edf2asc"},
               {"0       X X X X"sv, "b.edf", "European Data Format"},
               {"\x89HDF\r\n\x1a\n\0"sv, "c.hdf5", "HDF5"},
               {"MATLAB 5.0 MAT-file, Platform"sv, "d.mat", "writetable"},
               {"PK\x03\x04zz"sv, "e.xlsx", "save the sheet as CSV"},
               {"\xff\xfeT\0i\0"sv, "f.tsv", "iconv -f UTF-16 -t UTF-8"},
               {"\0\0\0\x18"
                "ftypmp42"sv,
                "h.mp4", "webcam:FILE"},
               {"{\"type\":\"gaze\"}"sv, "gazedata", "JSON"},
               {"[\n  {\"x\": 958, \"y\": 542}"sv, "webgazer.json", "WebGazer"},
               {"\x01\x02\0\x03"sv, "i.idf", "SMI's IDF Converter"},
               {"\x82\xa5topic"sv, "gaze.pldata", "Pupil Player"},
               {"ply\nformat ascii 1.0"sv, "lion.ply", "scene"},
               {"<REC CNT=\"1\" FPOGX=\"0.5\" />\r\n"sv, "open_gaze.xml", "Open Gaze API"},
               {"version https://git-lfs.github.com/spec/v1\n"sv, "a.csv", "git lfs pull"},
               {"\n\n<!doctype html>\n"sv, "a.csv", "web page"},
               {"<HTML>"sv, "a.tsv", "web page"}};
  for (const auto& [start, name, says] : cases) {
    const auto kind = otherFileKind(start, name);
    ASSERT_TRUE(kind) << name;
    EXPECT_NE(kind->find(says), std::string::npos) << *kind;
    EXPECT_EQ(kind->find('\n'), std::string::npos);
  }
  for (const std::string_view text :
       {"time\tx\ty\n"sv, "** CONVERTED FROM a.edf"sv, "## [BeGaze]\n"sv, "\xef\xbb\xbftime,x"sv,
        "0 1 2\n"sv, ""sv}) {
    EXPECT_FALSE(otherFileKind(text, "gaze.tsv")) << text;
  }
}

TEST(FileKind, IsReportedByTheReaderAlsoWhenPacked) {
  const ScratchFile file("");
  gzFile out = gzopen(file.path().c_str(), "wb");
  gzputs(out, "SR_RESEARCH_COMBFILE and more");
  gzclose(out);
  try {
    readTrace(file.path(), {}, {});
    ADD_FAILURE() << "not refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("edf2asc"), std::string::npos) << error.what();
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
