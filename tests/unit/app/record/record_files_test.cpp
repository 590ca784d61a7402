#include "app/record/record_files.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <vector>

#include "base/input_error.h"
#include "gaze/sources/trace_reader.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

namespace fs = std::filesystem;

TEST(RecordFiles, GazeComesBackToTheLastBit) {
  const TemporaryFolder scratch;
  const Screen screen{.size_px = {1919, 1079}, .size_m = {0.53131, 0.29897}, .distance_m = 0.6123};
  const fs::path file = scratch.path() / "gaze.tsv";
  std::vector<GazeSample> samples;
  for (int i = 0; i < 50; ++i) {
    GazeSample sample{.time_s = wholeMicroseconds(17.0 + 0.004001 * i)};
    if (i % 7 != 3) sample.point_px = glm::dvec2(100.0 / 3.0 * i, -1.0 / (1.0 + i));
    sample.blink = i % 7 == 3;
    if (i % 2) sample.pupil_mm = 3.0 + 0.1 / 3.0 * i;
    if (i % 3) sample.uncertainty_deg = 0.7 / (i + 1.0);
    if (i % 5) sample.eyes[1].point_px = glm::dvec2(std::sqrt(2.0) * i, 0.1 * i);
    samples.push_back(sample);
  }
  {
    GazeTable table(file, screen);
    for (const GazeSample& sample : samples) table.add(sample);
    table.flush();
  }
  const GazeTrace trace = readTrace(file, {}, {});
  EXPECT_EQ(trace.screen->size_m, screen.size_m);
  EXPECT_EQ(trace.screen->distance_m, screen.distance_m);
  ASSERT_EQ(trace.samples.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(trace.samples[i].time_s, samples[i].time_s);
    EXPECT_EQ(trace.samples[i].point_px, samples[i].point_px);
    EXPECT_EQ(trace.samples[i].blink, samples[i].blink);
    EXPECT_EQ(trace.samples[i].pupil_mm, samples[i].pupil_mm);
    EXPECT_EQ(trace.samples[i].uncertainty_deg, samples[i].uncertainty_deg);
    EXPECT_EQ(trace.samples[i].eyes[1].point_px, samples[i].eyes[1].point_px);
  }
}

TEST(RecordFiles, HeadsComeBackToTheLastBit) {
  const TemporaryFolder scratch;
  const fs::path file = scratch.path() / "head.tsv";
  std::vector<HeadRow> rows;
  std::string text = headHeader();
  for (int i = 0; i < 20; ++i) {
    rows.push_back({.time_s = wholeMicroseconds(5.0 + 0.011003 * (i - 3 * (i % 2))),
                    .of_sample = i % 2 == 1,
                    .head = {.position_m = {0.1 / 3.0 * i, std::sqrt(2.0), -1.0 / (1.0 + i)},
                             .world_from_head = glm::angleAxis(0.1 * i, glm::dvec3(0, 0.6, 0.8))}});
    text += headRow(rows.back());
  }
  scratch.write("head.tsv", text);
  const auto read = readHeads(file);
  ASSERT_EQ(read.size(), rows.size());
  std::vector<GazeSample> samples{{.time_s = 4.0}, {.time_s = rows[3].time_s}};
  giveHeads(read, samples);
  EXPECT_FALSE(samples[0].head);
  ASSERT_TRUE(samples[1].head);
  EXPECT_EQ(samples[1].head->position_m, rows[3].head.position_m);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(read[i].time_s, rows[i].time_s);
    EXPECT_EQ(read[i].of_sample, rows[i].of_sample);
    EXPECT_EQ(read[i].head.position_m, rows[i].head.position_m);
    EXPECT_EQ(read[i].head.world_from_head, rows[i].head.world_from_head);
  }
  // The record of a killed run ends within a row.
  scratch.write("head.tsv", text.substr(0, text.rfind('\t')));
  EXPECT_EQ(readHeads(file).size(), rows.size() - 1);
}

TEST(RecordFiles, RefuseHeadsThatAreNone) {
  const TemporaryFolder scratch;
  const auto refusal = [&](const std::string& more) {
    scratch.write("head.tsv", headHeader() + "1\tframe\t0\t0\t0\t0\t0\t0\t0\t1\n" + more);
    try {
      readHeads(scratch.path() / "head.tsv");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal("1\tsample\t0\t0\t0\t0\t0\t0\t0\t1\n"), "");
  const auto expect = [&](const std::string& row, const char* part) {
    const std::string said = refusal(row);
    EXPECT_NE(said.find(part), std::string::npos) << row << said;
    EXPECT_NE(said.find(":3"), std::string::npos) << said;
  };
  expect("1\tframe\t0\t0\t0\t0\t0\t0\t0\t1\n", "not before the last");
  expect("2\tframe\t0\t0\t0\t0\t0\t0\t0\t0\n", "quaternion of length 1");
  expect("2\tframe\t0\tx\t0\t0\t0\t0\t0\t1\n", "x");
}

TEST(RecordFiles, AFrameSaysWhichSamplesItKnew) {
  const TemporaryFolder scratch;
  const fs::path file = scratch.path() / "frames.tsv";
  std::ofstream(file, std::ios::binary)
      << "time_s\tgaze_time_s\tmethod\n1\tn/a\tsweep\n2\t1.5\tsweep\n3\t1.5\tsweep\n";
  const auto frames = readFrames(file);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].known_s, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(frames[1].known_s, 1.5);
  EXPECT_EQ(frames[2].known_s, 1.5);
  std::ofstream(file, std::ios::binary) << "time_s\tmethod\n1\tsweep\n";
  EXPECT_EQ(readFrames(file)[0].known_s, 1.0);
}

TEST(RecordFiles, RefusesTablesThatAreNone) {
  const TemporaryFolder scratch;
  const auto write = [&](const std::string& text) {
    fs::path file = scratch.path() / "table.tsv";
    std::ofstream(file, std::ios::binary) << text;
    return file;
  };
  EXPECT_THROW(readFrames(write("")), InputError);
  EXPECT_THROW(readFrames(write("time_s\tmethod\n")), InputError);
  EXPECT_THROW(readFrames(write("time_s\n1\n")), InputError);
  EXPECT_THROW(readFrames(write("time_s\tmethod\n1\tswep\n")), InputError);
  EXPECT_THROW(readFrames(write("time_s\tmethod\n1\tsweep\n1\tsweep\n")), InputError);
  EXPECT_EQ(readFrames(write("time_s\tmethod\n1\tsweep\n2\tpinhole\n")).size(), 2u);
  EXPECT_THROW(readFrames(write("time_s\tmethod\n1\n2\tpinhole\n")), InputError);
  EXPECT_EQ(readFrames(write("time_s\tmethod\n1\tsweep\n2")).size(), 1u);  // cut off
  EXPECT_THROW(readChanges(write("time_s\tkey\tvalue\n1\tseed\t3\n")), InputError);
  EXPECT_THROW(readChanges(write("time_s\tkey\tvalue\n1\tobserver.pupil_mm\n")), InputError);
  EXPECT_EQ(readChanges(write("time_s\tkey\tvalue\n")).size(), 0u);
}

}  // namespace FOCI_FILE
}  // namespace foci
