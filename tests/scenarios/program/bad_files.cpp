#include "tests/scenarios/program/bad_inputs.hpp"

namespace hapbench::test {
namespace {

const std::string kCsv = "x_m,y_m,z_m,nx,ny,nz\n";
const std::string kMotion = "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z\n";

/// A scenario whose point shell is the file `name` with these contents.
BadInput shell(const std::string& test, const std::string& name, const std::string& contents, const std::string& says) {
  return {test,
          with_value("plane", "/environment", R"({"type": "point_shell", "file": ")" + name + "\"}"),
          "/environment/file",
          says,
          {{name, contents}}};
}

BadInput motion(const std::string& test, const std::string& contents, const std::string& says) {
  return {test,
          with_value("plane", "/motion", R"({"position": {"type": "file", "file": "m.csv"}})"),
          "/motion/position/file",
          says,
          {{"m.csv", contents}}};
}

std::string ply(const std::string& vertices, const std::string& data, const std::string& format = "ascii",
                const std::string& before = "", const std::string& after = "") {
  return "ply\nformat " + format + " 1.0\n" + before + "element vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float "
         "nz\n" +
         after + "end_header\n" + data;
}

const std::string kRow = "0 0 0 0 0 1\n";

}  // namespace

std::vector<BadInput> bad_shell_files() {
  std::vector<BadInput> inputs = {
      shell("CsvEmpty", "s.csv", "", "line 1: the file is empty; allowed: header \"x_m,y_m,z_m,nx,ny,nz\" and rows"),
      shell("CsvWrongHeader", "s.csv", "x,y,z,nx,ny,nz\n0,0,0,0,0,1\n",
            "line 1: got header \"x,y,z,nx,ny,nz\"; allowed: \"x_m,y_m,z_m,nx,ny,nz\""),
      shell("CsvWithoutHeader", "s.csv", "0,0,0,0,0,1\n", "line 1: got header \"0,0,0,0,0,1\"; allowed: \"x_m,"),
      shell("CsvWithoutPoints", "s.csv", kCsv, "has no points; allowed: at least one"),
      shell("CsvTooFewCells", "s.csv", kCsv + "0,0,0,0,1\n", "line 2: got 5 cells; allowed: 6"),
      shell("CsvTooManyCells", "s.csv", kCsv + "0,0,0,0,0,1,2\n", "line 2: got 7 cells; allowed: 6"),
      shell("CsvNanCell", "s.csv", kCsv + "0,nan,0,0,0,1\n", "line 2: column 2: got \"nan\"; allowed: a finite number"),
      shell("CsvInfiniteCell", "s.csv", kCsv + "0,0,-inf,0,0,1\n",
            "line 2: column 3: got \"-inf\"; allowed: a finite number"),
      shell("CsvCellBeyondDouble", "s.csv", kCsv + "1e999,0,0,0,0,1\n",
            "column 1: got \"1e999\"; allowed: a finite number"),
      shell("CsvEmptyCell", "s.csv", kCsv + "0,0,0,0,,1\n", "line 2: column 5: got \"\"; allowed: a finite number"),
      shell("CsvWordCell", "s.csv", kCsv + "0,0,0,0,up,1\n", "line 2: column 5: got \"up\"; allowed: a finite number"),
      shell("CsvControlCharacters", "s.csv", kCsv + std::string("0,0,0,0,\x1b[2J\0\r\r,1\n", 18),
            "line 2: column 5: got \"?[2J?"),
      shell("CsvSemicolons", "s.csv", "x_m;y_m;z_m;nx;ny;nz\n0;0;0;0;0;1\n", "line 1: got header"),
      shell("CsvNormalTooLong", "s.csv", kCsv + "0,0,0,0,0,1.01\n",
            "point 0: got a normal of length 1.01; allowed: unit normals"),
      shell("CsvNormalZero", "s.csv", kCsv + "0,0,0,0,0,1\n0,0,0,0,0,0\n",
            "point 1: got a normal of length 0; allowed: unit normals"),
      shell("CsvTooFar", "s.csv", kCsv + "0,5000,0,0,0,1\n",
            "point 0: got coordinate 5000; allowed: finite, at most 1000 m"),
      shell("CsvIsBinary", "s.csv", std::string(1000, '\0'), "line 1: got header"),
      shell("UnknownExtension", "s.obj", "v 0 0 0\n", "has another extension; allowed: .csv or .ply"),
      shell("PlyEmpty", "s.ply", "", "the header does not end; allowed: a PLY header"),
      shell("PlyGarbage", "s.ply", "\x89PNG\r\n\x1a\n garbage",
            "is not a PLY file; allowed: \"ply\" as the first line"),
      shell("PlyHeaderCutShort", "s.ply", "ply\nformat ascii 1.0\nelement vertex 1\n", "the header does not end"),
      shell("PlyCountAbsurd", "s.ply", ply("4000000000", kRow),
            "got \"4000000000\" vertices; allowed: an integer, at most 2e+07"),
      shell("PlyCountOf30Digits", "s.ply", ply("1" + std::string(30, '0'), kRow), "allowed: an integer, at most 2e+07"),
      shell("PlyCountNegative", "s.ply", ply("-5", kRow), "got \"-5\" vertices; allowed: an integer"),
      shell("PlyCountTooLargeForItsFile", "s.ply", ply("20000000", kRow), "the file ends before its 20000000 vertices"),
      shell("PlyBinaryCountTooLargeForItsFile", "s.ply", ply("20000000", std::string(24, '\0'), "binary_little_endian"),
            "the file ends before its 20000000 vertices"),
      shell("PlyTruncated", "s.ply", ply("2", "0 0 0 0 0 1\n0.001 0.002 0.003 "),
            "vertex 1: got 3 numbers; allowed: 6"),
      shell("PlyBinaryTruncated", "s.ply", ply("2", std::string(40, '\0'), "binary_big_endian"),
            "the file ends before its 2 vertices"),
      shell("PlyWords", "s.ply", ply("1", "a b c d e f\n"), "vertex 0: got \"a\"; allowed: a finite number"),
      shell("PlyNan", "s.ply", ply("1", "nan 0 0 0 0 1\n"), "vertex 0: got \"nan\"; allowed: a finite number"),
      shell("PlyNormalTooLong", "s.ply", ply("1", "0 0 0 0 0 2\n"),
            "point 0: got a normal of length 2; allowed: unit normals"),
      shell("PlyWithoutNormals", "s.ply",
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
            "z\nend_header\n0 0 0\n",
            "got 0 vertex properties \"nx\"; allowed: one each of x, y, z, nx, ny, nz"),
      shell("PlyListProperty", "s.ply", ply("1", kRow, "ascii", "", "property list int float more\n"),
            "allowed for a vertex: \"property TYPE NAME\""),
      shell("PlyUnknownType", "s.ply", ply("1", kRow, "ascii", "", "property quad more\n"),
            "allowed for a vertex: \"property TYPE NAME\""),
      shell("PlyFakeEndOfHeader", "s.ply", ply("3000000000", kRow, "ascii", "end_headerfoo\n"),
            "got \"end_headerfoo\"; allowed: format,"),
      shell("PlyHiddenElement", "s.ply", ply("1 element vertex 3000000000", kRow), "allowed: \"element vertex COUNT\""),
      shell("PlyWithoutVertices", "s.ply", ply("0", ""), "has no points; allowed: at least one"),
  };
  const auto add = [&inputs](const std::string& name, const std::string& file, const std::string& says) {
    inputs.push_back({name, with_value("plane", "/environment", R"({"type": "point_shell", "file": ")" + file + "\"}"),
                      "/environment/file", says});
  };
  add("ShellMissing", "missing.csv", "missing.csv: cannot be read: No such file or directory");
  add("PlyMissing", "missing.ply", "missing.ply: cannot be read: No such file or directory");
  add("ShellNameEmpty", "", "allowed: .csv or .ply");
  add("ShellNameWithLineBreak", "a\\nb.csv", "a?b.csv: cannot be read");
  add("ShellNameWithZeroByte", "a\\u0000.csv", "cannot be read: the name has a zero byte");
  add("ShellNameTooLong", std::string(4000, 'a') + ".csv", "cannot be read: File name too long");
  for (const char* name : {"directory.csv", "directory.ply"}) {
    BadInput input = shell(name == std::string("directory.csv") ? "CsvIsADirectory" : "PlyIsADirectory", name, "",
                           "is a directory, not a file");
    input.files = {{std::string(name) + "/inside", ""}};
    inputs.push_back(input);
  }
  return inputs;
}

std::vector<BadInput> bad_motion_files() {
  std::vector<BadInput> inputs = {
      motion("MotionEmpty", "",
             "line 1: the file is empty; allowed: header \"time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z\""),
      motion("MotionWrongHeader", "t,x,y,z\n0,0,0,0\n", "line 1: got header \"t,x,y,z\"; allowed: \"time_s,"),
      motion("MotionWithoutSamples", kMotion, "no samples; allowed: at least one"),
      motion("MotionTooFewCells", kMotion + "0,0,0,0,0,-1\n", "line 2: got 6 cells; allowed: 7"),
      motion("MotionNanCell", kMotion + "0,0,0,0,0,0,-1\n1,0,NaN,0,0,0,-1\n",
             "line 3: column 3: got \"NaN\"; allowed: a finite number"),
      motion("MotionTimesEqual", kMotion + "0,0,0,0,0,0,-1\n0,0,0,0,0,0,-1\n",
             "sample 2: got time 0 after 0; allowed: strictly increasing times"),
      motion("MotionTimesDecreasing", kMotion + "1,0,0,0,0,0,-1\n0.5,0,0,0,0,0,-1\n",
             "sample 2: got time 0.5 after 1; allowed: strictly increasing times"),
      motion("MotionWithoutAxis", kMotion + "0,0,0,0,0,0,0\n", "sample 1: got an axis of length 0; allowed:"),
      motion("MotionAxisOverflows", kMotion + "0,0,0,0,1e300,0,0\n", "sample 1: got an axis of length inf; allowed:"),
      motion("MotionQuaternionNotOfNormOne", "time_s,px_m,py_m,pz_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,0,0,0,0.5,0,0,0\n",
             "sample 2: got a quaternion qw,qx,qy,qz of norm 0.5; allowed: 1 within 0.001"),
  };
  BadInput missing = motion("MotionMissing", "", "m.csv: cannot be read: No such file or directory");
  missing.files.clear();
  inputs.push_back(missing);
  BadInput directory = motion("MotionIsADirectory", "", "m.csv: is a directory, not a file");
  directory.files = {{"m.csv/inside", ""}};
  inputs.push_back(directory);
  return inputs;
}

}  // namespace hapbench::test
