#include "rig/iris.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "facezip/error.hpp"
#include "facezip/rig.hpp"
#include "io/quoted.hpp"

namespace facezip {
namespace rig {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
// Of an eye of 24 mm: a pupil of 3.5 mm, an iris of 11.7 mm across.
constexpr double kPupil = 8.4 * kDegree;
constexpr double kLimbus = 26.0 * kDegree;
constexpr Colour kSclera = {228, 220, 214};
constexpr Colour kFlesh = {196, 132, 120};  // towards the back, where vessels are
constexpr Colour kDark = {6, 5, 5};

double smoothstep(double a, double b, double x) {
  const double t = std::clamp((x - a) / (b - a), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

Colour mix(const Colour& a, const Colour& b, double t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

Colour scaled(const Colour& a, double factor) { return {a[0] * factor, a[1] * factor, a[2] * factor}; }

/// A number in [0, 1) for each pair; the same on every machine.
double hashed(std::uint32_t a, std::uint32_t b) {
  std::uint32_t h = a * 0x9E3779B1u ^ (b + 0x7F4A7C15u) * 0x85EBCA77u;
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  h = (h ^ (h >> 12)) * 0x297A2D39u;
  return static_cast<double>((h ^ (h >> 15)) >> 8) / 16777216.0;
}

/// Smooth noise around the pupil that closes after a turn: `count` values a turn, in [0, 1).
double ring(double azimuth, std::uint32_t count, std::uint32_t seed) {
  const double at = (azimuth / (2.0 * std::numbers::pi) + 0.5) * count;
  const double whole = std::floor(at), t = at - whole, s = t * t * (3.0 - 2.0 * t);
  const auto i = static_cast<std::uint32_t>(whole) % count;
  return hashed(i, seed) * (1.0 - s) + hashed((i + 1) % count, seed) * s;
}

/// CIELAB under D65.
std::array<double, 3> labOf(const Colour& colour) {
  std::array<double, 3> linear = {};
  for (std::size_t c = 0; c < 3; ++c) {
    const double v = colour[c] / 255.0;
    linear[c] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  }
  const auto [r, g, b] = linear;
  const auto f = [](double t) { return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0; };
  const double x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505), y = f(0.2126 * r + 0.7152 * g + 0.0722 * b),
               z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
  return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

double difference(const Colour& a, const Colour& b) {
  const auto [la, aa, ba] = labOf(a);
  const auto [lb, ab, bb] = labOf(b);
  return std::hypot(la - lb, aa - ab, ba - bb);
}

/// #rrggbb
std::optional<Colour> parseColour(const std::string& text) {
  if (text.size() != 7 || text[0] != '#') return std::nullopt;
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data() + 1, text.data() + 7, value, 16);
  if (error != std::errc() || end != text.data() + 7) return std::nullopt;
  return Colour{static_cast<double>(value >> 16), static_cast<double>(value >> 8 & 255),
                static_cast<double>(value & 255)};
}

}  // namespace

const std::vector<Iris>& irises() {
  static const std::vector<Iris> all = {
      {"dark-brown", {62, 36, 22}, {44, 26, 18}}, {"brown", {112, 66, 34}, {82, 50, 30}},
      {"amber", {168, 110, 48}, {140, 92, 44}},   {"hazel", {140, 92, 46}, {98, 98, 60}},
      {"green", {142, 122, 66}, {88, 112, 78}},   {"grey", {138, 136, 122}, {116, 126, 132}},
      {"blue", {126, 148, 158}, {78, 112, 142}},  {"light-blue", {168, 186, 190}, {122, 158, 184}}};
  return all;
}

const Iris& findIris(const std::string& text, const std::string& option) {
  const std::vector<Iris>& all = irises();
  const auto found = std::ranges::find(all, text.empty() ? "brown" : text, &Iris::name);
  if (found != all.end()) return *found;
  if (const std::optional<Colour> colour = parseColour(text)) {
    return *std::ranges::min_element(
        all, {}, [&](const Iris& iris) { return difference(mix(iris.inner, iris.outer, 0.6), *colour); });
  }
  throw InputError(
      {option, "", fmt::format("{}, or a colour as #6b4a2f", fmt::join(irisNames(), ", ")), io::quoted(text), ""});
}

Colour eyeColour(const Iris& iris, double angle, double azimuth) {
  // Nobody sees its back but through the pupil.
  if (angle > 100.0 * kDegree) return kDark;
  const double radius = std::clamp((angle - kPupil) / (kLimbus - kPupil), 0.0, 1.0);  // of the iris: 0 to 1
  // Fibres run from the pupil to the rim, and waver where the collarette rings it.
  const double waver = azimuth + 0.05 * (ring(azimuth, 23, 1) - 0.5) * (1.0 + radius);
  const double fibres = 0.5 * ring(waver, 180, 2) + 0.3 * ring(waver, 67, 3) + 0.2 * ring(waver, 19, 4);
  const double collarette = 0.3 + 0.1 * (ring(azimuth, 31, 5) - 0.5);
  Colour colour = mix(iris.inner, iris.outer, smoothstep(collarette - 0.12, collarette + 0.2, radius));
  colour = scaled(colour, 0.72 + 0.6 * fibres);
  colour = scaled(colour, 1.0 - 0.35 * std::exp(-std::pow((radius - collarette) / 0.06, 2.0)) * ring(azimuth, 53, 6));
  colour = scaled(colour, 1.0 - 0.72 * smoothstep(0.72, 1.0, radius));  // the limbal ring
  colour = mix(kDark, colour, smoothstep(kPupil - 0.6 * kDegree, kPupil + 0.8 * kDegree, angle));
  const double veins = std::pow(ring(azimuth + 0.1 * ring(azimuth, 11, 7), 47, 8), 4.0);
  const Colour sclera = mix(kSclera, kFlesh, smoothstep(35.0 * kDegree, 95.0 * kDegree, angle) * (0.35 + 0.5 * veins));
  const Colour seen = mix(colour, sclera, smoothstep(kLimbus - 1.2 * kDegree, kLimbus + 1.8 * kDegree, angle));
  return mix(seen, kDark, smoothstep(90.0 * kDegree, 100.0 * kDegree, angle));
}

}  // namespace rig

std::vector<std::string> irisNames() {
  std::vector<std::string> names;
  for (const rig::Iris& iris : rig::irises()) names.push_back(iris.name);
  return names;
}

}  // namespace facezip
