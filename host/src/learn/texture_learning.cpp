#include "learn/texture_learning.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "compress/face.hpp"

namespace facezip::learn {
namespace {

/// Factors have thousands of times fewer unknowns than there are texels: every third of each expression does.
constexpr int kTexelStride = 3;

const CaptureMap& mapOf(const Capture& capture, const std::string& name) {
  return *std::ranges::find(capture.maps, name, &CaptureMap::name);
}

/// What is read of one subject.
struct SubjectTextures {
  TexelStrain strain;
  Eigen::MatrixXf features;                ///< texels by J, of all maps
  std::vector<image::FloatImage> neutral;  ///< by map
};

SubjectTextures openSubject(const Library& library, std::size_t s, const geometry::TriangleMesh& layout,
                            const geometry::ShapeLibrary& meshes, const std::vector<int>& region, int side,
                            const std::vector<int>& channels) {
  geometry::TriangleMesh neutral = layout;
  neutral.positions = meshes.neutrals[s];
  SubjectTextures subject{TexelStrain(neutral, region, side), {}, {}};
  subject.neutral = readNeutralTextures(library.subjects[s], library.maps, channels, side);
  subject.features = textureFeatures(subject.neutral, subject.strain.texels());
  return subject;
}

/// How far an expression's textures are from the neutral's: texels by the channels of all maps.
Eigen::MatrixXf changesOf(const Library& library, std::size_t s, std::size_t e, const SubjectTextures& subject) {
  const std::vector<int>& texels = subject.strain.texels();
  const int side = subject.strain.side();
  const int total = std::transform_reduce(subject.neutral.begin(), subject.neutral.end(), 0, std::plus<>(),
                                          [](const image::FloatImage& image) { return image.channels; });
  Eigen::MatrixXf changes(std::ssize(texels), total);
  Eigen::Index column = 0;
  for (std::size_t m = 0; m < library.maps.size(); ++m) {
    const std::filesystem::path& file = mapOf(library.subjects[s], library.maps[m]).expressions[e];
    const image::FloatImage& neutral = subject.neutral[m];
    const image::FloatImage texture = image::readResized(file, side, side);
    if (!texture.isLike(neutral)) {
      throw InputError({file.string(), "texture", fmt::format("{} channels as the neutral's", neutral.channels),
                        fmt::format("{}", texture.channels), ""});
    }
    const auto step = static_cast<std::size_t>(neutral.channels);
    for (std::size_t c = 0; c < step; ++c, ++column) {
      for (std::size_t t = 0; t < texels.size(); ++t) {
        const std::size_t at = static_cast<std::size_t>(texels[t]) * step + c;
        changes(static_cast<Eigen::Index>(t), column) = texture.samples[at] - neutral.samples[at];
      }
    }
  }
  return changes;
}

/// Features 0 (the 1) and those of channels [begin, begin + count).
std::vector<Eigen::Index> featuresOfChannels(int begin, int count) {
  std::vector<Eigen::Index> used = {0};
  for (Eigen::Index f = featureCount(begin); f < featureCount(begin + count); ++f) used.push_back(f);
  return used;
}

TextureSums sumFactors(const Library& library, std::size_t s, const geometry::ShapeLibrary& meshes,
                       const SubjectTextures& subject, Eigen::Index channels) {
  std::vector<TextureSums> sums(library.expressions.size(), TextureSums(subject.features.cols(), channels));
  tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t e) {
    const Eigen::VectorXf strain = subject.strain.of(meshes.examples[s][e].cast<double>());
    const Eigen::MatrixXf changes = changesOf(library, s, e, subject);
    std::vector<Eigen::Index> some;
    for (auto t = static_cast<Eigen::Index>((s + e) % kTexelStride); t < strain.size(); t += kTexelStride) {
      some.push_back(t);
    }
    sums[e].add(strain(some), subject.features(some, Eigen::all), changes(some, Eigen::all));
  });
  for (std::size_t e = 1; e < sums.size(); ++e) sums[0].add(sums[e]);  // in order, whatever the number of threads
  return std::move(sums[0]);
}

/// The maps' regressions from all maps of the library, and from the map itself.
std::vector<TextureModel> modelsOf(const Library& library, const std::vector<int>& channels, int side,
                                   const TextureSums& sums) {
  std::vector<TextureModel> models;
  const int total = std::accumulate(channels.begin(), channels.end(), 0);
  int begin = 0;
  for (std::size_t m = 0; m < channels.size(); ++m) {
    TextureModel model;
    model.map = library.maps[m];
    model.channels = channels[m];
    model.side = side;
    model.regressions.push_back({library.maps, channels, sums.solve(featuresOfChannels(0, total), begin, channels[m])});
    if (channels.size() > 1) {
      model.regressions.push_back(
          {{library.maps[m]}, {channels[m]}, sums.solve(featuresOfChannels(begin, channels[m]), begin, channels[m])});
    }
    model.slopes = image::FloatImage(side, side, 2 * channels[m]);
    begin += channels[m];
    models.push_back(std::move(model));
  }
  return models;
}

/// Squared errors of one map.
struct Squares {
  double left = 0.0, nothing = 0.0, count = 0.0;
};

/// Adds what the models leave of one subject's changes.
void addLeft(const Library& library, std::size_t s, const geometry::ShapeLibrary& meshes,
             const SubjectTextures& subject, const std::vector<TextureModel>& models, std::vector<SlopeSums>& slopes,
             std::vector<Squares>& squares) {
  struct Left {
    Eigen::VectorXf strain;
    std::vector<Eigen::MatrixXf> by_map;
    std::vector<Squares> squares;
  };
  std::vector<Left> left(library.expressions.size());
  tbb::parallel_for(std::size_t{0}, left.size(), [&](std::size_t e) {
    left[e].strain = subject.strain.of(meshes.examples[s][e].cast<double>());
    const Eigen::MatrixXf changes = changesOf(library, s, e, subject);
    Eigen::Index begin = 0;
    for (const TextureModel& model : models) {
      const auto own = changes.middleCols(begin, model.channels);
      left[e].by_map.push_back(
          own - predictTexture(model, model.regressions[0], left[e].strain, subject.features, subject.strain.texels()));
      left[e].squares.push_back({static_cast<double>(left[e].by_map.back().squaredNorm()),
                                 static_cast<double>(own.squaredNorm()), static_cast<double>(own.size())});
      begin += model.channels;
    }
  });
  for (const Left& expression : left) {
    for (std::size_t m = 0; m < models.size(); ++m) {
      slopes[m].add(expression.strain, expression.by_map[m]);
      const Squares& add = expression.squares[m];
      squares[m] = {squares[m].left + add.left, squares[m].nothing + add.nothing, squares[m].count + add.count};
    }
  }
}

}  // namespace

std::vector<image::FloatImage> readNeutralTextures(const Capture& capture, const std::vector<std::string>& maps,
                                                   const std::vector<int>& channels, int side) {
  std::vector<image::FloatImage> textures;
  for (std::size_t m = 0; m < maps.size(); ++m) {
    const std::filesystem::path& file = mapOf(capture, maps[m]).neutral;
    textures.push_back(image::readResized(file, side, side));
    const int expected = channels[m] == 0 ? textures.back().channels : channels[m];
    if (textures.back().channels == expected) continue;
    throw InputError({file.string(), "texture", fmt::format("{} channels, as others of the map have", expected),
                      fmt::format("{}", textures.back().channels), ""});
  }
  return textures;
}

LearnedTextures learnTextures(const Library& library, const geometry::TriangleMesh& layout,
                              const geometry::ShapeLibrary& meshes, int side, Progress& progress) {
  LearnedTextures learned;
  if (library.maps.empty()) return learned;
  const std::vector<int> region = compress::readFace(library.subjects.front(), "").region;
  std::vector<int> channels;
  for (const std::string& map : library.maps) {
    channels.push_back(image::ImageReader(mapOf(library.subjects.front(), map).neutral).shape().channels);
  }
  const int total = std::accumulate(channels.begin(), channels.end(), 0);
  const std::size_t subjects = library.subjects.size();

  progress.stage("regressing textures", 2 * subjects);
  TextureSums sums(featureCount(total), total);
  for (std::size_t s = 0; s < subjects; ++s) {
    progress.checkCancelled();
    sums.add(sumFactors(library, s, meshes, openSubject(library, s, layout, meshes, region, side, channels), total));
    progress.advance(s + 1);
  }
  learned.models = modelsOf(library, channels, side, sums);

  std::vector<Squares> squares(channels.size());
  std::vector<SlopeSums> slopes;
  for (std::size_t s = 0; s < subjects; ++s) {
    progress.checkCancelled();
    const SubjectTextures subject = openSubject(library, s, layout, meshes, region, side, channels);
    if (slopes.empty()) {
      for (const int count : channels) slopes.emplace_back(std::ssize(subject.strain.texels()), count);
    }
    addLeft(library, s, meshes, subject, learned.models, slopes, squares);
    progress.advance(subjects + s + 1);
  }
  const TexelStrain texels(layout, region, side);
  for (std::size_t m = 0; m < channels.size(); ++m) {
    const Eigen::MatrixXf found = slopes[m].solve();
    learned.models[m].slopes = texels.imageOf(found);
    const double count = std::max(squares[m].count, 1.0);
    learned.quality.push_back({library.maps[m],
                               std::sqrt(std::max(0.0, squares[m].left - slopes[m].explained(found)) / count),
                               std::sqrt(squares[m].nothing / count)});
  }
  return learned;
}

}  // namespace facezip::learn
