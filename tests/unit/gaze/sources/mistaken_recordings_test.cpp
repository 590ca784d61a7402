// Recordings that are described wrongly, or broken: each is refused, or a warning names the key to
// set. They are made here from one good recording, which raises no doubt.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "gaze/sources/trace_reader.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.5313, 0.2989}, .distance_m = 0.6};
constexpr int kRows = 1500;
constexpr double kRate_Hz = 100.0;

/// A row of the good recording.
struct Row {
  int number = 0;
  double time_s = 0.0, x = 0.0, y = 0.0;  // pixels
};

/// Fixations of a third of a second, anywhere on the screen, with 3 px of noise.
std::vector<Row> goodRows() {
  std::uint64_t state = 7;
  const auto uniform = [&] {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state >> 40u) / static_cast<double>(1u << 24u);
  };
  std::vector<Row> rows;
  double at_x = 960.0, at_y = 540.0;
  for (int i = 0; i < kRows; ++i) {
    if (i % 33 == 0) {
      at_x = 100.0 + 1720.0 * uniform();
      at_y = 60.0 + 960.0 * uniform();
    }
    rows.push_back({i, i / kRate_Hz, at_x + 6.0 * uniform() - 3.0, at_y + 6.0 * uniform() - 3.0});
  }
  return rows;
}

using Fields = std::function<std::vector<double>(const Row&)>;

std::string table(const std::string& header, const Fields& fields, char delimiter = ',') {
  std::string text = header + "\n";
  for (const Row& row : goodRows()) {
    bool first = true;
    for (const double value : fields(row)) {
      char number[40];
      std::snprintf(number, sizeof number, "%.10g", value);
      if (!first) text += delimiter;
      text += number;
      first = false;
    }
    text += '\n';
  }
  return text;
}

/// The refusal, or all warnings; empty: silent.
std::string saidAbout(const std::string& text, const TraceColumns& columns = {},
                      const Screen& screen = kScreen, std::optional<double> rate_Hz = {}) {
  try {
    std::string said;
    for (const std::string& warning :
         readTrace(ScratchFile(text).path(), columns, screen, rate_Hz).warnings) {
      said += "- " + warning + "\n";
    }
    return said;
  } catch (const InputError& error) {
    return error.what();
  }
}

struct Mistake {
  const char* what;
  std::string said;
  const char* key;  ///< that the message must name
};

const std::string kXy = "time_s,x_px,y_px";

Fields mapped(const std::function<glm::dvec2(const Row&)>& point) {
  return [point](const Row& row) {
    const glm::dvec2 p = point(row);
    return std::vector<double>{row.time_s, p.x, p.y};
  };
}

glm::dvec2 metres(const Row& row) { return {row.x / 1920.0 * 0.5313, row.y / 1080.0 * 0.2989}; }
glm::dvec2 degrees(const Row& row) { return {(row.x - 960.0) / 38.0, (540.0 - row.y) / 38.0}; }
glm::dvec2 fractions(const Row& row) { return {row.x / 1920.0, row.y / 1080.0}; }

std::vector<Mistake> wrongUnits() {
  TraceColumns px, deg, norm, named;
  px.units = GazeUnits::px;
  deg.units = GazeUnits::deg;
  norm.units = GazeUnits::normalised;
  named.x = "eye_x";
  named.y = "eye_y";
  const auto mm = [](const Row& row) { return 1000.0 * metres(row); };
  const auto rad = [](const Row& row) { return glm::radians(degrees(row)); };
  const auto percent = [](const Row& row) { return 100.0 * fractions(row); };
  const auto clip = [](const Row& row) { return 2.0 * fractions(row) - 1.0; };
  const auto good = [](const Row& row) { return glm::dvec2(row.x, row.y); };
  return {
      {"metres, unstated", saidAbout(table("time_s,eye_x,eye_y", mapped(metres)), named), "units"},
      {"metres as px", saidAbout(table(kXy, mapped(metres)), px), "gaze.units"},
      {"metres by name", saidAbout(table("time_s,x_m,y_m", mapped(metres))), "gaze.scale"},
      {"millimetres, unstated", saidAbout(table("time_s,x,y", mapped(mm))), "gaze.units"},
      {"degrees, unstated", saidAbout(table("time_s,x,y", mapped(degrees))), "gaze.units"},
      {"degrees as px", saidAbout(table(kXy, mapped(degrees))), "gaze.offset"},
      {"degrees as fractions", saidAbout(table(kXy, mapped(degrees)), norm), "gaze."},
      {"radians as degrees", saidAbout(table("time_s,x_deg,y_deg", mapped(rad))), "gaze.scale"},
      {"fractions as degrees", saidAbout(table("time_s,x,y", mapped(fractions)), deg),
       "gaze.units"},
      {"fractions, unstated", saidAbout(table("time_s,x,y", mapped(fractions))), "gaze.units"},
      {"fractions as px", saidAbout(table(kXy, mapped(fractions)), px), "gaze.units"},
      {"per cent, unstated", saidAbout(table("time_s,x,y", mapped(percent))), "gaze.units"},
      {"per cent as fractions", saidAbout(table("time_s,x_norm,y_norm", mapped(percent))),
       "gaze.units"},
      {"-1 to 1 as fractions", saidAbout(table("time_s,x_norm,y_norm", mapped(clip))),
       "gaze.offset"},
      {"pixels as degrees", saidAbout(table("time_s,x,y", mapped(good)), deg), "gaze.units"},
      {"pixels as fractions", saidAbout(table("time_s,x_norm,y_norm", mapped(good))), "gaze.units"},
  };
}

std::vector<Mistake> wrongAxesAndColumns() {
  const auto of = [](double x, double y) { return glm::dvec2(x, y); };
  const auto swapped = [&](const Row& row) { return of(row.y, row.x); };
  const auto centred = [&](const Row& row) { return of(row.x - 960.0, row.y - 540.0); };
  const auto upwards = [&](const Row& row) { return of(row.x, -row.y); };
  const auto same = [&](const Row& row) { return of(row.x, row.x); };
  const auto flat = [&](const Row& row) { return of(row.x, 0.0); };
  const auto mixed = [&](const Row& row) { return of(row.x, row.y / 1080.0); };
  const auto stuck = [&](const Row& row) { return of(960.0 + 1e-4 * row.x, 540.0 + 1e-4 * row.y); };
  const auto larger = [&](const Row& row) { return of(2.0 * row.x, 2.0 * row.y); };
  const auto smaller = [&](const Row& row) { return of(0.4 * row.x, 0.4 * row.y); };
  const auto inTurn = [&](const Row& row) {
    return of(row.number % 2 == 0 ? row.x : 0.7 * row.x + 500.0, row.y);
  };
  const auto eyes = [](const Row& row) {
    return std::vector<double>{row.time_s, row.x, row.y, row.x / 1920.0, row.y / 1080.0};
  };
  // Unity's directions: z forward.
  const auto forward = [](const Row& row) {
    const glm::dvec2 p = glm::tan(glm::radians(degrees(row)));
    return std::vector<double>{row.time_s, p.x, p.y, 1.0};
  };
  const auto beside = [](const Row& row) {
    return std::vector<double>{row.time_s, 300.0 + row.y, row.x / 4.0, row.x, row.y};
  };
  const auto twins = [](const Row& row) {
    return std::vector<double>{row.time_s, row.x, row.x + 300.0, row.y};
  };
  return {
      {"x and y exchanged", saidAbout(table(kXy, mapped(swapped))), "gaze.x"},
      {"origin in the middle", saidAbout(table(kXy, mapped(centred))), "gaze.offset"},
      {"y upwards", saidAbout(table(kXy, mapped(upwards))), "gaze.scale"},
      {"one column twice", saidAbout(table(kXy, mapped(same))), "gaze.y"},
      {"y is constant", saidAbout(table(kXy, mapped(flat))), "gaze.y"},
      {"y in another unit", saidAbout(table(kXy, mapped(mixed))), "gaze.y"},
      {"all in a pixel", saidAbout(table(kXy, mapped(stuck))), "gaze.units"},
      {"a larger screen", saidAbout(table(kXy, mapped(larger))), "screen.size_px"},
      {"a smaller screen", saidAbout(table(kXy, mapped(smaller))), "screen.size_px"},
      {"two people in turn", saidAbout(table(kXy, mapped(inTurn))), "gaze.rows"},
      {"eyes in different units", saidAbout(table("time_s,lx,ly,rx,ry", eyes)), "left_x"},
      {"directions with z forward",
       saidAbout(table("time_s,left_direction_x,left_direction_y,left_direction_z", forward)),
       "axes"},
      {"two columns of a name", saidAbout(table("time_s,x,x,y", twins)), "gaze.x"},
      {"a target beside the gaze", saidAbout(table("time_s,x,y,eye_x,eye_y", beside)), "gaze.x"},
      {"an unknown name", saidAbout(table("time_s,a,b", mapped(centred))), "gaze.x"},
  };
}

std::vector<Mistake> wrongClocks() {
  const auto at = [](const std::function<double(const Row&)>& time) {
    return [time](const Row& row) { return std::vector<double>{time(row), row.x, row.y}; };
  };
  const auto ms = at([](const Row& row) { return 1000.0 * row.time_s; });
  const auto seconds = at([](const Row& row) { return row.time_s; });
  const auto rows = at([](const Row& row) { return 1.0 * row.number; });
  const auto backwards = at([](const Row& row) { return -row.time_s; });
  const auto restarts = at([](const Row& row) { return (row.number % 700) / kRate_Hz; });
  const auto leap = at([](const Row& row) { return row.time_s + (row.number > 700 ? 9000.0 : 0); });
  const auto held = [](const Row& row) {
    static const std::vector<Row> all = goodRows();
    const Row& slow = all[static_cast<std::size_t>(row.number / 5 * 5)];
    return std::vector<double>{row.time_s, slow.x, slow.y};
  };
  return {
      {"milliseconds as seconds", saidAbout(table("time_s,x_px,y_px", ms)), "unit of time"},
      {"seconds as milliseconds", saidAbout(table("time_ms,x_px,y_px", seconds)), "unit of time"},
      {"row numbers as time", saidAbout(table("time,x_px,y_px", rows)), "gaze.rate_Hz"},
      {"backwards", saidAbout(table(kXy, backwards)), "not after"},
      {"a clock for each trial", saidAbout(table(kXy, restarts)), "not after"},
      {"a leap of hours", saidAbout(table(kXy, leap)), "gaze.time"},
      {"slow gaze in fast rows", saidAbout(table(kXy, held)), "gaze.time"},
  };
}

std::vector<Mistake> lossesAndText() {
  const auto coded = [](double code) {
    return mapped([code](const Row& row) {
      return row.number % 10 < 2 ? glm::dvec2(code) : glm::dvec2(row.x, row.y);
    });
  };
  // One eye is lost. The mean of both eyes is nowhere twice.
  const auto oneEye = [](double code, int of_100) {
    return [code, of_100](const Row& row) {
      const bool lost = row.number % 100 < of_100;
      return std::vector<double>{row.time_s, lost ? code : row.x, lost ? code : row.y, row.x,
                                 row.y};
    };
  };
  const std::string eyes = "time_s,left_x_px,left_y_px,right_x_px,right_y_px";
  const auto with = [](double good) {
    return [good](const Row& row) { return std::vector<double>{row.time_s, row.x, row.y, good}; };
  };
  const auto rare = mapped([](const Row& row) {
    return row.number % 125 == 0 ? glm::dvec2(-1.0) : glm::dvec2(row.x, row.y);
  });
  const auto middle = [](const Row& row) {
    const glm::dvec2 p = degrees(row), left = row.number % 100 < 12 ? glm::dvec2(0.0) : p;
    return std::vector<double>{row.time_s, left.x, left.y, p.x, p.y};
  };
  const auto blinks = [](const Row& row) {
    return std::vector<double>{row.time_s, row.x, row.y, std::floor(row.time_s / 5.0)};
  };
  const auto rated = [](const Row& row) {
    const double good = row.number % 100 < 14 ? 0.0 : 1.0;
    return std::vector<double>{row.time_s, row.x, row.y, good, row.x, row.y, good};
  };
  const auto onlyOne = [](const Row& row) {
    return std::vector<double>{row.time_s, row.x, row.y, row.time_s > 11.0 ? 1.0 : 0.0};
  };
  std::string words = kXy + "\n", commas = kXy + "\n", lost = kXy + "\n";
  for (const Row& row : goodRows()) {
    char line[80];
    std::snprintf(line, sizeof line, "%.2f,left,top\n", row.time_s);
    words += line;
    std::snprintf(line, sizeof line, "%d,%02d,%d,5,%d,5\n", row.number / 100, row.number % 100,
                  static_cast<int>(row.x), static_cast<int>(row.y));
    commas += line;
    std::snprintf(line, sizeof line, "%.2f,nan,nan\n", row.time_s);
    lost += line;
  }
  Row last{};
  const std::string held = table(kXy, [&](const Row& row) {
    if (row.number % 100 >= 10) last = row;
    return std::vector<double>{row.time_s, last.x, last.y};
  });
  Screen far = kScreen, portrait = kScreen;
  far.distance_m = 60.0;
  std::swap(portrait.size_m.x, portrait.size_m.y);
  const std::string good =
      table(kXy, mapped([](const Row& row) { return glm::dvec2(row.x, row.y); }));
  return {
      {"(0, 0) for loss", saidAbout(table(kXy, coded(0.0))), "gaze.missing"},
      {"-1 for loss", saidAbout(table(kXy, coded(-1.0))), "gaze.missing"},
      {"-32768 for loss", saidAbout(table(kXy, coded(-32768.0))), "gaze.missing = -32768"},
      {"9999 for loss, no screen", saidAbout(table(kXy, coded(9999.0)), {}, {}),
       "gaze.missing = 9999"},
      {"-1 for the left eye", saidAbout(table(eyes, oneEye(-1.0, 20))), "gaze.missing = -1"},
      {"(0, 0) for the left eye", saidAbout(table(eyes, oneEye(0.0, 20))), "of the left eye"},
      {"(0, 0) for the left eye at times", saidAbout(table(eyes, oneEye(0.0, 2))),
       "gaze.missing = 0"},
      {"-1 in 0.8 % of the samples", saidAbout(table(kXy, rare)), "gaze.missing = -1"},
      {"0 deg for the left eye",
       saidAbout(table("time_s,left_x_deg,left_y_deg,right_x_deg,right_y_deg", middle)),
       "of the left eye"},
      {"0 deg for the left eye, no screen",
       saidAbout(table("time_s,left_x_deg,left_y_deg,right_x_deg,right_y_deg", middle), {}, {}),
       "of the left eye"},
      {"a counter of blinks", saidAbout(table(kXy + ",blink", blinks)), "gaze.blink"},
      {"a counter of one blink", saidAbout(table(kXy + ",blink", onlyOne)), "gaze.blink"},
      {"validity that may be either",
       saidAbout(table("time_s,left_x,left_y,left_validity,right_x,right_y,right_validity", rated)),
       "gaze.confidence"},
      {"a blink of one eye", saidAbout(table(kXy + ",left_blink", with(0.0))), "gaze.blink"},
      {"confidence, abridged", saidAbout(table(kXy + ",conf", with(1.0))), "gaze.confidence"},
      {"1e8 for loss", saidAbout(table(kXy, coded(1e8))), "gaze.missing"},
      {"the last position for loss", saidAbout(held), "stay the same"},
      {"another rate than stated", saidAbout("# sampling_Hz=250\n" + good), "stated sampling rate"},
      {"all lost", saidAbout(lost), "no sample has a position"},
      {"a column of validity", saidAbout(table(kXy + ",valid", with(1.0))), "gaze.confidence"},
      {"a column of codes", saidAbout(table(kXy + ",validity", with(0.0))), "gaze.blink"},
      {"confidence in per cent", saidAbout(table(kXy + ",confidence", with(95.0))),
       "gaze.confidence"},
      {"confidence 0", saidAbout(table(kXy + ",confidence", with(0.0))), "gaze.confidence"},
      {"an open eye marked as a blink", saidAbout(table(kXy + ",blink", with(1.0))), "gaze.blink"},
      {"pupil in metres", saidAbout(table(kXy + ",pupil_mm", with(0.0035))), "gaze.pupil_scale_mm"},
      {"pupil in pixels", saidAbout(table(kXy + ",pupil_mm", with(45.0))), "gaze.pupil_scale_mm"},
      {"a column of text", saidAbout(words), "expected a number"},
      {"decimal commas between commas", saidAbout(commas), "decimal commas"},
      {"a distance in centimetres", saidAbout(good, {}, far), "screen.distance_m"},
      {"width and height exchanged", saidAbout(good, {}, portrait), "screen.size_m"},
  };
}

TEST(MistakenRecordings, TheGoodOneRaisesNoDoubt) {
  const auto good = mapped([](const Row& row) { return glm::dvec2(row.x, row.y); });
  EXPECT_EQ(saidAbout(table(kXy, good)), "");
  const auto eyes = [](const Row& row) {
    return std::vector<double>{row.time_s, row.x - 4.0, row.y, row.x + 4.0, row.y};
  };
  EXPECT_EQ(saidAbout(table("time_s,left_x_px,left_y_px,right_x_px,right_y_px", eyes)), "");
  EXPECT_EQ(saidAbout(table("time_s,x_norm,y_norm", mapped(fractions))), "");
  EXPECT_EQ(saidAbout(table("time_s,gaze_norm_pos_x,gaze_norm_pos_y", mapped(fractions))), "");
  EXPECT_EQ(saidAbout(table("time_s,x_deg,y_deg", mapped(degrees))), "");
}

TEST(MistakenRecordings, WhatOnlyLooksMistakenRaisesNoDoubt) {
  const auto with = [](const std::function<double(const Row&)>& value) {
    return [value](const Row& row) {
      return std::vector<double>{row.time_s, row.x, row.y, value(row)};
    };
  };
  const auto number = with([](const Row& row) { return 1.0 * row.number; });
  EXPECT_EQ(saidAbout(table("time_s,x,y,gaze_index", number)), "");
  // An eye that blinks for a tenth of a second after a gap, and once for two seconds at the start.
  std::string gap = kXy + ",blink\n";
  for (const Row& row : goodRows()) {
    if (row.number > 500 && row.number < 1000) continue;
    gap += std::to_string(row.time_s) + "," + std::to_string(row.x) + "," + std::to_string(row.y) +
           (row.number >= 1000 && row.number < 1010 ? ",1\n" : ",0\n");
  }
  EXPECT_EQ(saidAbout(gap).find("a blink lasts"), std::string::npos) << saidAbout(gap);
  const auto start = with([](const Row& row) { return row.number < 200 ? 2.0 : 0.0; });
  const GazeTrace trace = readTrace(ScratchFile(table(kXy + ",blink", start)).path(), {}, kScreen);
  EXPECT_TRUE(trace.samples[10].blink && !trace.samples[300].blink);
  // A tenth of a degree, and a glance off the screen, or half of the time at a cross in the middle.
  const auto rounded = [](const Row& row) {
    const glm::dvec2 p = glm::round(10.0 * degrees(row)) / 10.0;
    return row.number / 4 == 100 ? glm::dvec2(29.0, 3.1) : p;
  };
  EXPECT_EQ(saidAbout(table("time_s,x_deg,y_deg", mapped(rounded))), "");
  const auto cross = [](const Row& row) {
    const glm::dvec2 p =
        row.number % 100 < 50 ? glm::dvec2(0.0) : glm::round(10.0 * degrees(row)) / 10.0;
    return std::vector<double>{row.time_s, p.x, p.y, p.x + 0.1 * (row.number % 3), p.y};
  };
  EXPECT_EQ(saidAbout(table("time_s,left_x_deg,left_y_deg,right_x_deg,right_y_deg", cross))
                .find("gaze.missing"),
            std::string::npos);
  // A spike in every third sample, and two targets that are fixated in turn, in one sample each.
  const auto spikes = [](const Row& row) {
    return glm::dvec2(row.x + (row.number % 3 == 0 ? 60.0 : 0.0), row.y);
  };
  EXPECT_EQ(saidAbout(table(kXy, mapped(spikes))), "");
  const auto targets = [](const Row& row) {
    return std::vector<double>{0.15 * row.number, 400.0 + 800.0 * (row.number % 2) + 0.03 * row.x,
                               500.0 + 0.04 * row.y};
  };
  EXPECT_EQ(saidAbout(table(kXy, targets)), "");
}

TEST(MistakenRecordings, ACommaIsDecimalUnlessItMaySeparateThousands) {
  const auto read = [](const std::string& rows) {
    std::vector<std::string> assumed;
    const ScratchFile file("time_s\tx_px\ty_px\n" + rows);
    assumed = streamTrace(file.path(), {}, {}, [](const GazeSample&) {}).assumed;
    return assumed.empty() ? "" : assumed[0];
  };
  EXPECT_EQ(read("0,00\t410,492\t365,1\n0,01\t411\t365\n"),
            "decimal comma: \"410,492\" is 410.492");
  EXPECT_EQ(read("0\t410,492\t365,100\n1\t0\t0\n2\t1,271\t365,000\n"),
            "decimal comma: \"410,492\" is 410.492");
  EXPECT_EQ(read("0\t410\t365\n1\t411\t366\n"), "");
  EXPECT_THROW(read("0\t954\t365\n1\t1,271\t366\n"), InputError);
  EXPECT_THROW(read("0\t1,271\t365\n1\t954\t366\n"), InputError);
}

TEST(MistakenRecordings, AColumnOfValidityIsReadIfTheStudyNamesIt) {
  const std::string text = kXy + ",valid\n0,1,2,True\n0.01,1,2,False\n0.02,1,2,true\n";
  TraceColumns columns;
  columns.confidence = "valid";
  const GazeTrace trace = readTrace(ScratchFile(text).path(), columns, kScreen);
  EXPECT_EQ(trace.warnings, std::vector<std::string>{});
  EXPECT_TRUE(trace.samples[0].point_px && trace.samples[2].point_px);
  EXPECT_FALSE(trace.samples[1].point_px);
}

TEST(MistakenRecordings, WhatOnlyLooksLikeAnEyeOrGazeIsNone) {
  // The resolution in px per degree, and the turn of a head.
  const auto beside = [](const Row& row) {
    return std::vector<double>{row.time_s,           row.x, row.y, row.x + 8.0, row.y,
                               25.6 + 0.001 * row.x, 26.8};
  };
  const auto read = [&](const std::string& names, const Fields& fields,
                        const TraceColumns& columns = {}) {
    return readTrace(ScratchFile(table(names, fields)).path(), columns, kScreen);
  };
  for (const char* names :
       {"time_s,xpl,ypl,xpr,ypr,xr,yr", "time_s,left_x,left_y,right_x,right_y,rx,ry",
        "time_s,gx_left,gy_left,gx_right,gy_right,rx,ry"}) {
    const GazeSample seen = read(names, beside).samples[10];
    const Row row = goodRows()[10];
    ASSERT_TRUE(seen.point_px && seen.eyes[1].point_px) << names;
    EXPECT_NEAR(seen.point_px->x, row.x + 4.0, 1e-6) << names;
    EXPECT_NEAR(seen.eyes[1].point_px->x, row.x + 8.0, 1e-6) << names;
  }
  const auto one = [&](const Row& row) {
    return std::vector<double>{row.time_s, row.x, row.y, 25.6 + 0.001 * row.x, 26.8};
  };
  for (const char* names :
       {"time_s,xp,yp,xr,yr", "time_s,gaze_x,gaze_y,rx,ry", "time_s,x,y,rx,ry"}) {
    const GazeSample seen = read(names, one).samples[10];
    EXPECT_FALSE(seen.eyes[1].point_px) << names;
    EXPECT_NEAR(seen.point_px->x, goodRows()[10].x, 1e-6) << names;
  }
  // Eyes beside a point that the study names.
  const TraceColumns named{.x = "x_filtered", .y = "y_filtered"};
  const auto filtered =
      read("time_s,x_filtered,y_filtered,left_x,left_y,right_x,right_y", beside, named);
  EXPECT_FALSE(filtered.samples[10].eyes[0].point_px || filtered.samples[10].eyes[1].point_px);
  // Beside the point that foci takes itself, the eyes stay.
  const auto usual = read("time_s,gaze_x,gaze_y,left_x,left_y,right_x,right_y", beside,
                          TraceColumns{.x = "gaze_x", .y = "gaze_y"});
  EXPECT_TRUE(usual.samples[10].eyes[0].point_px && usual.samples[10].eyes[1].point_px);
  // A mouse that rests, or a target.
  const auto mouse = [](const Row& row) {
    return std::vector<double>{row.time_s, 300.0 + row.number / 500, 400.0, row.x, row.y, row.x,
                               row.y};
  };
  const auto gaze = read("time_s,x,y,left_gaze_x,left_gaze_y,right_gaze_x,right_gaze_y", mouse);
  EXPECT_NEAR(gaze.samples[10].point_px->x, goodRows()[10].x, 1e-6);
  EXPECT_EQ(gaze.warnings.size(), 1u) << "the point that is passed over";
  // Pupils in an eye camera, and eyes that are lost most of the time.
  const auto pupils = [](const Row& row) {
    const double x = 100.0 + row.x / 40.0, y = 80.0 + row.y / 40.0;
    return std::vector<double>{row.time_s, row.x, row.y, x, y, x, y};
  };
  const auto lost = [](const Row& row) {
    const bool is_lost = row.number % 10 < 7;
    const double x = is_lost ? -1.0 : row.x, y = is_lost ? -1.0 : row.y;
    return std::vector<double>{row.time_s, row.x, row.y, x, y, x, y};
  };
  for (const auto& [names, fields] :
       {std::pair<const char*, Fields>{"time_s,x,y,left_x,left_y,right_x,right_y", pupils},
        {"time_s,x,y,left_gaze_x,left_gaze_y,right_gaze_x,right_gaze_y", lost}}) {
    const GazeSample seen = read(names, fields).samples[10];
    EXPECT_NEAR(seen.point_px->x, goodRows()[10].x, 1e-6) << names;
  }
}

TEST(MistakenRecordings, NoneIsSilentAndEachNamesWhatToDo) {
  std::vector<Mistake> all;
  for (const auto& some : {wrongUnits(), wrongAxesAndColumns(), wrongClocks(), lossesAndText()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  EXPECT_GE(all.size(), 40u);
  for (const Mistake& mistake : all) {
    EXPECT_NE(mistake.said.find(mistake.key), std::string::npos)
        << mistake.what << ": \"" << mistake.said << "\" does not name " << mistake.key;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
