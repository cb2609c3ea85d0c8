// method_record.hpp - how a package was made, as package.json keeps it: enough to make it again.
#pragma once

#include <cstdint>
#include <string>

#include "compress/package_form.hpp"
#include "facezip/compress.hpp"

namespace facezip::compress {

/// What a compression found that its package keeps a note of.
struct MethodResult {
  int masks = 0;             ///< K
  double mask_radius = 0.0;  ///< in the mesh's unit
  std::string unit;          ///< of the mesh; "" if not known
  std::string region;        ///< where the region came from
  std::uint64_t covered_texels = 0;
  double permutation_cost = 0.0;
};

/// Options, the form that was chosen where they left it open, and results, as the JSON text of package.json's "method".
/// Holds nothing that differs from run to run.
std::string methodJson(const CompressOptions& options, const PackageForm& form, const MethodResult& result);

/// The options that methodJson() recorded; memory_bytes is not among them.
/// file  package.json, for the message. Throws InputError when the record is not one of ours.
CompressOptions optionsFromMethodJson(const std::string& json_text, const std::string& file);

}  // namespace facezip::compress
