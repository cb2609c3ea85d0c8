#include "learn/texture_learning.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "face/face.hpp"

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
  Eigen::RowVectorXf levels;               ///< of all channels
  std::vector<image::FloatImage> neutral;  ///< by map
};

SubjectTextures openSubject(const Library& library, std::size_t s, const geometry::TriangleMesh& layout,
                            const geometry::ShapeLibrary& meshes, const std::vector<int>& region, int side,
                            const std::vector<int>& channels) {
  geometry::TriangleMesh neutral = layout;
  neutral.positions = meshes.neutrals[s];
  SubjectTextures subject{TexelStrain(neutral, region, side), {}, {}, {}};
  subject.neutral = readNeutralTextures(library.subjects[s], library.maps, channels, side);
  subject.features = textureFeatures(subject.neutral, subject.strain.texels());
  for (const image::FloatImage& texture : subject.neutral) {
    const Eigen::RowVectorXf levels = levelsOf(texture, subject.strain.texels());
    subject.levels.conservativeResize(subject.levels.size() + levels.size());
    subject.levels.tail(levels.size()) = levels;
  }
  return subject;
}

/// How far an expression's textures are from the neutral's, over the levels of the neutral's: texels by the channels of
/// all maps.
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
        changes(static_cast<Eigen::Index>(t), column) =
            (texture.samples[at] - neutral.samples[at]) / subject.levels[column];
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
LearnedTextures learnedFrom(const Library& library, const std::vector<int>& channels, int side,
                            const TextureSums& sums) {
  LearnedTextures learned;
  const int total = std::accumulate(channels.begin(), channels.end(), 0);
  int begin = 0;
  for (std::size_t m = 0; m < channels.size(); ++m) {
    TextureModel model{library.maps[m], channels[m], side, {}};
    model.regressions.push_back({library.maps, channels, sums.solve(featuresOfChannels(0, total), begin, channels[m])});
    if (channels.size() > 1) {
      model.regressions.push_back(
          {{library.maps[m]}, {channels[m]}, sums.solve(featuresOfChannels(begin, channels[m]), begin, channels[m])});
    }
    const auto [error, nothing] = sums.errorOf(model.regressions[0].factors, begin, channels[m]);
    learned.quality.push_back({library.maps[m], 100.0 * error, 100.0 * nothing});
    learned.models.push_back(std::move(model));
    begin += channels[m];
  }
  return learned;
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
  if (library.maps.empty()) return {};
  const std::vector<int> region = compress::readFace(library.subjects.front(), "").region;
  std::vector<int> channels;
  for (const std::string& map : library.maps) {
    channels.push_back(image::ImageReader(mapOf(library.subjects.front(), map).neutral).shape().channels);
  }
  const int total = std::accumulate(channels.begin(), channels.end(), 0);
  progress.stage("regressing textures", library.subjects.size());
  TextureSums sums(featureCount(total), total);
  for (std::size_t s = 0; s < library.subjects.size(); ++s) {
    progress.checkCancelled();
    sums.add(sumFactors(library, s, meshes, openSubject(library, s, layout, meshes, region, side, channels), total));
    progress.advance(s + 1);
  }
  return learnedFrom(library, channels, side, sums);
}

}  // namespace facezip::learn
