// SPDX-License-Identifier: Apache-2.0
/// Maps of map_server: the YAML, then the image (PGM, PNG or BMP) that it may name map.pgm.
#include "components/log/map_file.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strata;
  static const fuzz::ScratchFolder scratch;
  return fuzz::expect_value_or_error([&] {
    const auto [yaml, image] = fuzz::split({data, size});
    scratch.write("map.pgm", image);
    (void)log::read_map(scratch.write("map.yaml", yaml));
  });
}
