#include "render/scene/io/point_formats.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "base/input_error.h"
#include "render/image/srgb.h"
#include "render/scene/io/mesh_formats.h"
#include "render/scene/io/open_scene.h"
#include "tests/temporary_folder.h"
#include "tests/unit/render/scene/io/gaussian_files.h"

namespace foci {
namespace FOCI_FILE {

class TextPoints : public testing::Test {
 protected:
  PointCloud read(const std::string& text, const std::string& name = "p.xyz") {
    return readTextPoints(scratch.write(name, text));
  }
  std::string refusal(const std::string& text, const std::string& name = "p.xyz") {
    try {
      read(text, name);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  static bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }

  const TemporaryFolder scratch;
};

TEST_F(TextPoints, PositionsAloneAreGrey) {
  const PointCloud points = read("# a scan\n\n1 2 3\n-1.5\t2e1 +3\n1,2,4");
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points.position_m[1], glm::vec3(-1.5f, 20.0f, 3.0f));
  EXPECT_EQ(points.position_m[2], glm::vec3(1, 2, 4));
  EXPECT_NEAR(points.color[0].x, linearFromSrgb(0.5f), 1e-3f);
  EXPECT_TRUE(points.normal.empty());
}

TEST_F(TextPoints, ColoursHaveTheRangeOfTheWholeFile) {
  const float half = linearFromSrgb(0.5f);
  EXPECT_FLOAT_EQ(read("0 0 0 1 0 0\n1 0 0 0.5 1 0\n").color[1].x, half);
  EXPECT_FLOAT_EQ(read("0 0 0 255 0 0\n1 0 0 0 1 0\n").color[1].y, linearFromSrgb(1.0f / 255.0f));
  EXPECT_FLOAT_EQ(read("0 0 0 255 0 0\n1 0 0 127.5 1 0\n").color[1].x, half);
  EXPECT_FLOAT_EQ(read("0 0 0 65535 0 0\n1 0 0 0 1 0\n").color[0].x, 1.0f);
}

TEST_F(TextPoints, ColoursOfASmallPartOfTheirRangeGetARemark) {
  const PointCloud ten_bits = read("0 0 0 1023 0 0\n1 0 0 0 1 0\n");
  ASSERT_EQ(ten_bits.remarks.size(), 1u);
  EXPECT_TRUE(has(ten_bits.remarks[0], "nearly black"));
  EXPECT_TRUE(read("0 0 0 9000 0 0\n1 0 0 0 1 0\n").remarks.empty());
}

TEST_F(TextPoints, TriplesOfLengthOneAreNormals) {
  const PointCloud points = read("0 0 0 0 0.6 0.8\n1 0 0 0 0 -1\n2 0 0 0 0 0\n");
  ASSERT_EQ(points.normal.size(), 3u);
  EXPECT_FLOAT_EQ(points.normal[0].z, 0.8f);
  EXPECT_EQ(points.normal[2], glm::vec3(0.0f));  // to be estimated
  for (const char* both : {"0 0 0 10 20 30 0 1 0\n", "0 0 0 0 1 0 10 20 30\n"}) {
    const PointCloud all = read(both);
    EXPECT_EQ(all.normal.at(0), glm::vec3(0, 1, 0));
    EXPECT_FLOAT_EQ(all.color.at(0).x, linearFromSrgb(10.0f / 255.0f));
  }
}

TEST_F(TextPoints, PtsHasANumberOfPointsAndIntensity) {
  const PointCloud points = read("2\n0 0 0 -1200 255 0 0\n1 0 0 300 0 255 0\n", "p.pts");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_FLOAT_EQ(points.color[0].x, 1.0f);
  EXPECT_FLOAT_EQ(points.color[1].y, 1.0f);
  const PointCloud grey = read("2\n0 0 0 -1200\n1 0 0 300\n", "p.pts");
  EXPECT_EQ(grey.color[0], glm::vec3(0.0f));
  EXPECT_EQ(grey.color[1], glm::vec3(1.0f));
  // Scans one after another.
  EXPECT_EQ(read("1\n0 0 0 5\n2\n1 0 0 5\n2 0 0 5\n", "p.pts").size(), 3u);
  EXPECT_TRUE(has(refusal("3\n0 0 0 5\n", "p.pts"), "p.pts:2: ends after 1 of 3 points"));
}

TEST_F(TextPoints, ALineOfNamesSaysWhatTheColumnsAre) {
  const PointCloud points =
      read("//X Y Z Scalar Nx Ny Nz R G B\n0 1 2 77 0 0 1 0 255 0\n", "p.asc");
  EXPECT_EQ(points.position_m[0], glm::vec3(0, 1, 2));
  EXPECT_EQ(points.normal.at(0), glm::vec3(0, 0, 1));
  EXPECT_FLOAT_EQ(points.color[0].y, 1.0f);
  const PointCloud turned = read("intensity;z;y;x\n1;2;3;4\n2;2;3;5\n", "p.txt");
  EXPECT_EQ(turned.position_m[0], glm::vec3(4, 3, 2));
}

TEST_F(TextPoints, RowAndColumnOfAScannerAreNoPosition) {
  const PointCloud faro = read("0 7 1.5 -2.0 0.25 255 0 0\n1 7 1.5 -2.0 0.5 0 0 0\n");
  EXPECT_EQ(faro.position_m[0], glm::vec3(1.5f, -2.0f, 0.25f));
  EXPECT_FLOAT_EQ(faro.color[0].x, 1.0f);
  ASSERT_EQ(faro.remarks.size(), 1u);
  EXPECT_TRUE(has(faro.remarks[0], "as FARO writes them"));
  EXPECT_EQ(read("0 7 1.5 -2.0 0.25 128\n").position_m[0], glm::vec3(1.5f, -2.0f, 0.25f));
  for (const char* other : {"1 2 0.5 0.25 0.5 1\n", "1 2 3 0.25 0.5 9.5\n", "1 2 3 9 9 9 4 5\n",
                            "1 541234 3.5 0.25 0.5 7\n"}) {
    EXPECT_EQ(read(other).position_m[0].x, 1.0f) << other;
  }
}

TEST_F(TextPoints, PlacesOfASurveyHaveTheirNames) {
  for (const char* names : {"Easting,Northing,Height",
                            "northing_,Easting [m],Northing [m],Elevation", "Elevation,X,Y,Z"}) {
    const std::string row = names[1] == 'a' ? "1,2,3\n" : "9,1,2,3\n";
    EXPECT_EQ(read(names + ("\n" + row), "p.csv").position_m[0], glm::vec3(1, 2, 3)) << names;
  }
}

TEST_F(TextPoints, MapCoordinatesKeepTheirMillimetres) {
  const PointCloud points = read("482123.001 5412345.001 310\n482123.002 5412345.001 310\n");
  EXPECT_NEAR(points.position_m[1].x - points.position_m[0].x, 0.001f, 1e-4f);
  ASSERT_EQ(points.remarks.size(), 1u);
  EXPECT_TRUE(has(points.remarks[0], "482000 5412000 0")) << points.remarks[0];
}

TEST_F(TextPoints, DropsPointsThatAreNotFinite) {
  const PointCloud points = read("0 0 0 1 0 0\nnan 0 0 0 1 0\n1e30 0 0 0 0 1\n1 0 0 0 1 1\n");
  EXPECT_EQ(points.size(), 2u);
  EXPECT_EQ(points.dropped, 2u);
  EXPECT_FLOAT_EQ(points.color[1].z, 1.0f);
}

TEST_F(TextPoints, RefusesBadLinesByNumber) {
  EXPECT_TRUE(has(refusal("0 0 0\n1 2\n"), ":2: has 2 numbers: expected 3"));
  EXPECT_TRUE(has(refusal("0 0 0\n1 2 x\n"), ":2: expected a number, found \"x\""));
  EXPECT_TRUE(has(refusal("1 2\n"), ":1: expected x y z"));
  EXPECT_TRUE(has(refusal(""), "is empty"));
  EXPECT_TRUE(has(refusal("# nothing\n"), "has no points"));
  EXPECT_TRUE(has(refusal("nan nan nan\n"), "none of its points"));
  EXPECT_TRUE(has(refusal("0 0 0 -5 300 2\n"), "neither colours"));
  EXPECT_NE(refusal(std::string("\0\1\2 3 4\n", 9)), "");
  EXPECT_NE(refusal("0 0 0" +
                    [] {
                      std::string many;
                      for (int i = 0; i < 100; ++i) many += " 1";
                      return many;
                    }()),
            "");
}

TEST_F(TextPoints, RefusesDecimalCommas) {
  for (const char* text : {"0,5 1,5 2,5\n", "0,5\t1,5\t2,5\t200\t100\t50\n", "0,5;1,5;2\n"}) {
    EXPECT_TRUE(has(refusal(text), ":1: \"0,5\" is a number with a decimal comma")) << text;
  }
  for (const char* text : {"1,2,3\n", "1, 2, 3\n", "1,2,3 \n", "1 , 2 , 3\n", "1;2;3\n"}) {
    EXPECT_EQ(read(text).position_m.at(0), glm::vec3(1, 2, 3)) << text;
  }
}

TEST_F(TextPoints, AByteOrderMarkIsNoColumn) {
  EXPECT_EQ(read("\xef\xbb\xbf"
                 "1 2 3\n")
                .position_m.at(0),
            glm::vec3(1, 2, 3));
  const auto named = scratch.write("p.txt", "\xef\xbb\xbfx z y\n1 2 3\n");
  EXPECT_TRUE(isScene(named));
  EXPECT_EQ(readTextPoints(named).position_m.at(0), glm::vec3(1, 3, 2));
}

TEST_F(TextPoints, ColumnsWithoutNamesAreNotGuessed) {
  EXPECT_TRUE(has(refusal("0 0 0 3 4\n"), "5 columns without names"));
  EXPECT_EQ(read("x y z i class\n0 0 0 3 4\n").size(), 1u);
  const PointCloud eight = read("0 0 0 255 0 0 7 8\n");
  ASSERT_EQ(eight.remarks.size(), 1u);
  EXPECT_TRUE(has(eight.remarks[0], "after the first 6"));
  EXPECT_TRUE(read("0 0 0 255 0 0 0 0 1\n").remarks.empty());
}

TEST_F(TextPoints, OfSevenColumnsTheValuesTellWhichAreTheColour) {
  const auto color = [&](const std::string& row, const std::string& name = "p.txt") {
    const PointCloud points = read(row + "\n" + row + "\n", name);
    EXPECT_TRUE(points.remarks.empty()) << row;
    return points.color.at(0);
  };
  for (const char* row : {"1 2 3 0.5 255 9 2", "1 2 3 -1200 255 9 2", "1 2 3 4000 255 9 2",
                          "1 2 3 255 9 2 4000", "1 2 3 255 9 2 0.5", "1 2 3 1 0.5 0 7"}) {
    EXPECT_EQ(color(row).r, 1.0f) << row;
  }
  for (const char* name : {"p.pts", "p.pts.gz"}) {
    EXPECT_EQ(color("1 2 3 9 255 0 0", name), glm::vec3(1, 0, 0)) << name;
    EXPECT_EQ(read("1 2 3 0.6 -0.8 0 2\n", name).normal.at(0), glm::vec3(0.6f, -0.8f, 0)) << name;
  }
  EXPECT_EQ(read("1 2 3 0 0 1 0.3\n").normal.at(0), glm::vec3(0, 0, 1));
  EXPECT_EQ(read("1 2 3 0.3 0 0 1\n").normal.at(0), glm::vec3(0, 0, 1));
  const PointCloud either = read("0 0 0 255 0 0 7\n");
  EXPECT_EQ(either.color.at(0), glm::vec3(1, 0, 0));
  EXPECT_TRUE(has(either.remarks.at(0), "7 columns have no names"));
  const PointCloud red = read("0 0 0 255 0 0 1\n1 0 0 255 0 0 1\n");
  EXPECT_EQ(red.color.at(0), glm::vec3(1, 0, 0));
  EXPECT_TRUE(red.normal.empty());
  EXPECT_TRUE(has(red.remarks.at(0), "a colour and a value that is left out"));
  EXPECT_TRUE(read("0 0 0 0 0 0 1\n").normal.empty());
  const PointCloud up = read("0 0 0 0.3 0 0 1\n");
  EXPECT_EQ(up.normal.at(0), glm::vec3(0, 0, 1));
  EXPECT_TRUE(has(up.remarks.at(0), "a value that is left out and a normal"));
}

TEST_F(TextPoints, OfSevenColumnsTheOneThatIsLeftOutMayHoldAnything) {
  const PointCloud times = read("1 2 3 255 9 2 1600000000.5\n1 2 4 255 9 2 1600000001\n");
  EXPECT_EQ(times.color.at(1).r, 1.0f);
  EXPECT_TRUE(times.remarks.empty());
  const PointCloud curved = read("1 2 3 0 0 1 0.1\n1 2 4 0 0 1 nan\n");
  ASSERT_EQ(curved.normal.size(), 2u);
  EXPECT_EQ(curved.normal[1], glm::vec3(0, 0, 1));
  EXPECT_EQ(read("1 2 3 nan 255 0 0\n").color.at(0), glm::vec3(1, 0, 0));
  EXPECT_TRUE(has(refusal("1 2 3 0 nan 0 0\n"), "neither colours"));
}

TEST_F(TextPoints, AnEmptyFieldIsAColumn) {
  EXPECT_EQ(read(",x,y,z\n0,1,2,3\n", "p.csv").position_m.at(0), glm::vec3(1, 2, 3));
  EXPECT_EQ(read("x;note;y;z\n1;;2;3\n", "p.csv").position_m.at(0), glm::vec3(1, 2, 3));
  EXPECT_EQ(read("x , y ,z,\n1 , 2 ,3,\n", "p.csv").position_m.at(0), glm::vec3(1, 2, 3));
  EXPECT_TRUE(has(refusal("x,y,z\n1,,3\n", "p.csv"), "p.csv:2: expected a number"));
  EXPECT_TRUE(has(refusal("x,y,z\n1,2,\n", "p.csv"), "p.csv:2: expected a number"));
  for (const char* text : {"x,y,z\n1,2,3\n,,\n", "x,y,z\n1,2,3,,\n", "1;2;3;;\n;;;;\n",
                           "x,y,z,name,class\n1,2,3,,\n", "x,y,z,name\n1,2,3,\n"}) {
    const PointCloud points = read(text, "p.csv");
    ASSERT_EQ(points.size(), 1u) << text;
    EXPECT_EQ(points.position_m[0], glm::vec3(1, 2, 3)) << text;
    EXPECT_TRUE(points.remarks.empty()) << text;
  }
}

TEST_F(TextPoints, GaussiansAreNoPoints) {
  EXPECT_TRUE(has(refusal("x,y,z,f_dc_0,f_dc_1,f_dc_2,opacity\n1,2,3,0,0,0,1\n", "p.csv"),
                  "has Gaussians as text"));
}

TEST_F(TextPoints, MoreLinesThanStatedAreNamed) {
  const PointCloud points = read("1\n0 0 0\n0 0 1\n", "p.pwn");
  EXPECT_TRUE(has(points.remarks.at(0), "states 1 point, and has 2: correct that"));
}

TEST_F(TextPoints, ATxtFileIsASceneIfItBeginsWithPoints) {
  EXPECT_TRUE(isScene(scratch.write("a.txt", "# points\n1 2 3\n")));
  EXPECT_TRUE(isScene(scratch.write("b.txt", "x y z\n1 2 3\n")));
  EXPECT_FALSE(isScene(scratch.write("c.txt", "[scene]\nbuiltin = \"plane\"\n")));
  EXPECT_FALSE(isScene(scratch.write("d.toml", "seed = 1\n")));
  EXPECT_FALSE(isScene(scratch.path() / "absent.txt"));
  EXPECT_TRUE(isScene(scratch.path() / "absent.obj"));
}

TEST_F(TextPoints, NamesMayHaveQuotesAndUnits) {
  for (const char* text :
       {"\"x\",\"y\",\"z\",\"red\",\"green\",\"blue\"\n1,2,3,0,255,0\n",
        "\"\",\"x\",\"y\",\"z\",\"red\",\"green\",\"blue\"\n\"1\",1,2,3,0,255,0\n",
        "X[m];Y[m];Z[m];Red;Green;Blue\n\"1\";\"2\";\"3\";0;255;0\n",
        "\"x (m)\",\"y (m)\",\"z (m)\",R,G,B\n1,2,3,0,255,0\n"}) {
    const auto path = scratch.write("p.csv", text);
    ASSERT_TRUE(startsWithPoints(path)) << text;
    const PointCloud points = readTextPoints(path);
    EXPECT_EQ(points.position_m.at(0), glm::vec3(1, 2, 3)) << text;
    EXPECT_EQ(points.color.at(0), glm::vec3(0, 1, 0)) << text;
  }
  try {
    readScene(scratch.write("q.csv", "PointX,PointY,PointZ\n1,2,3\n"));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_TRUE(has(error.what(), "a line of names that has x, y and z")) << error.what();
  }
}

TEST_F(TextPoints, NamesMayHaveBlanksBeforeTheirUnit) {
  for (const char* text : {"X [m],Y [m],Z [m]\n1,2,3\n", "X [m];Y [m];Z [m]\n1;2;3\n",
                           "X [m]\tY [m]\tZ [m]\n1\t2\t3\n", "X [m] Y [m] Z [m]\n1 2 3\n",
                           "# X (m), Y (m), Z (m)\n1,2,3\n"}) {
    const PointCloud points = read(text, "p.csv");
    EXPECT_EQ(points.position_m.at(0), glm::vec3(1, 2, 3)) << text;
    EXPECT_EQ(points.unit_m, 1.0) << text;
  }
  EXPECT_EQ(read("x [mm] y [mm] z [mm]\n1 2 3\n").unit_m, 0.001);
  EXPECT_FALSE(read("x [mm] y [mm] z [m]\n1 2 3\n").unit_m);
  EXPECT_FALSE(read("x y z\n1 2 3\n").unit_m);
  EXPECT_EQ(read("Point ID;X;Y;Z\n7;1;2;3\n", "p.csv").position_m.at(0), glm::vec3(1, 2, 3));
}

TEST_F(TextPoints, TracksOfColmapHaveAnyLength) {
  const std::string names =
      "# 3D point list with one line of data per point:\n"
      "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n";
  std::string rows = "1 0 0 0 255 0 0 0.5 1 10 2 20\n2 1 0 0 0 255 0 0.6\n7 0 1 0 0 0 255 0.7";
  for (int i = 0; i < 300; ++i) rows += " " + std::to_string(i);
  for (const PointCloud& points : {read(names + rows, "a.txt"), read(rows, "points3D.txt")}) {
    ASSERT_EQ(points.size(), 3u);
    EXPECT_EQ(points.position_m[2], glm::vec3(0, 1, 0));
    EXPECT_EQ(points.color[1], glm::vec3(0, 1, 0));
    EXPECT_EQ(points.format, "COLMAP points");
    EXPECT_TRUE(points.y_is_down);
  }
  EXPECT_TRUE(has(refusal(names + "1 0 0 0 255 0 0\n", "a.txt"), "has 7 numbers: expected 8"));
}

TEST_F(TextPoints, ATrackBeforeThePositionIsAColumn) {
  const PointCloud points = read("POINT3D_ID,TRACK,X,Y,Z\n1,9,2,3,4\n", "a.csv");
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points.position_m[0], glm::vec3(2, 3, 4));
  EXPECT_NE(points.format, "COLMAP points");
}

TEST_F(TextPoints, AnObjMayHoldPointsOnly) {
  const auto path =
      scratch.write("p.obj", "# scan\no scan\nvn 0 0 1\nv 1 2 3 1 0 0\n  v 4 5 6 0 1 0.5\np 1 2\n");
  const SceneFile scene = readScene(path);
  const PointCloud& points = std::get<PointCloud>(scene.content);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points.position_m[1], glm::vec3(4, 5, 6));
  EXPECT_EQ(points.color[0], glm::vec3(1, 0, 0));
  EXPECT_FLOAT_EQ(points.color[1].b, linearFromSrgb(0.5f));
  EXPECT_TRUE(points.normal.empty());
  EXPECT_EQ(nameOf(factsOf(scene)), "OBJ points");
  EXPECT_EQ(std::get<PointCloud>(readObj(scratch.write("q.obj", "v 1 2 3\nv 2 3 4\n"))).size(), 2u);
  EXPECT_TRUE(points.remarks.empty());
  const auto lines =
      std::get<PointCloud>(readObj(scratch.write("l.obj", "v 1 2 3\nv 2 3 4\nl 1 2\n")));
  ASSERT_EQ(lines.remarks.size(), 1u);
  EXPECT_TRUE(has(lines.remarks[0], "1 line left out"));
  const auto patch =
      std::get<PointCloud>(readObj(scratch.write("s.obj", "v 1 2 3\nv 2 3 4\nsurf 0 1 0 1 1 2\n")));
  ASSERT_EQ(patch.remarks.size(), 1u);
  EXPECT_TRUE(has(patch.remarks[0], "free-form curves and surfaces are left out"));
}

TEST_F(TextPoints, PointsOfColmapMayBeBinary) {
  std::string bytes;
  put(bytes, std::uint64_t{2});
  for (const double x : {1.0, -2.0}) {
    const auto images = static_cast<std::uint64_t>(x > 0.0);  // a track of any length
    put(bytes, std::uint64_t{7}, x, 2.0, 3.0, std::uint8_t{255}, std::uint8_t{0}, std::uint8_t{0});
    put(bytes, 0.5, images);
    if (images > 0) put(bytes, std::uint32_t{4}, std::uint32_t{5});
  }
  const SceneFile scene = readScene(scratch.write("points3D.bin", bytes));
  const auto& points = std::get<PointCloud>(scene.content);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points.position_m[0], glm::vec3(1, 2, 3));
  EXPECT_EQ(points.position_m[1], glm::vec3(-2, 2, 3));
  EXPECT_EQ(points.color[1], glm::vec3(1, 0, 0));
  EXPECT_EQ(points.format, "COLMAP points");
  EXPECT_TRUE(points.y_is_down);
  bytes[8 + 43] = 9;  // images of the first point: more than there is room for
  EXPECT_FALSE(isScene(scratch.write("cut.bin", bytes)));
}

TEST_F(TextPoints, PointsOfAriaKeepWhatIsCertain) {
  const PointCloud points = read(
      "uid,graph_uid,px_world,py_world,pz_world,inv_dist_std,dist_std\n"
      "25,ea7288b8-b6a0-012d,-2.5,1.5,-1.25,0.0076,0.0614\n"
      "33,ea7288b8-b6a0-012d,1,2,3,0.02,0.01\n34,ea7288b8,1,2,3,0.001,0.2\n",
      "global_points.csv");
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points.position_m[0], glm::vec3(-2.5f, 1.5f, -1.25f));
  EXPECT_EQ(points.unit_m, 1.0);
  EXPECT_EQ(points.up_axis, 2);
  ASSERT_EQ(points.remarks.size(), 1u);
  EXPECT_TRUE(has(points.remarks[0], "2 points are less certain"));
}

TEST_F(TextPoints, DegreesAreNotTakenForMetres) {
  EXPECT_TRUE(has(refusal("Longitude,Latitude,Height\n13.4,52.5,35\n", "p.csv"),
                  "p.csv:1: has longitude and latitude in degrees"));
  EXPECT_TRUE(isScene(scratch.write("p.csv", "lat;lon;alt\n52.5;13.4;35\n"))) << "refused as one";
  const auto remarks = [&](double site) {
    std::string text;
    for (int i = 0; i < 20; ++i) {
      text += std::to_string(13.4 + site * (i % 5)) + " " + std::to_string(52.5 + site * (i / 5)) +
              " " + std::to_string(30 + i) + "\n";
    }
    const SceneFile file = readScene(scratch.write("p.xyz", text));
    return std::get<PointCloud>(file.content).remarks;
  };
  ASSERT_EQ(remarks(1e-4).size(), 1u);
  EXPECT_TRUE(has(remarks(1e-4)[0], "may be longitude and latitude"));
  EXPECT_TRUE(remarks(0.1).empty());
}

TEST_F(TextPoints, OpensAsASceneAtItsScale) {
  std::string text;
  for (int i = 0; i < 400; ++i) {
    text += std::to_string(i % 20) + " " + std::to_string(i / 20) + " 0 255 0 0\n";
  }
  const Scene scene = openScene(scratch.write("p.xyz", text), 0.01, {}).scene;
  const SurfelCloud& read = *scene.surfels();
  ASSERT_EQ(read.size(), 400u);
  for (const glm::vec3& p : read.position_m) EXPECT_LE(p.x, 0.1901f);
  EXPECT_FLOAT_EQ(read.color[0].x, 1.0f);
}

TEST_F(TextPoints, CsvFilesWithPointsAreScenes) {
  EXPECT_TRUE(isScene(scratch.write("a.csv", "X,Y,Z,R,G,B\n0,0,0,255,0,0\n")));
  EXPECT_FALSE(isScene(scratch.write("b.csv", "time,gaze_x,gaze_y\n0,960,540\n")));
}

TEST_F(TextPoints, FormatsThatAreNotReadNameAConverter) {
  for (const char* name : {"scan.e57", "scan.pcd", "model.blend", "stage.usda"}) {
    try {
      readScene(scratch.write(name, "ASTM-E57 and more"));
      FAIL() << name;
    } catch (const InputError& error) {
      EXPECT_TRUE(has(error.what(), "does not read") &&
                  (has(error.what(), "pdal") || has(error.what(), "Blender")))
          << error.what();
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
