// SPDX-License-Identifier: Apache-2.0
/// What components go on with after they were stopped; the first byte chooses the component.
#include <stdexcept>

#include "components/localizer/place_store.hpp"
#include "components/log/state_store.hpp"
#include "components/topology_mapper/mapper_store.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/restored_states.hpp"

namespace {

using namespace strata;

/// A finding, too, is a state that it saved itself and does not take.
template <typename Make>
void restore(fuzz::Input bytes, const Make& make) {
  try {
    fuzz::restore_and_go_on(bytes, make);
  } catch (const std::logic_error&) {
    __builtin_trap();
  }
}

void restore_place(const std::filesystem::path& file) {
  localizer::PlaceStoreConfig config;
  config.file = file.string();
  localizer::PlaceStore store(config, Eigen::Matrix3d::Identity());
  store.load();
  Observation first;
  first.has_odometry = true;
  (void)store.waits_for_odometry(first, true);
  const auto place = store.resume(first, ReflectionGrid{});
  if (place && !is_finite(place->map_from_robot.mean)) __builtin_trap();
}

void restore_way(const std::filesystem::path& file) {
  topology_mapper::MapperStore store(file);
  topology::TopologyMapper mapper{topology::TopologyMapperConfig{}};
  if (const auto newest = store.restore(mapper)) mapper.resume_from(*newest);
  Observation first;
  first.scan.ranges_m.assign(8, 1.0F);
  for (int step = 0; step < 3; ++step) {
    first.scan.stamp = first.scan.stamp + Duration::from_seconds(0.5);
    const std::size_t kept = mapper.scans().size();
    (void)mapper.add(first);
    if (mapper.scans().size() > kept) store.add(mapper.scans().back());
    if (mapper.newest()) store.came_to(*mapper.newest());
  }
  store.flush();
}

void restore_one(std::uint8_t kind, fuzz::Input bytes, const fuzz::ScratchFolder& scratch) {
  switch (kind) {
    case 0:
      return restore(bytes, fuzz::new_learner);
    case 1:
      return restore(bytes, fuzz::new_filter);
    case 2:
      return restore(bytes, fuzz::new_slam);
    case 3:
      return restore_place(scratch.write("place.yaml", bytes));
    case 4:
      return restore_way(scratch.write("way.db", bytes));
    default:
      (void)log::read_state_file(scratch.write("packed.state", bytes));
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::ScratchFolder scratch;
  if (size == 0) return 0;
  return fuzz::expect_value_or_error([&] {
    restore_one(data[0] % 6, {data + 1, size - 1}, scratch);
  });
}
