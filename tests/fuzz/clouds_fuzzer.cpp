// SPDX-License-Identifier: Apache-2.0
/// 3-D logs, told by content: OctoMap's text logs and scan graphs, and the clouds and pictures of
/// bags with what their tf says.
#include "components/clouds/bag_images.hpp"
#include "components/clouds/cloud_reader.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace {

using namespace strata;

bool is_finite(const Pose3& pose) {
  return pose.translation.allFinite() && pose.rotation.coeffs().allFinite();
}

/// What a cloud that was read promises to the map.
void check(const volume::Cloud& cloud) {
  bool is_sound = cloud.truly_moving.empty() || cloud.truly_moving.size() == cloud.points_m.size();
  is_sound = is_sound && (!cloud.parts.empty() || is_finite(cloud.map_from_sensor));
  std::size_t begin = 0;
  for (const volume::CloudPart& part : cloud.parts) {
    is_sound = is_sound && part.begin >= begin && part.begin <= cloud.points_m.size() &&
               is_finite(part.map_from_sensor);
    begin = part.begin;
  }
  is_sound = is_sound && (cloud.parts.empty() || cloud.parts.front().begin == 0);
  if (!is_sound) __builtin_trap();
}

void check(const clouds::PosedImage& posed) {
  const volume::ColorImage& image = posed.image;
  const auto pixels =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.pixels.size() != pixels || !is_finite(posed.map_from_camera)) __builtin_trap();
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::ScratchFolder scratch;
  const auto file = scratch.write("log", {data, size});
  fuzz::expect_value_or_error([&] {
    const auto reader = clouds::CloudReader::open(file);
    for (volume::Cloud cloud; reader->next(cloud);) check(cloud);
  });
  return fuzz::expect_value_or_error([&] {
    if (!clouds::is_bag(file)) return;
    clouds::BagImageReader reader(file, {});
    for (clouds::PosedImage image; reader.next(image);) check(image);
  });
}
