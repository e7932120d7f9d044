// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/paper/em_textures.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

#include <unistd.h>

#include "components/log/log_writer.hpp"
#include "core/base/error.hpp"
#include "tools/pipeline/volume.hpp"
#include "tools/report/volume_picture.hpp"
#include "tools/simulate/scenario.hpp"
#include "tools/simulate/simulation.hpp"
#include "tools/simulate/space_log.hpp"
#include "tools/textures/glb.hpp"

namespace strata::paper {
namespace {

namespace fs = std::filesystem;

constexpr double kCeiling_m = 2.3;

/// Simulated people are magenta, and nothing else is.
bool is_person(const volume::Rgb& color) { return color.r > color.g + 100; }

/// A bag that lives as long as this.
class SimulatedBag {
 public:
  SimulatedBag(const Setting& setting, std::uint64_t seed)
      : folder_(fs::temp_directory_path() / ("strata_em_1_10_" + std::to_string(getpid()))) {
    const simulate::Simulation simulation = simulate::simulate(
        simulate::load_scenario((setting.scenarios / "room_people_3d.yaml").string()), seed);
    log::LogContent content;
    for (const simulate::SimulatedScan& scan : simulation.days.front().scans) {
      content.observations.push_back(scan.observation);
    }
    fs::create_directories(folder_);
    log::write_bag(folder_ / "bag", content, {}, simulate::space_messages(simulation, 0, 1));
  }
  ~SimulatedBag() {
    std::error_code error;
    fs::remove_all(folder_, error);
  }
  SimulatedBag(const SimulatedBag&) = delete;
  SimulatedBag& operator=(const SimulatedBag&) = delete;
  [[nodiscard]] fs::path path() const { return folder_ / "bag"; }

 private:
  fs::path folder_;
};

struct Model {
  textures::TexturedMesh mesh;
  std::size_t voxels = 0;         ///< occupied
  std::size_t person_voxels = 0;  ///< ... in the colour of people
  std::size_t person_texels = 0;
};

Model model_of(const fs::path& bag, bool is_filtered, int threads) {
  pipeline::VolumeJobConfig config;
  config.has_textures = true;
  if (!is_filtered) {
    config.moving = pipeline::MovingKind::kNone;
    // No beam speaks against a picture, which the most frontal one wins then.
    config.colors.margin_m = 0.0;
    config.colors.min_static = 0.0;
  }
  pipeline::VolumeResult result = pipeline::make_volume(bag, "", config, threads, nullptr);
  if (!result.mesh) throw InputError(bag.string(), "has no pictures", "report this");
  Model model;
  const auto& voxels = result.colors->voxels();
  model.voxels = voxels.size();
  model.person_voxels = static_cast<std::size_t>(
      std::count_if(voxels.begin(), voxels.end(),
                    [](const volume::ColoredVoxel& voxel) { return is_person(voxel.color); }));
  model.mesh = std::move(*result.mesh);
  model.person_texels = static_cast<std::size_t>(
      std::count_if(model.mesh.texture.pixels.begin(), model.mesh.texture.pixels.end(), is_person));
  return model;
}

Picture draw(const Model& model, const std::string& name, const std::string& caption) {
  const auto cubes = textures::texel_cubes(model.mesh, kCeiling_m);
  const auto view =
      report::view_from_outside(cubes, -0.75 * std::numbers::pi, 0.25 * std::numbers::pi, 1000);
  return {name, caption, report::encode_png(report::draw_cubes(cubes, view))};
}

}  // namespace

Outcome textured_rooms(const Setting& setting) {
  const int seeds = setting.seeds_or(2);
  Model with;
  Model without;
  std::size_t polygons = 0;
  std::size_t texels = 0;
  std::size_t seen = 0;
  std::size_t in_polygons = 0;
  std::vector<Picture> pictures;
  const auto add = [](Model& sum, const Model& one) {
    sum.voxels += one.voxels;
    sum.person_voxels += one.person_voxels;
    sum.person_texels += one.person_texels;
  };
  for (int i = 0; i < seeds; ++i) {
    const SimulatedBag bag(setting, setting.seed(i));
    const Model filtered = model_of(bag.path(), true, setting.threads);
    const Model raw = model_of(bag.path(), false, setting.threads);
    add(with, filtered);
    add(without, raw);
    polygons += filtered.mesh.polygons.size();
    texels += filtered.mesh.texels;
    seen += filtered.mesh.seen;
    in_polygons += filtered.mesh.voxels;
    if (i > 0) continue;
    pictures = {draw(raw, "em-1.10_without", "without filtering; people are magenta"),
                draw(filtered, "em-1.10_with", "with filtering")};
  }
  const auto real = [](std::size_t count) { return static_cast<double>(count); };
  const double flat = real(in_polygons) / real(with.voxels);
  const bool is_clean = 1000 * with.person_texels <= seen && without.person_texels > 0 &&
                        10 * with.person_texels <= without.person_texels;
  return judged(is_clean && flat >= 0.8,
                is_clean ? "too much of the map is in no polygon"
                         : "people are left in the textures, or none were there before",
                {{"seeds", {}, static_cast<double>(seeds), 0},
                 {"polygons", {}, real(polygons), 0},
                 {"share of occupied voxels in them", {}, flat, 3},
                 {"texels", {}, real(texels), 0},
                 {"texels that a picture showed", {}, real(seen), 0},
                 {"of them people", {}, real(with.person_texels), 0},
                 {"texels that show people without filtering", {}, real(without.person_texels), 0},
                 {"voxels in the colour of people", {}, real(with.person_voxels), 0},
                 {"the same without filtering", {}, real(without.person_voxels), 0}},
                std::move(pictures));
}

}  // namespace strata::paper
