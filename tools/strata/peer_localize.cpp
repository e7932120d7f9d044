// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/peer_localize.hpp"

#include <atomic>
#include <filesystem>
#include <memory>

#include "core/base/error.hpp"
#include "tools/laboratory/peers/peer_job.hpp"

namespace strata::tools {
namespace {

peers::PeerJob job_of(const pipeline::LocalizeJob& given, const ReflectionGrid& map) {
  peers::PeerJob job;
  job.map = peers::peer_map(map);
  for (std::size_t i = 0; i < given.observations.size(); ++i) {
    if (!given.observations[i].has_odometry) {
      throw InputError("--peers", "the log has scans without odometry, which peers need",
                       "leave out --peers");
    }
    job.scans.push_back(peers::peer_scan(given.observations[i], given.truths[i]));
  }
  job.start = given.start;
  job.seed = given.seed;
  job.particles = static_cast<std::size_t>(given.config.particles);
  return job;
}

pipeline::LocalizationRun run_of(const peers::PeerResult& result,
                                 std::span<const Observation> observations) {
  pipeline::LocalizationRun run;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Stamp stamp = observations[i].scan.stamp;
    run.trajectory.push_back({stamp, result.estimates[i]});
    if (result.errors_m[i]) {
      run.errors.push_back({stamp, *result.errors_m[i], result.errors_rad[i].value_or(0.0)});
    }
  }
  run.update_ms = result.update_ms;
  return run;
}

}  // namespace

std::vector<pipeline::Peer> peers_of_this_build(VerbContext& context, const std::string& out) {
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "strata-peer-mrpt";
  if (!std::filesystem::exists(program)) {
    throw ConfigError("--peers", "no peer was built beside this program",
                      "run tools/install-packages --peers and build again");
  }
  // Several at once, each with its own files.
  const auto runs = std::make_shared<std::atomic<int>>(0);
  pipeline::Peer mrpt;
  mrpt.name = "peer_mrpt";
  mrpt.localize = [&context, out, program, runs](const pipeline::LocalizeJob& job,
                                                 const ReflectionGrid& map) {
    // Never committed: it goes away with the run.
    const OutputDirectory folder(out + "_peer" + std::to_string((*runs)++), context.staged());
    return run_of(peers::run_peer(program, job_of(job, map), folder.path()), job.observations);
  };
  return {mrpt};
}

}  // namespace strata::tools
