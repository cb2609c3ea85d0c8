// Scans of a bumpy sheet: what the registration to scans is made of, together.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "facezip/error.hpp"
#include "facezip/geometry/mesh_edges.hpp"
#include "facezip/geometry/model_registration.hpp"
#include "facezip/geometry/nonrigid_registration.hpp"
#include "facezip/geometry/scan_surface.hpp"
#include "facezip/geometry/skin_registration.hpp"
#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

/// Height of a "face" 80 mm wide at x, y: hills that fix a place along the surface, too. `smile` raises one of them.
double height(double x, double y, double smile) {
  const auto hill = [&](double cx, double cy, double radius, double size) {
    return size * std::exp(-((x - cx) * (x - cx) + (y - cy) * (y - cy)) / (radius * radius));
  };
  return hill(40, 40, 12, 14) + hill(22, 58, 9, -6) + hill(58, 58, 9, -6) + hill(40, 18, 14, 5 + 6 * smile) +
         hill(60, 25, 8, 3);
}

TriangleMesh face(int side, double smile, double jitter = 0.0) {
  TriangleMesh mesh = test::makeSheet(side, side);
  for (Eigen::Index v = 0; v < mesh.positions.rows(); ++v) {
    const double wobble = std::sin(12.9898 * static_cast<double>(v)), wave = std::cos(78.233 * static_cast<double>(v));
    const double step = 80.0 / (side - 1);
    const double x = step * (static_cast<double>(v % side) + jitter * wobble);
    const double y = step * (static_cast<double>(v / side) + jitter * wave);
    mesh.positions.row(v) << x, y, height(x, y, smile);
  }
  return mesh;
}

Similarity someMotion() {
  Similarity motion;
  motion.turn = Eigen::AngleAxisd(0.1, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()).matrix();
  motion.shift << 3.0, -4.0, 2.0;
  return motion;
}

constexpr int kSide = 41;

struct Subject {
  TriangleMesh neutral = face(kSide, 0.0);
  Similarity motion = someMotion();
  TriangleMesh scan_mesh = face(90, 0.6, 0.3);
  std::vector<Landmark> landmarks;
  MatchedSurface surface{neutral.triangles,
                         std::vector<bool>(static_cast<std::size_t>(neutral.triangles.rows()), true)};
  LinearModel model{neutral.positions, {face(kSide, 1.0).positions - neutral.positions}, 0.0, 1.0};

  Subject() {
    scan_mesh.positions = motion.apply(scan_mesh.positions);
    const Eigen::MatrixX3d truth = motion.apply(face(kSide, 0.6).positions);
    for (const int vertex : {200, 440, 820, 860, 1200, 1500}) landmarks.push_back({vertex, truth.row(vertex)});
    for (std::size_t i = 0; i < landmarks.size(); ++i) landmarks[i].position[static_cast<Eigen::Index>(i) % 3] += 0.8;
  }
};

TEST(FaceRegistration, ALandmarkThatIsWrongDoesNotTurnTheHead) {
  Subject subject;
  const Eigen::MatrixX3d truth = subject.motion.apply(face(kSide, 0.6).positions);
  subject.landmarks[2].position.array() += 40.0;
  const Similarity found = alignLandmarks(face(kSide, 0.6).positions, subject.landmarks, true);
  EXPECT_LT((found.apply(face(kSide, 0.6).positions) - truth).rowwise().norm().mean(), 2.0);
}

TEST(FaceRegistration, FindsThePoseOfAModelInAScan) {
  const Subject subject;
  const ScanSurface scan(subject.scan_mesh.positions, subject.scan_mesh.triangles);
  ModelPose pose;
  pose.motion = alignLandmarks(subject.neutral.positions, subject.landmarks, true);
  pose.coefficients = Eigen::VectorXd::Zero(1);
  pose = registerModel(subject.model, pose, scan, subject.surface, subject.landmarks, {});
  EXPECT_NEAR(pose.coefficients[0], 0.6, 0.03);
  EXPECT_LT((pose.place(subject.model) - subject.motion.apply(face(kSide, 0.6).positions)).rowwise().norm().mean(),
            0.2);
}

TEST(FaceRegistration, BendsAMeshOntoAScanWithSpikesAndHoles) {
  Subject subject;
  for (const int spike : {500, 2000, 3456, 6000}) subject.scan_mesh.positions(spike, 2) += 8.0;
  std::vector<int> rows;
  for (int t = 0; t < subject.scan_mesh.triangles.rows(); ++t) {
    const int v = subject.scan_mesh.triangles(t, 0);
    if (std::hypot(v % 90 - 30, v / 90 - 60) > 6.0) rows.push_back(t);
  }
  const ScanSurface scan(subject.scan_mesh.positions, subject.scan_mesh.triangles(rows, Eigen::all));
  const Eigen::MatrixX3d start = subject.motion.apply(subject.neutral.positions);
  BentSurface surface{subject.neutral.positions, subject.surface,
                      seenTriangles(start, subject.neutral.triangles, scan)};
  NonRigidOptions options;
  options.first_length = 20.0;
  options.last_length = 2.0;
  options.steps = 4;
  const ScanResidual before = residualOf(surface, start, scan);
  const Eigen::MatrixX3d x = registerNonRigid(surface, start, scan, subject.landmarks, options);
  const ScanResidual after = residualOf(surface, x, scan);
  EXPECT_GT(before.mean, 0.3);
  EXPECT_LT(after.mean, 0.1);
  EXPECT_GT(after.matched, 0.95);
  // The hole too: smoothly.
  const ClosestSurface truth(subject.motion.apply(face(90, 0.6).positions), face(90, 0.6).triangles);
  double worst = 0.0;
  for (int row = 3; row < kSide - 3; ++row) {
    for (int column = 3; column < kSide - 3; ++column) {
      worst = std::max(worst, truth.closest(x.row(row * kSide + column).transpose()).distance);
    }
  }
  EXPECT_LT(worst, 0.6);
}

TEST(FaceRegistration, BendingEndsAtTheScansNoise) {
  Subject subject;
  std::mt19937 random(7);
  for (auto row : subject.scan_mesh.positions.rowwise()) {
    double sum = -6.0;  // of twelve uniform numbers: normal, nearly
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(random()) / 4294967296.0;
    row[2] += 0.2 * sum;
  }
  const ScanSurface scan(subject.scan_mesh.positions, subject.scan_mesh.triangles);
  const Eigen::MatrixX3d truth = subject.motion.apply(face(kSide, 0.6).positions);
  BentSurface surface{truth, subject.surface, seenTriangles(truth, subject.surface.triangles, scan)};
  const Eigen::MatrixX3d bent = registerNonRigid(surface, truth, scan, {}, {});
  EXPECT_LT((bent - truth).rowwise().norm().mean(), 0.03);
}

TEST(FaceRegistration, ClicksMoveASureStartLittle) {
  const Subject subject;
  const ScanSurface scan(subject.scan_mesh.positions, subject.scan_mesh.triangles);
  const Eigen::MatrixX3d truth = subject.motion.apply(face(kSide, 0.6).positions);
  BentSurface surface{truth, subject.surface, seenTriangles(truth, subject.surface.triangles, scan)};
  NonRigidOptions options;
  const auto drift = [&] {
    return (registerNonRigid(surface, truth, scan, subject.landmarks, options) - truth).rowwise().norm().mean();
  };
  const double usual = drift();
  options.landmark_share = 0.004;
  const double sure = drift();
  EXPECT_LT(sure, 0.3 * usual) << usual;
}

TEST(FaceRegistration, TrianglesBeyondTheScanAreNotSeen) {
  const Subject subject;
  std::vector<int> half;
  for (int t = 0; t < subject.scan_mesh.triangles.rows(); ++t) {
    if (subject.scan_mesh.triangles(t, 0) % 90 < 45) half.push_back(t);
  }
  const ScanSurface scan(subject.scan_mesh.positions, subject.scan_mesh.triangles(half, Eigen::all));
  const auto seen =
      seenTriangles(subject.motion.apply(face(kSide, 0.6).positions), subject.neutral.triangles, scan, 5.0);
  int left = 0, right = 0;
  for (std::size_t t = 0; t < seen.size(); ++t) {
    const int column = subject.neutral.triangles(static_cast<Eigen::Index>(t), 0) % kSide;
    if (column < 18) left += seen[t] ? 0 : 1;
    if (column > 22) right += seen[t] ? 1 : 0;
  }
  EXPECT_EQ(right, 0);
  EXPECT_LT(left, 2 * 2 * kSide) << "all but the rim";
}

TEST(FaceRegistration, HolesOfAScanAreSeenSinceTheSkinAroundThemIs) {
  const Subject subject;
  std::vector<int> rows;
  for (int t = 0; t < subject.scan_mesh.triangles.rows(); ++t) {
    const int v = subject.scan_mesh.triangles(t, 0);
    if (std::hypot(v % 90 - 45, v / 90 - 45) > 8.0) rows.push_back(t);
  }
  const ScanSurface scan(subject.scan_mesh.positions, subject.scan_mesh.triangles(rows, Eigen::all));
  const auto seen =
      seenTriangles(subject.motion.apply(face(kSide, 0.6).positions), subject.neutral.triangles, scan, 2.0);
  int unseen = 0;
  for (std::size_t t = 0; t < seen.size(); ++t) {
    const int v = subject.neutral.triangles(static_cast<Eigen::Index>(t), 0);
    if (std::hypot(v % kSide - 20, v / kSide - 20) < 8.0) unseen += seen[t] ? 0 : 1;
  }
  EXPECT_EQ(unseen, 0);
}

TEST(FaceRegistration, TheHeadsMotionIsToldFromWhatTheModelCannotDo) {
  const Subject subject;
  ModelPose truth;
  truth.motion = subject.motion;
  truth.coefficients = Eigen::VectorXd::Constant(1, 0.8);
  Eigen::MatrixX3d mesh = truth.place(subject.model);
  for (int v = 0; v < 300; ++v) mesh.row(v) += Eigen::RowVector3d(1.5, 0.5, 2.0);  // a part moves by itself
  ModelPose pose;
  pose.motion = fitSimilarity(subject.neutral.positions, mesh, {}, true);
  pose.coefficients = Eigen::VectorXd::Zero(1);
  const auto off = [&](const ModelPose& found) {
    return (found.motion.apply(subject.neutral.positions) - subject.motion.apply(subject.neutral.positions))
        .rowwise()
        .norm()
        .mean();
  };
  EXPECT_GT(off(pose), 0.3);
  const Eigen::VectorXd areas = vertexAreas(subject.neutral.positions, subject.neutral.triangles);
  EXPECT_LT(off(refitMotion(subject.model, pose, mesh, areas)), 0.05);
}

TEST(ScanSurface, CleaningWeldsSeamsAndDropsCrumbs) {
  const TriangleMesh sheet = test::makeSheet(20, 20);
  TriangleMesh crumb = test::makeSheet(2, 2);
  crumb.positions *= 0.5;
  TriangleMesh scan = test::join(sheet, crumb, {100, 0, 0});
  // A seam: the last triangle of the sheet has corners of its own.
  const auto count = scan.positions.rows();
  const Eigen::Index cut = sheet.triangles.rows() - 1;
  scan.positions.conservativeResize(count + 3, 3);
  for (int k = 0; k < 3; ++k) {
    scan.positions.row(count + k) = scan.positions.row(scan.triangles(cut, k));
    scan.triangles(cut, k) = static_cast<int>(count) + k;
  }
  test::addTriangle(scan, 5, 5, 6);
  std::vector<int> kept;
  const ScanCleaning cleaning = cleanScan(scan, &kept);
  EXPECT_EQ(cleaning.welded_vertices, 3);
  EXPECT_EQ(cleaning.loose_triangles, 2);
  EXPECT_EQ(cleaning.flat_triangles, 1);
  EXPECT_EQ(scan.triangles.rows(), sheet.triangles.rows());
  EXPECT_EQ(scan.uv_triangles.rows(), scan.triangles.rows());
  EXPECT_EQ(kept.size(), static_cast<std::size_t>(sheet.triangles.rows()));
  EXPECT_EQ(meshEdges(scan.triangles).size(), meshEdges(sheet.triangles).size());
  TriangleMesh nothing = test::makeSheet(3, 3);
  nothing.positions.setZero();
  EXPECT_THROW(cleanScan(nothing), InputError);
}

TEST(ScanSurface, ThinsPointsOutButNotTheirArea) {
  const TriangleMesh sheet = face(90, 0.0);
  const ScanSurface whole(sheet.positions, sheet.triangles), thin(sheet.positions, sheet.triangles, 1000);
  EXPECT_NEAR(static_cast<double>(thin.points().size()), 1000.0, 150.0);
  EXPECT_EQ(whole.points().size(), sheet.positions.rows());
  EXPECT_NEAR(thin.points().areas.sum(), whole.points().areas.sum(), 0.1 * whole.points().areas.sum());
}

/// A mesh that lies on the scan but slid along it, and where its triangles belong.
struct Slid {
  TriangleMesh scan_mesh = face(90, 0.6, 0.3);
  TriangleMesh truth = face(kSide, 0.6);
  Eigen::MatrixX3d slid = truth.positions;
  BentSurface surface{truth.positions,
                      {truth.triangles, std::vector<bool>(static_cast<std::size_t>(truth.triangles.rows()), true)},
                      std::vector<bool>(static_cast<std::size_t>(truth.triangles.rows()), true)};
  std::vector<SkinPoint> points;

  Slid() {
    for (Eigen::Index v = 0; v < slid.rows(); ++v) {
      slid(v, 0) += 1.2 * std::sin(0.07 * slid(v, 1));
      slid(v, 1) += 0.9 * std::cos(0.05 * slid(v, 0));
      slid(v, 2) = height(slid(v, 0), slid(v, 1), 0.6);
    }
    const Eigen::RowVector3d centre = Eigen::RowVector3d::Constant(1.0 / 3.0);
    for (int t = 0; t < truth.triangles.rows(); ++t) {
      points.push_back({t, centre, centre * truth.positions(truth.triangles.row(t), Eigen::all), 1.0});
    }
  }
  Eigen::MatrixX3d drawn() const {
    const ScanSurface scan(scan_mesh.positions, scan_mesh.triangles);
    return SkinRegistration(surface).draw(slid, slid, points, scan, {});
  }
  double error(const Eigen::MatrixX3d& mesh) const { return (mesh - truth.positions).rowwise().norm().mean(); }
};

TEST(SkinRegistration, PointsDrawAlongTheScanAndStayOnIt) {
  const Slid test;
  const Eigen::MatrixX3d drawn = test.drawn();
  EXPECT_GT(test.error(test.slid), 0.9);
  EXPECT_LT(test.error(drawn), 0.25);
  const ScanSurface scan(test.scan_mesh.positions, test.scan_mesh.triangles);
  double off = 0.0;
  for (const auto& p : drawn.rowwise()) off += scan.surface().closest(p.transpose()).distance / double(drawn.rows());
  EXPECT_LT(off, 0.05);
}

TEST(SkinRegistration, WithoutPointsItStays) {
  Slid test;
  test.points.clear();
  EXPECT_LT((test.drawn() - test.slid).rowwise().norm().mean(), 0.05);
}

TEST(SkinRegistration, PointsThatAreNotTrustedDoNotDraw) {
  Slid test;
  for (SkinPoint& point : test.points) {
    if (point.triangle % 2 == 0) continue;
    point.target.x() += 20.0;
    point.trust = 0.0;
  }
  EXPECT_LT(test.error(test.drawn()), 0.3);
}

}  // namespace
}  // namespace facezip::geometry
