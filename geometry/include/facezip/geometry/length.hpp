// length.hpp - lengths with units, and the unit of a mesh.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "facezip/geometry/mesh.hpp"

namespace facezip::geometry {

enum class LengthUnit { kMillimetre, kCentimetre, kDecimetre, kMetre, kInch, kFoot };

/// Metres in one unit; exact (25.4 mm to the inch).
double metresPerUnit(LengthUnit unit);

/// The unit's symbol: "mm", "cm", "dm", "m", "in", "ft".
std::string unitSymbol(LengthUnit unit);

/// Reads a symbol or a full word, singular or plural, British or American, in any case: "cm", "Metres", "inch".
/// Throws InputError listing the units if name is none.
LengthUnit parseUnit(std::string_view name);

/// A length as a user states it.
struct Length {
  double value = 0;                ///< finite and above 0
  std::optional<LengthUnit> unit;  ///< none: the unit of the mesh it is applied to
};

/// The paper's distance between mask samples (FaceZip 3.1, Mask Computation).
inline constexpr Length kDefaultMaskRadius{3, LengthUnit::kCentimetre};

/// Reads "3cm", "0.03 m" or "3" (the mesh's unit). Throws InputError unless text is a finite number above 0 and, if
/// anything follows, a unit.
Length parseLength(std::string_view text);

/// The length in units of the mesh.
double toMeshUnits(const Length& length, LengthUnit mesh_unit);

/// A unit and where it came from.
struct UnitGuess {
  LengthUnit unit;
  std::string explanation;  ///< one sentence for the user: what was measured and what was concluded
};

/// Guesses the unit of a mesh of a face, a head or a bust from its bounding box: in mm, cm, m or inches, the extents
/// from the smallest to the largest must be those of one of the three. Feet and decimetres are not guessed: nobody
/// models heads in them, and they would only make other guesses ambiguous.
/// mesh  the whole neutral mesh, upright along any axis; vertices that no triangle uses do not count
/// Throws InputError if no unit fits, or two (a bare face in centimetres has the numbers of a bust in inches).
UnitGuess guessUnit(const TriangleMesh& mesh);

}  // namespace facezip::geometry
