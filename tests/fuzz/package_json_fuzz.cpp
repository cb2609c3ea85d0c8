// package.json: what is read is written and read again as the same.
#include <cstdlib>

#include "fuzz_input.hpp"
#include "package/package_json.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facezip;
  fuzz::refuseOrRead([&] {
    const PackageDescription description = package::parsePackageJson(fuzz::textOf(data, size), "package.json");
    const std::string text = package::packageJson(description);
    if (package::packageJson(package::parsePackageJson(text, "package.json")) != text) std::abort();
  });
  return 0;
}
