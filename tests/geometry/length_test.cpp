#include "facezip/geometry/length.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "facezip/error.hpp"
#include "test_meshes.hpp"

namespace facezip::geometry {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(ParseUnit, KnowsSymbolsAndWords) {
  EXPECT_EQ(parseUnit("cm"), LengthUnit::kCentimetre);
  EXPECT_EQ(parseUnit("Centimeters"), LengthUnit::kCentimetre);
  EXPECT_EQ(parseUnit(" METRE "), LengthUnit::kMetre);
  EXPECT_EQ(parseUnit("millimetres"), LengthUnit::kMillimetre);
  EXPECT_EQ(parseUnit("inch"), LengthUnit::kInch);
  EXPECT_EQ(parseUnit("feet"), LengthUnit::kFoot);
  for (const char* bad : {"", " ", "km", "c m", "cmm"}) EXPECT_THROW(parseUnit(bad), InputError) << bad;
}

TEST(ParseUnit, ReadsItsOwnSymbols) {
  for (const LengthUnit unit : {LengthUnit::kMillimetre, LengthUnit::kCentimetre, LengthUnit::kDecimetre,
                                LengthUnit::kMetre, LengthUnit::kInch, LengthUnit::kFoot}) {
    EXPECT_EQ(parseUnit(unitSymbol(unit)), unit);
  }
}

TEST(ParseLength, ReadsNumbersWithAndWithoutUnit) {
  EXPECT_EQ(parseLength("3cm").value, 3);
  EXPECT_EQ(parseLength("3cm").unit, LengthUnit::kCentimetre);
  EXPECT_EQ(parseLength(" 0.03 m ").value, 0.03);
  EXPECT_EQ(parseLength("3e-2m").unit, LengthUnit::kMetre);
  EXPECT_EQ(parseLength("1.5").value, 1.5);
  EXPECT_FALSE(parseLength("1.5").unit.has_value());
}

TEST(ParseLength, RefusesWhatIsNoLength) {
  for (const char* bad : {"", "cm", "0cm", "-3cm", "nan", "inf", "infinity", "1e999m", "3 3cm", "3parsec", "3cm2"}) {
    EXPECT_THROW(parseLength(bad), InputError) << bad;
  }
}

TEST(ToMeshUnits, Converts) {
  EXPECT_DOUBLE_EQ(toMeshUnits(parseLength("3cm"), LengthUnit::kMetre), 0.03);
  EXPECT_DOUBLE_EQ(toMeshUnits(parseLength("0.03m"), LengthUnit::kMillimetre), 30);
  EXPECT_DOUBLE_EQ(toMeshUnits(parseLength("1ft"), LengthUnit::kInch), 12);
  EXPECT_EQ(toMeshUnits(parseLength("3cm"), LengthUnit::kCentimetre), 3);
  EXPECT_EQ(toMeshUnits(parseLength("3"), LengthUnit::kMetre), 3);
}

// A mesh with these extents.
TriangleMesh box(double x, double y, double z) {
  TriangleMesh mesh;
  mesh.positions.resize(3, 3);
  mesh.positions << 0, 0, 0, x, y, 0, 0, 0, z;
  mesh.triangles.resize(1, 3);
  mesh.triangles << 0, 1, 2;
  return mesh;
}

TEST(GuessUnit, FindsTheUnitOfHeads) {
  struct Row {
    double metres_per_unit;
    LengthUnit unit;
  };
  for (const Row& row : {Row{1e-3, LengthUnit::kMillimetre}, Row{1e-2, LengthUnit::kCentimetre},
                         Row{1, LengthUnit::kMetre}, Row{0.0254, LengthUnit::kInch}}) {
    const double s = 1 / row.metres_per_unit;
    for (const auto& [x, y, z] : {std::array{0.17, 0.25, 0.21}, std::array{0.2275, 0.2425, 0.3315}}) {
      const UnitGuess guess = guessUnit(box(s * x, s * y, s * z));
      EXPECT_EQ(guess.unit, row.unit) << guess.explanation;
      EXPECT_THAT(guess.explanation, HasSubstr(unitSymbol(row.unit)));
    }
  }
  EXPECT_EQ(guessUnit(box(0.45, 0.5, 0.27)).unit, LengthUnit::kMetre);  // a bust
  EXPECT_EQ(guessUnit(box(0.14, 0.2, 0.1)).unit, LengthUnit::kMetre);   // a face
}

TEST(GuessUnit, IgnoresVerticesThatNoTriangleUses) {
  TriangleMesh mesh = box(17, 25, 21);
  mesh.positions.conservativeResize(4, 3);
  mesh.positions.row(3) << 1e6, 0, 0;
  EXPECT_EQ(guessUnit(mesh).unit, LengthUnit::kCentimetre);
}

TEST(GuessUnit, RefusesSizesOfNothingHuman) {
  for (const TriangleMesh& mesh : {box(1, 1, 1), box(0, 0, 0), box(1, 180, 60), box(1700, 400, 300), box(20, 20, 1)}) {
    try {
      guessUnit(mesh);
      FAIL() << mesh.positions;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr("none"), HasSubstr("--unit"), HasSubstr("capture.json")));
    }
  }
}

TEST(GuessUnit, RefusesWhatFitsTwoUnits) {
  // A face of 19 cm, or a bust of 19 inches.
  try {
    guessUnit(box(14, 19, 9));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("face 0.19 m"), HasSubstr("bust 0.48 m"), HasSubstr("--unit")));
  }
}

}  // namespace
}  // namespace facezip::geometry
