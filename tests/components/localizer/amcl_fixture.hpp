// SPDX-License-Identifier: Apache-2.0
/// A localizer that is given amcl's parameters.
#pragma once

#include <algorithm>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/localizer/amcl_parameters.hpp"
#include "components/localizer/config.hpp"
#include "components/runtime/composition.hpp"
#include "components/settings/config_reader.hpp"
#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

namespace strata::localizer {

using runtime::TranslatedParameter;
using Fate = TranslatedParameter::Fate;

/// Every parameter that nav2 Jazzy's amcl declares, with its default, in the words of nobody's
/// file.
inline constexpr const char* kDefaults = R"(amcl:
  ros__parameters:
    use_sim_time: False
    alpha1: 0.2
    alpha2: 0.2
    alpha3: 0.2
    alpha4: 0.2
    alpha5: 0.2
    always_reset_initial_pose: false
    base_frame_id: base_footprint
    beam_skip_distance: 0.5
    beam_skip_error_threshold: 0.9
    beam_skip_threshold: 0.3
    bond_heartbeat_period: 0.1
    do_beamskip: false
    first_map_only: false
    freespace_downsampling: false
    global_frame_id: map
    initial_pose: {x: 0.0, y: 0.0, z: 0.0, yaw: 0.0}
    lambda_short: 0.1
    laser_likelihood_max_dist: 2.0
    laser_max_range: 100.0
    laser_min_range: -1.0
    laser_model_type: likelihood_field
    map_topic: map
    max_beams: 60
    max_particles: 2000
    min_particles: 500
    odom_frame_id: odom
    pf_err: 0.05
    pf_z: 0.99
    recovery_alpha_fast: 0.0
    recovery_alpha_slow: 0.0
    resample_interval: 1
    robot_model_type: nav2_amcl::DifferentialMotionModel
    save_pose_rate: 0.5
    scan_topic: scan
    set_initial_pose: false
    sigma_hit: 0.2
    tf_broadcast: true
    transform_tolerance: 1.0
    update_min_a: 0.2
    update_min_d: 0.25
    z_hit: 0.5
    z_max: 0.05
    z_rand: 0.5
    z_short: 0.05
)";

class AmclParameters : public testing::Test {
 protected:
  /// A composition of one localizer with these parameters of its own.
  [[nodiscard]] runtime::Composition compose(const std::string& file,
                                             const std::string& own = "maps: M",
                                             const std::vector<std::string>& overrides = {},
                                             const std::string& name = "localizer") const {
    std::ofstream(folder_.path() / "c.yaml")
        << "version: 1\nprocesses:\n  - name: main\n    components:\n"
        << "      - {type: strata::Localizer, name: " << name << ", parameters: {" << own << "}}\n";
    std::ofstream(folder_.path() / "amcl.yaml") << file;
    return runtime::load_composition(folder_.path() / "c.yaml", overrides,
                                     folder_.path() / "amcl.yaml", {amcl_stand_in()});
  }
  [[nodiscard]] LocalizerComponentConfig read(
      const std::string& file, const std::string& own = "maps: M",
      const std::vector<std::string>& overrides = {}) const {
    return config_of(compose(file, own, overrides));
  }
  [[nodiscard]] static LocalizerComponentConfig config_of(const runtime::Composition& composition) {
    YAML::Node parameters = composition.processes[0].components[0].parameters;
    parameters.remove("use_sim_time");  // every component's
    return settings::read_config<LocalizerComponentConfig>(parameters, composition.place);
  }
  [[nodiscard]] std::string complaint(const std::string& parameters,
                                      const std::string& own = "maps: M") const {
    try {
      (void)read("amcl:\n  ros__parameters:\n" + parameters, own);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "no complaint";
  }
  /// One parameter, "sigma_hit: 0.1".
  [[nodiscard]] static std::string only(const std::string& parameter) {
    return "amcl:\n  ros__parameters: {" + parameter + "}\n";
  }
  static const TranslatedParameter* find(const runtime::Composition& composition,
                                         const std::string& name) {
    const auto& all = composition.processes[0].components[0].translated;
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == name; });
    return found == all.end() ? nullptr : &*found;
  }
  static std::vector<std::string> names_of(const runtime::Composition& composition, Fate fate) {
    std::set<std::string> names;
    for (const TranslatedParameter& one : composition.processes[0].components[0].translated) {
      if (one.fate == fate) names.insert(one.name);
    }
    return {names.begin(), names.end()};
  }
  [[nodiscard]] std::string folder() const { return folder_.path().string(); }

 private:
  strata::test::TemporaryDirectory folder_;
};

}  // namespace strata::localizer
