#include "export/hlsl_text.hpp"

#include <fmt/format.h>

#include "export/export_files.hpp"
#include "io/staged_directory.hpp"

namespace facezip::exporting {
namespace {

constexpr char kPreamble[] = R"(#define FACEZIP_HLSL
#define FZ_SEPARATE_DIFFERENCES
#define FZ_BETA(n) fz_beta[n]
// Weight maps are tiles of an atlas, each with a border of one texel.
#define FZ_LAYERS Texture2D<float4>
#define FZ_FETCH_LAYER(t, x, y, layer) \
  t.Load(int3(((layer) % fz_columns) * fz_tile_width + 1 + (x), FZ_ROW(((layer) / fz_columns) * fz_tile_height + 1 + (y)), 0))
)";

constexpr char kFromTop[] = R"(#define FZ_ROW(y) (y)
#define FZ_UV(uv) (uv)
)";
constexpr char kFromBottom[] = R"(#define FZ_ROW(y) (fz_height - 1 - (y))
#define FZ_UV(uv) float2((uv).x, 1.0 - (uv).y)
)";

// sRGB to linear light; a tangent-space normal of unit length. For what engines shade with.
constexpr char kConversions[] = R"(
float3 facezip_linear(float3 c) {
  c = saturate(c);
  return lerp(pow((c + 0.055) / 1.055, 2.4), c / 12.92, step(c, 0.04045));
}
float3 facezip_unit(float3 n) { return normalize(n * 2.0 - 1.0); }
)";

/// Channels of file f in the order of w_0..w_3: gray with alpha is read as (g, g, g, a).
std::string weightLine(const PackageWeights& weights, std::size_t file, std::size_t expressions) {
  const std::size_t channels = std::min<std::size_t>(4, weights.scale.size() - 4 * file);
  std::array<double, 4> scale = fourOf(weights.scale, file);
  std::array<double, 4> offset = fourOf(weights.offset, file);
  for (double& s : scale) s *= 255.0;
  if (channels == 2) {
    std::swap(scale[1], scale[3]);
    std::swap(offset[1], offset[3]);
  }
  return fmt::format(
      "  float4 w{0} = fz_weights_in_one_pass(weights_{0}, cell, cells, {1}, 1, 0,\n"
      "      {2},\n      {3}){4};\n",
      file, expressions, literal("float4", scale), literal("float4", offset), channels == 2 ? ".xwyz" : "");
}

std::string mapFunction(const Package& package, const EngineMap& map, KeptBlocks kept) {
  const PackageWeights& weights = package.weightSets()[static_cast<std::size_t>(map.map.weight_set)];
  std::string parameters = "float2 uv, SamplerState state, Texture2D<float4> neutral";
  for (std::size_t f = 0; f < weights.files.size(); ++f) parameters += fmt::format(", Texture2D<float4> weights_{}", f);
  for (std::size_t i = 0; i < map.differences.size(); ++i)
    parameters += fmt::format(", Texture2D<float4> difference_{}", i);
  std::string text = fmt::format("\nfloat4 facezip_{}({}) {{\n", map.id, parameters);
  text += fmt::format("  fz_columns = {};\n  fz_tile_width = {};\n  fz_tile_height = {};\n  fz_height = {};\n",
                      weights.columns, weights.tile_width + 2, weights.tile_height + 2,
                      weights.rows * (weights.tile_height + 2));
  text += fmt::format("  float2 cells = float2({}.0, {}.0);\n", weights.tile_width, weights.tile_height);
  text += fmt::format("  float2 cell = fz_cell(uv, float2({}.0, {}.0), {}.0, cells);\n", map.map.width, map.map.height,
                      map.map.weight_scale);
  for (std::size_t f = 0; f < weights.files.size(); ++f) text += weightLine(weights, f, package.expressions().size());
  // Rows of blocks are uploaded as they are stored, from the top.
  const auto place = [&](int texture) { return kept(map.map, texture) ? "from_top" : "uv"; };
  text += fmt::format("  float2 from_top = uv;\n  uv = FZ_UV(uv);\n  float4 value = neutral.Sample(state, {});\n",
                      place(-1));
  if (map.map.channels < 3) {
    text += fmt::format("  value = {};\n", swizzled("float4", "value", map.map.channels, kept(map.map, -1)));
  }
  for (std::size_t i = 0; i < map.differences.size(); ++i) {
    const int texture = static_cast<int>(i);
    const std::string sample = fmt::format("difference_{}.Sample(state, {})", i, place(texture));
    text += fmt::format("  value += ({} - {})\n      * {} * w{}.{};\n",
                        swizzled("float4", sample, map.map.channels, kept(map.map, texture)),
                        literal("float4", map.differences[i].zero), literal("float4", map.differences[i].scale), i / 4,
                        "xyzw"[i % 4]);
  }
  return text + "  return value;\n}\n";
}

}  // namespace

std::vector<std::string> mapTextures(const Package& package, const EngineMap& map) {
  std::vector<std::string> names = {map.id + "_neutral"};
  const std::size_t files = package.weightSets()[static_cast<std::size_t>(map.map.weight_set)].files.size();
  for (std::size_t f = 0; f < files; ++f) names.push_back(fmt::format("weights_{}_{}", map.map.weight_set, f));
  for (std::size_t i = 0; i < map.differences.size(); ++i) names.push_back(fmt::format("{}_difference_{}", map.id, i));
  return names;
}

std::string hlslFunctions(const Package& package, const std::vector<EngineMap>& maps, Rows rows,
                          const std::string& storage, KeptBlocks kept) {
  std::string text = kPreamble;
  text += rows == Rows::kFromTop ? kFromTop : kFromBottom;
  text +=
      fmt::format("{0}int fz_columns;\n{0}int fz_tile_width;\n{0}int fz_tile_height;\n{0}int fz_height;\n\n", storage);
  text += embeddedExportFiles().at("facezip_blend.h");
  for (const char* name : {"vec2", "vec4", "ivec2"}) text += fmt::format("#undef {}\n", name);
  text += kConversions;
  for (const EngineMap& map : maps) text += mapFunction(package, map, kept);
  return text;
}

void writePlainTextures(const Package& package, const std::vector<EngineMap>& maps, const std::filesystem::path& folder,
                        Progress& progress, KeptBlocks kept) {
  const std::filesystem::path textures = folder / "textures";
  io::createDirectories(textures);
  for (const EngineMap& map : maps) {
    for (int texture = -1; texture < static_cast<int>(map.differences.size()); ++texture) {
      const std::string name = texture < 0 ? map.id + "_neutral" : fmt::format("{}_difference_{}", map.id, texture);
      writeTexture(package, map, texture, kept, textures / name, progress);
    }
  }
  writeWeights(package, maps, textures, progress);
}

}  // namespace facezip::exporting
