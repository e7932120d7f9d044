// SPDX-License-Identifier: Apache-2.0
/// `strata site merge`: the active version, and in a region what another one learned.
#include <string>
#include <utility>
#include <vector>

#include "components/maps/earlier_runs.hpp"
#include "components/maps/learn_config.hpp"
#include "core/base/error.hpp"
#include "tools/pipeline/learn_within.hpp"
#include "tools/strata/learned_folder.hpp"
#include "tools/strata/site_actions.hpp"
#include "tools/strata/site_text.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {

void merge_version(const SiteOptions& options, VerbContext& context) {
  const pipeline::CostMeter meter;
  site::Site site = open_site(options, context);
  const site::VersionStatus version = site.find(options.version);
  const site::VersionStatus active = site.find("active");
  const auto config = read_config<maps::LearnConfig>(context);
  pipeline::LearnWithin limits;
  limits.only = pipeline::cells_of_region(site::read_region(options.region),
                                          config.slam.beam_filter.resolution_m, options.region);
  limits.forgets = options.anew;
  ResultDirectory out(options.out, "maps", context);
  for (const site::VersionStatus& one : {version, active}) {
    const std::string fault = site.fault_of(one.version.hash);
    if (!fault.empty()) throw InputError("version " + name_of(one), fault, "choose another one");
  }
  const std::filesystem::path base = site.maps_of(active.version.hash);
  limits.before = pipeline::read_base(base);
  maps::EarlierRuns earlier = maps::read_earlier_runs(base);
  maps::EarlierRuns other = maps::read_earlier_runs(site.maps_of(version.version.hash));
  const std::string log = other.log;
  auto runs = maps::new_runs(std::move(other), earlier);
  const std::size_t count = runs.size();
  if (count == 0) {
    throw InputError("version " + name_of(version),
                     "was learned from no run that the active one does not know",
                     "name a version that was learned from newer logs");
  }
  for (std::vector<PosedScan>& run : runs) maps::add_run(earlier, std::move(run));
  const pipeline::LearnResult result =
      pipeline::learn_within(limits, {}, {}, config, {}, context.options.seed,
                             context.options.threads, context.progress(), &earlier);
  for (const std::string& warning : result.slam.warnings) context.note("warning: " + warning);
  write_learned(out, result, {}, {log, earlier.map_from_truth, &meter, earlier.thinned}, context);
  const std::string what = "version " + name_of(active) + ", in " + options.region +
                           " with what version " + name_of(version) + " learned of " +
                           counted(count, "run");
  const std::string note = options.note.empty() ? what : options.note + "; " + what;
  const site::Site::Added added = site.add(options.out, actor(options), note);
  answer(options, context, "added version " + name_of(added.status) + " as a candidate: " + what,
         json_of(added.status));
}

}  // namespace strata::tools
