// scan_set.hpp - raw scans of the built-in head, and the template of another head to register them to.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "facezip/geometry/face_region.hpp"
#include "facezip/geometry/obj_io.hpp"
#include "image/image_file.hpp"
#include "io/read_file.hpp"
#include "io/write_file.hpp"
#include "raster/uv_raster.hpp"
#include "small_capture.hpp"
#include "synth/actions.hpp"
#include "synth/head_mesh.hpp"

namespace facezip::test {

/// A subject, and scans of it whose vertices and layout are their own.
class ScanSet {
 public:
  static constexpr int kGrid = 110;     ///< samples of the layout along each axis, the scans' vertices
  static constexpr int kTexture = 256;  ///< side of the scans' textures
  static constexpr double kLight[3] = {1.06, 0.97, 0.9};  ///< of the expression's scan beside the neutral's

  ScanSet() : shape_(5), head_(shape_), template_shape_(6), template_head_(template_shape_) {
    for (int v = 40; v < head_.mesh.positions.rows(); v += 197) landmarks_.push_back(v);
  }

  const geometry::TriangleMesh& mesh() const { return head_.mesh; }
  const std::vector<int>& landmarks() const { return landmarks_; }
  /// In metres. amount  of jawOpen and a brow, 0: the neutral
  Eigen::MatrixX3d truth(double amount) const { return posed(head_, shape_, amount); }

  /// What the skin looks like at a place of the template's layout, 0..255: grey, spots and pores some texels wide.
  static double skin(double u, double v) {
    return 128.0 + 44.0 * std::sin(40.0 * u + 9.0 * v) + 44.0 * std::cos(37.0 * v - 7.0 * u) +
           14.0 * std::sin(150.0 * u + 40.0 * v) * std::cos(130.0 * v - 50.0 * u);
  }
  /// The subject's layout turned by a quarter.
  static Eigen::RowVector2d scanUv(double u, double v) { return {v, 1.0 - u}; }

  /// SCANS/scans/NAME.obj, .mtl, .png and SCANS/landmarks.json, in centimetres; TEMPLATE in metres.
  void write(const std::filesystem::path& scans, const std::filesystem::path& shapes) const {
    io::createDirectories(scans / "scans");
    io::createDirectories(shapes);
    nlohmann::json marks;
    writeScan(scans, "neutral", 0.0, marks);
    writeScan(scans, "open", 0.8, marks);
    io::writeTextFile(scans / "landmarks.json", marks.dump());
    geometry::TriangleMesh mesh = template_head_.mesh;
    geometry::writeObj(shapes / "neutral.obj", mesh);
    mesh.positions = posed(template_head_, template_shape_, 1.0);
    geometry::writeObj(shapes / "open.obj", mesh);
    nlohmann::json vertices;
    for (const int vertex : landmarks_) vertices["p" + std::to_string(vertex)] = vertex;
    io::writeTextFile(shapes / "landmarks.json", vertices.dump());
  }

 private:
  static Eigen::MatrixX3d posed(const synth::HeadMesh& head, const synth::HeadShape& shape, double amount) {
    if (amount == 0.0) return head.mesh.positions;
    std::vector<synth::WeightedAction> actions;
    for (const synth::Action& action : synth::actionBasis()) {
      if (action.name == "jawOpen" || action.name == "browInnerUp") actions.push_back({&action, amount});
    }
    return synth::deform(head, shape, actions, 1);
  }

  static Eigen::RowVector3d placed(const Eigen::RowVector3d& metres, bool neutral) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(neutral ? 0.03 : -0.05, Eigen::Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
    return 100.0 * metres * turn.transpose() +
           (neutral ? Eigen::RowVector3d(0.4, -0.3, 0.2) : Eigen::RowVector3d(-0.5, 0.6, 0));
  }

  void writeScan(const std::filesystem::path& folder, const std::string& name, double amount,
                 nlohmann::json& marks) const {
    const Eigen::MatrixX3d positions = truth(amount);
    const raster::UvRaster raster(head_.mesh, geometry::wholeMeshRegion(head_.mesh), kGrid, kGrid, 0);
    const std::vector<raster::TexelSample> samples = raster.rows(0, kGrid);
    std::vector<int> vertex_of(samples.size(), -1);
    std::vector<Eigen::RowVector3d> points;
    std::vector<Eigen::RowVector2d> uvs;
    for (int i = 0; i < kGrid * kGrid; ++i) {
      const raster::TexelSample& sample = samples[static_cast<std::size_t>(i)];
      if (sample.triangle < 0) continue;
      const Eigen::RowVector3d weights(double{sample.b0}, double{sample.b1},
                                       1.0 - double{sample.b0} - double{sample.b1});
      vertex_of[static_cast<std::size_t>(i)] = static_cast<int>(points.size());
      points.push_back(
          placed(weights * positions(head_.mesh.triangles.row(sample.triangle), Eigen::all), amount == 0.0));
      uvs.push_back(scanUv((i % kGrid + 0.5) / kGrid, 1.0 - (i / kGrid + 0.5) / kGrid));
    }
    geometry::TriangleMesh scan;
    scan.positions.resize(static_cast<Eigen::Index>(points.size()), 3);
    scan.uvs.resize(scan.positions.rows(), 2);
    for (std::size_t v = 0; v < points.size(); ++v) {
      scan.positions.row(static_cast<Eigen::Index>(v)) = points[v];
      scan.uvs.row(static_cast<Eigen::Index>(v)) = uvs[v];
    }
    std::vector<Eigen::RowVector3i> triangles;
    for (int i = 0; i + kGrid + 1 < kGrid * kGrid; ++i) {
      if (i % kGrid == kGrid - 1) continue;
      // Rows go down, v goes up.
      const int a = vertex_of[static_cast<std::size_t>(i)], b = vertex_of[static_cast<std::size_t>(i + 1)],
                c = vertex_of[static_cast<std::size_t>(i + kGrid + 1)],
                d = vertex_of[static_cast<std::size_t>(i + kGrid)];
      for (const Eigen::RowVector3i& t : {Eigen::RowVector3i(a, d, c), Eigen::RowVector3i(a, c, b)}) {
        if (t.minCoeff() < 0) continue;
        const Eigen::MatrixX3d corners = scan.positions(t, Eigen::all);
        const double longest =
            std::max({(corners.row(0) - corners.row(1)).norm(), (corners.row(1) - corners.row(2)).norm(),
                      (corners.row(2) - corners.row(0)).norm()});
        if (longest < 1.0) triangles.push_back(t);  // no webs over the mouth
      }
    }
    scan.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
    for (std::size_t t = 0; t < triangles.size(); ++t) scan.triangles.row(static_cast<Eigen::Index>(t)) = triangles[t];
    scan.uv_triangles = scan.triangles;
    const std::filesystem::path mesh_file = folder / "scans" / (name + ".obj");
    geometry::writeObj(mesh_file, scan);
    io::writeTextFile(folder / "scans" / (name + ".mtl"), "newmtl skin\nmap_Kd C:\\scans\\" + name + ".png\n");
    prepend(mesh_file, "mtllib " + name + ".mtl\nusemtl skin\n");
    const auto texel = [amount](int x, int y, int channel) {
      const double s = (x + 0.5) / kTexture, t = 1.0 - (y + 0.5) / kTexture;  // of the scan: s = v, t = 1 - u
      return (amount == 0.0 ? 1.0 : kLight[channel]) * skin(1.0 - t, s);
    };
    image::writeImage(folder / "scans" / (name + ".png"),
                      makeImage({kTexture, kTexture, 3, image::SampleType::kUint8}, texel));
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      Eigen::RowVector3d point = placed(positions.row(landmarks_[i]), amount == 0.0);
      point[static_cast<Eigen::Index>(i) % 3] += i % 2 == 0 ? 0.05 : -0.05;  // half a millimetre off
      marks[name]["p" + std::to_string(landmarks_[i])] = {point[0], point[1], point[2]};
    }
  }

  static void prepend(const std::filesystem::path& file, const std::string& text) {
    const std::string rest = io::readFile(file, "a mesh");
    io::writeTextFile(file, text + rest);
  }

  synth::HeadShape shape_;
  synth::HeadMesh head_;
  synth::HeadShape template_shape_;
  synth::HeadMesh template_head_;
  std::vector<int> landmarks_;
};

}  // namespace facezip::test
