// SPDX-License-Identifier: Apache-2.0
/// What components go on with after they were stopped; the first byte chooses the component.
#include <memory>

#include "components/localizer/place_store.hpp"
#include "components/log/state_store.hpp"
#include "components/topology_mapper/mapper_store.hpp"
#include "core/beam_filter/online_filter.hpp"
#include "core/patch/online_learner.hpp"
#include "core/slam/slam.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace {

using namespace strata;

/// What could be restored can be saved and restored again.
template <typename Make>
void restore(fuzz::Input bytes, const Make& make) {
  auto first = make();
  first->restore_state(bytes, "fuzzed");
  // An error of this one would be taken for the answer to the bytes.
  try {
    make()->restore_state(first->save_state(), "saved");
  } catch (const Error&) {
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
  const auto place = store.resume(first);
  if (place && !is_finite(place->mean)) __builtin_trap();
}

void restore_way(const std::filesystem::path& file) {
  topology_mapper::MapperStore store(file);
  topology::TopologyMapper mapper{topology::TopologyMapperConfig{}};
  if (const auto newest = store.restore(mapper)) mapper.resume_from(*newest);
  Observation first;
  first.scan.ranges_m.assign(8, 1.0F);
  (void)mapper.add(first);
}

void restore_one(std::uint8_t kind, fuzz::Input bytes, const fuzz::ScratchFolder& scratch) {
  switch (kind) {
    case 0:
      return restore(bytes, [] {
        return std::make_unique<patch::OnlinePatchLearner>(patch::PatchLearnerConfig{},
                                                           patch::OnlineConfig{},
                                                           make_reflection_grid(0.05, CellRect{}));
      });
    case 1:
      return restore(bytes, [] { return std::make_unique<beam_filter::OnlineFilter>(); });
    case 2:
      return restore(bytes, [] { return std::make_unique<slam::Slam>(slam::SlamConfig{}); });
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
