// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/learned_folder.hpp"

#include "components/maps/maps_folder.hpp"
#include "tools/pipeline/learn_pictures.hpp"
#include "tools/strata/warning.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {

nlohmann::json write_learned(
    ResultDirectory& out, const pipeline::LearnResult& result, const pipeline::LearnParts& parts,
    const LearnedFrom& from, VerbContext& context,
    const std::function<void(const std::filesystem::path&, report::Drawings&)>& draw_more) {
  maps::write_grid_maps(out.path(), result.slam);
  if (parts.patch) maps::write_patch_map(out.path(), result.patches);
  if (parts.timescale) maps::write_timescale(out.path(), *result.timescale);
  maps::write_thinned_runs(out.path(), from.thinned);
  if (result.forgotten_scans > 0) {
    context.note("forgot " + counted(result.forgotten_scans, "scan") +
                 " of earlier runs, of places that have many passes (history.passes_per_place)");
  }
  report::Drawings drawings;
  pipeline::write_map_pictures(out.path(), result.slam, result.patches, drawings);
  if (draw_more) draw_more(out.path(), drawings);
  if (from.map_from_truth) maps::write_map_from_truth(out.path(), *from.map_from_truth);
  const pipeline::Cost cost = from.meter->read();
  nlohmann::json summary = maps::write_summary(
      out.path(), from.logs, {cost.wall_s, cost.cpu_s, cost.peak_rss_mb}, from.reading);
  out.commit();
  warn(context, drawings.what_is_missing());
  return summary;
}

}  // namespace strata::tools
