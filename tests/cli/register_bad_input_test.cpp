// Bad scans, landmarks and templates: one clear error, the right exit code, nothing left behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "exit_codes.hpp"
#include "io/write_file.hpp"
#include "run_command.hpp"
#include "scan_set.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using test::quoted;
using testing::HasSubstr;

class RegisterBadInput : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    good_ = new test::TemporaryDirectory;
    test::ScanSet().write(*good_ / "scans", *good_ / "template");
  }
  static void TearDownTestSuite() { delete good_; }
  void SetUp() override { fs::copy(good_->path(), folder_.path(), fs::copy_options::recursive); }

  fs::path scans() const { return folder_ / "scans"; }
  fs::path shapes() const { return folder_ / "template"; }
  fs::path mesh(const std::string& name) const { return scans() / "scans" / (name + ".obj"); }

  test::CommandResult run(const std::string& options) const {
    return test::runFacezip("register " + quoted(scans()) + " --template " + quoted(shapes()) + " --output " +
                            quoted(folder_ / "capture") + " " + options);
  }
  void expectFailure(const std::vector<std::string>& parts,
                     const std::string& options = "--unit cm --resolution 64") const {
    const auto files = test::filesBelow(folder_.path());
    const test::CommandResult result = run(options);
    EXPECT_EQ(result.exit_code, cli::kExitInput) << result.error;
    for (const std::string& part : parts) EXPECT_THAT(result.error, HasSubstr(part));
    EXPECT_THAT(result.error, HasSubstr("facezip: error: "));
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(test::filesBelow(folder_.path()), files) << "something was left behind";
  }
  static json read(const fs::path& file) { return json::parse(std::ifstream(file)); }
  void changeLandmarks(const std::function<void(json&)>& change) const {
    json marks = read(scans() / "landmarks.json");
    change(marks);
    io::writeTextFile(scans() / "landmarks.json", marks.dump());
  }
  void changeMesh(const std::string& name, const std::function<void(geometry::TriangleMesh&)>& change) const {
    geometry::TriangleMesh scan = geometry::readObj(mesh(name));
    change(scan);
    geometry::writeObj(mesh(name), scan);
  }

  static test::TemporaryDirectory* good_;
  const test::TemporaryDirectory folder_;
};
test::TemporaryDirectory* RegisterBadInput::good_ = nullptr;

TEST_F(RegisterBadInput, NoScansNoNeutralNoLandmarks) {
  fs::remove(scans() / "landmarks.json");
  expectFailure({"landmarks.json", "no such file"});
  fs::remove(mesh("neutral"));
  expectFailure({"neutral.obj"});
  fs::remove_all(scans());
  expectFailure({"no such directory"});
}

TEST_F(RegisterBadInput, ScansWithoutTextureOrUvs) {
  fs::remove(scans() / "scans/neutral.png");
  expectFailure({"neutral.obj", "a texture"});
  changeMesh("neutral", [](geometry::TriangleMesh& scan) {
    scan.uvs.resize(0, 2);
    scan.uv_triangles.resize(0, 3);
  });
  expectFailure({"neutral.obj", "texture coordinates"});
}

TEST_F(RegisterBadInput, LandmarksThatAreMirroredOffTheSurfaceOrOfNoUse) {
  changeLandmarks([](json& marks) {
    for (auto& point : marks["neutral"]) point[1] = point[1].get<double>() + 3.0;
  });
  expectFailure({"landmarks.json", "neutral", "more than 5 mm off it"});
  changeLandmarks([](json& marks) { marks["neutral"] = {{"nose", {0, 0, 0}}}; });
  expectFailure({"at least 6 landmarks"});
  changeLandmarks([](json& marks) { marks["neutral"] = {{"nose", {0, "x", 0}}}; });
  expectFailure({"landmarks.json", "neutral.nose"});
  changeLandmarks([](json& marks) { marks.erase("neutral"); });
  expectFailure({"landmarks of every scan"});
}

TEST_F(RegisterBadInput, AMirroredScan) {
  changeLandmarks([](json& marks) {
    for (auto& point : marks["neutral"]) point[0] = -point[0].get<double>();
  });
  changeMesh("neutral", [](geometry::TriangleMesh& scan) {
    scan.positions.col(0) *= -1.0;
    scan.triangles.col(1).swap(scan.triangles.col(2));
    scan.uv_triangles.col(1).swap(scan.uv_triangles.col(2));
  });
  expectFailure({"neutral.obj", "mirror image"});
}

TEST_F(RegisterBadInput, OtherUnits) {
  expectFailure({"unit"}, "--unit parsec");
  // Ten times as large as it is: landmarks and template disagree by a factor that no unit explains... or one that does.
  changeMesh("open", [](geometry::TriangleMesh& scan) { scan.positions *= 10.0; });
  changeLandmarks([](json& marks) {
    for (auto& point : marks["open"]) {
      for (auto& coordinate : point) coordinate = 10.0 * coordinate.get<double>();
    }
  });
  expectFailure({"open.obj", "the unit of the neutral's scan"});
}

TEST_F(RegisterBadInput, ATemplateThatIsNone) {
  io::writeTextFile(shapes() / "landmarks.json", "{\"p40\": 1000000}");
  expectFailure({"landmarks.json", "p40"});
  geometry::writeObj(shapes() / "open.obj", test::gridMesh(10));
  fs::copy_file(good_->path() / "template/landmarks.json", shapes() / "landmarks.json",
                fs::copy_options::overwrite_existing);
  expectFailure({"open.obj", "number of vertices"});
  fs::remove(shapes() / "neutral.obj");
  expectFailure({"neutral.obj or generic_neutral.obj"});
}

TEST_F(RegisterBadInput, AScanOfSomethingElse) {
  changeLandmarks([](json& marks) {  // the same points in another order: no face
    const json points = marks["neutral"];
    std::vector<json> values;
    for (const auto& point : points) values.push_back(point);
    std::size_t i = 0;
    for (auto& point : marks["neutral"]) point = values[(i++ * 17) % values.size()];
  });
  expectFailure({"neutral.obj", "landmarks"});
}

TEST_F(RegisterBadInput, MapsThatAreNone) {
  expectFailure({"--maps", "albedo, and with it", "gloss"}, "--unit cm --resolution 64 --maps albedo,gloss");
  expectFailure({"--maps"}, "--unit cm --resolution 64 --maps normal");
  expectFailure({"--maps"}, "--unit cm --resolution 64 --maps albedo,normal,normal");
}

TEST_F(RegisterBadInput, ResolutionOutOfRange) { expectFailure({"--resolution"}, "--unit cm --resolution 20"); }

TEST_F(RegisterBadInput, InvertedTrianglesAreTurnedAndHalfAFaceIsTold) {
  changeMesh("open", [](geometry::TriangleMesh& scan) {
    scan.triangles.col(1).swap(scan.triangles.col(2));
    scan.uv_triangles.col(1).swap(scan.uv_triangles.col(2));
    std::vector<int> kept;
    for (int t = 0; t < scan.triangles.rows(); ++t) {
      if (scan.positions(scan.triangles(t, 0), 0) > -1.0) kept.push_back(t);
    }
    scan.triangles = scan.triangles(kept, Eigen::all).eval();
    scan.uv_triangles = scan.uv_triangles(kept, Eigen::all).eval();
  });
  const test::CommandResult result = run("--unit cm --resolution 64 --report " + quoted(folder_ / "report.json"));
  EXPECT_EQ(result.exit_code, cli::kExitSuccess) << result.error;
  EXPECT_THAT(result.error, HasSubstr("open: triangles face inwards"));
  EXPECT_THAT(result.error, HasSubstr("open: the scan shows"));
  EXPECT_THAT(result.out, HasSubstr("scan to mesh"));
  EXPECT_LT(read(folder_ / "report.json")["scans"][1]["coverage"].get<double>(), 0.8);
}

}  // namespace
}  // namespace facezip
