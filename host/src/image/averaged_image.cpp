#include "image/averaged_image.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "image/set_sample.hpp"
#include "io/counts.hpp"

namespace facezip::image {

Image readAveraged(const std::filesystem::path& file, int factor) {
  ImageReader reader(file);
  const ImageShape from = reader.shape();
  ImageShape to = from;
  to.width = divideUp(from.width, factor);
  to.height = divideUp(from.height, factor);
  to.channels = from.channels >= 3 ? 3 : 1;
  Image averaged{to, std::vector<std::byte>(toSize(to.height) * to.rowBytes())};
  Image rows{from, {}};
  const Layout<3> place(to.height, to.width, to.channels);
  for (int y = 0; y < to.height; ++y) {
    const int begin = y * factor, end = std::min(begin + factor, from.height);
    rows.shape.height = end - begin;
    rows.samples.resize(toSize(end - begin) * from.rowBytes());
    reader.readRows(begin, end, rows.samples);
    const Layout<3> at(end - begin, from.width, from.channels);
    tbb::parallel_for(0, to.width, [&](int x) {
      const int columns = std::min(factor, from.width - x * factor);
      for (int c = 0; c < to.channels; ++c) {
        double sum = 0.0;
        for (int j = 0; j < end - begin; ++j) {
          for (int i = 0; i < columns; ++i) sum += double{sampleAt(rows, at(j, x * factor + i, c))};
        }
        setSample(averaged, place(y, x, c), static_cast<float>(sum / ((end - begin) * columns)));
      }
    });
  }
  return averaged;
}

}  // namespace facezip::image
