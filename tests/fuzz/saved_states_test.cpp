// SPDX-License-Identifier: Apache-2.0
/// Saved states, whole and altered. STRATA_WRITE_SEEDS=1 writes those of the corpus anew, which is
/// needed when their version goes up: a fuzzer gets nowhere with others. STRATA_FUZZ_SEED alters
/// them in other ways.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/core/patch/toy_world.hpp"
#include "tests/fuzz/restored_states.hpp"

namespace strata::fuzz {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr int kMutations = 400;

/// Of an object that is new, or has gone through a life.
template <typename Make>
Bytes state_of(const Make& make, std::optional<Ahead> ahead) {
  const auto object = make();
  if (ahead) go_on(*object, *ahead);
  return object->save_state();
}

/// The first byte tells the fuzz target which it is.
void keep_seed(const std::string& name, std::uint8_t kind, const Bytes& state) {
  std::ofstream out(std::filesystem::path(STRATA_SEEDS) / name, std::ios::binary);
  out.put(static_cast<char>(kind));
  out.write(reinterpret_cast<const char*>(state.data()),
            static_cast<std::streamsize>(state.size()));
}

template <typename Make>
void expect_seed(const std::string& name, std::uint8_t kind, const Make& make,
                 std::optional<Ahead> ahead) {
  if (std::getenv("STRATA_WRITE_SEEDS") != nullptr) keep_seed(name, kind, state_of(make, ahead));
  std::ifstream in(std::filesystem::path(STRATA_SEEDS) / name, std::ios::binary);
  const Bytes bytes{std::istreambuf_iterator<char>(in), {}};
  ASSERT_FALSE(bytes.empty()) << name;
  EXPECT_EQ(bytes.front(), kind) << name;
  EXPECT_NO_THROW(restore_and_go_on(std::span(bytes).subspan(1), make)) << name;
}

TEST(SavedState, OfTheCorpusIsOneThatThisVersionTakes) {
  // Maps are large, and a fuzzer is quick with what is small: they come with the scans after it.
  expect_seed("learner_new", 0, new_learner, {});
  expect_seed("learner_in_the_open", 0, new_learner, Ahead::kNothing);
  expect_seed("filter_new", 1, new_filter, {});
  expect_seed("filter_in_the_open", 1, new_filter, Ahead::kNothing);
  expect_seed("slam_new", 2, new_slam, {});
  expect_seed("slam_in_the_open", 2, new_slam, Ahead::kNothing);
}

/// Where sizes and indices are likely: most of the rest are the cells of maps.
std::size_t place_in(std::size_t size, std::mt19937& random) {
  constexpr std::size_t kVersion = 8;
  constexpr std::size_t kMax = 6000;
  const std::size_t last = size - 8;
  const std::size_t near = kVersion + random() % std::min(last - kVersion, kMax);
  switch (random() % 3) {
    case 0:
      return near;
    case 1:
      return last - (near - kVersion);
    default:
      return kVersion + random() % (last - kVersion);
  }
}

/// One to four places of it: a bit, or an absurd number.
Bytes altered(Bytes bytes, std::mt19937& random) {
  const std::uint64_t numbers[] = {0, 1, 0xFFFFFFFF, 0x7FFFFFFF7FFFFFFF, ~std::uint64_t{0}, 1000};
  for (unsigned times = 1 + random() % 4; times > 0; --times) {
    const std::size_t at = place_in(bytes.size(), random);
    if (random() % 2 == 0) {
      bytes[at] ^= static_cast<std::uint8_t>(1U << random() % 8);
    } else {
      const std::uint64_t number = numbers[random() % std::size(numbers)];
      std::memcpy(bytes.data() + at, &number, random() % 2 == 0 ? 4 : 8);
    }
  }
  return bytes;
}

/// How many of the altered states are taken; nothing may happen but that or an error.
template <typename Make>
int taken_of_altered(const Make& make, const Bytes& whole) {
  const char* seed = std::getenv("STRATA_FUZZ_SEED");
  std::mt19937 random(seed == nullptr ? 11 : static_cast<unsigned>(std::atol(seed)));
  int taken = 0;
  for (int i = 0; i < kMutations; ++i) {
    try {
      restore_and_go_on(altered(whole, random), make);
      ++taken;
    } catch (const Error&) {           // refused
    } catch (const std::bad_alloc&) {  // maps whose parts lie too far apart
    }
  }
  return taken;
}

TEST(SavedState, OfALearnerThatWasAlteredIsRefusedOrOfUse) {
  const auto learner = new_learner();
  for (int visit = 0; visit < 8; ++visit) {
    RandomStream random(3, StreamId::kTest, static_cast<std::uint64_t>(visit));
    std::vector<PosedScan> scans;
    patch::test_world::ToyRobot robot;
    robot.beams = 120;
    robot.drive(patch::test_world::corridor_with_door(visit % 2 == 0), {1.0, 1.2, 0.0},
                {10.0, 1.2, 0.0}, visit / 4, 100.0 * visit, {}, random, scans);
    for (PosedScan& scan : scans) (void)learner->add(std::move(scan));
  }
  ASSERT_FALSE(learner->map().submaps.empty()) << "else there is little to alter";
  EXPECT_GT(taken_of_altered(new_learner, learner->save_state()), 0);
}

TEST(SavedState, OfAFilterThatWasAlteredIsRefusedOrOfUse) {
  EXPECT_GT(taken_of_altered(new_filter, state_of(new_filter, Ahead::kOpening)), 0);
}

TEST(SavedState, OfASlamThatWasAlteredIsRefusedOrOfUse) {
  EXPECT_GT(taken_of_altered(new_slam, state_of(new_slam, Ahead::kWall)), 0);
}

}  // namespace
}  // namespace strata::fuzz
