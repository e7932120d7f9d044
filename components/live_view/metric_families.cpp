// SPDX-License-Identifier: Apache-2.0
#include "components/live_view/metric_families.hpp"

namespace strata::live_view {
namespace {

using enum MetricType;
using enum FigureKind;

constexpr MetricFamily kFamilies[] = {
    // Localization.
    {"strata_localization_score", kGauge, "", "",
     "Probability that the pose is within 0.5 m of the truth, 0 to 1 (VDA 5050: "
     "localizationScore)."},
    {"strata_localization_localized", kGauge, "", "",
     "1 while the pose can be trusted, else 0 (VDA 5050: localized)."},
    {"strata_localization_verdict", kGauge, "", "verdict",
     "1 for the verdict that the localizer has now, 0 for the others."},
    {"strata_localization_ambiguous", kGauge, "", "",
     "1 while several places are possible or the one left is not confirmed, else 0."},
    {"strata_localization_places", kGauge, "", "",
     "Places that are still possible while several "
     "are."},
    {"strata_localization_recovering", kGauge, "", "",
     "1 while the pose is doubted and the robot is looked for elsewhere too, else 0."},
    {"strata_localization_deviation_range_meters", kGauge, "meters", "",
     "The robot is within this distance of the pose with 95% or more, by the filter's covariance "
     "(VDA 5050: deviationRange)."},
    {"strata_localization_position_stddev_meters", kGauge, "meters", "",
     "Standard deviation of the position."},
    {"strata_localization_heading_stddev_radians", kGauge, "radians", "",
     "Standard deviation of the heading."},
    {"strata_localization_explained_ratio", kGauge, "ratio", "",
     "Share of the judged beams that the map explains."},
    {"strata_localization_judged_ratio", kGauge, "ratio", "",
     "Share of the beams that the map says something about."},
    {"strata_localization_particles", kGauge, "", "", "Particles of the filter."},
    {"strata_localization_update_seconds", kHistogram, "seconds", "",
     "How long the filter worked on a scan."},
    {"strata_localization_map", kInfo, "", "model, maps, sha256",
     "The map model, the MAPS folder it is from, and the SHA-256 of what that holds; \"topics\" "
     "and none where maps come by topics."},
    {"strata_localization_maps_taken", kCounter, "", "", "Maps that it began to localize in."},
    // What is learned.
    {"strata_learned_areas", kGauge, "", "", "Changeable areas in the patch map."},
    {"strata_learned_sequences", kGauge, "", "",
     "Sequences of scans that the areas are learned "
     "from."},
    {"strata_learned_forgotten_configurations", kCounter, "", "",
     "Configurations of areas that were forgotten to stay within the memory."},
    {"strata_learned_memory_bytes", kGauge, "bytes", "", "What the patch learner keeps in memory."},
    {"strata_timescale_nodes", kGauge, "", "", "Nodes of the timescale memory."},
    {"strata_timescale_resident_nodes", kGauge, "", "", "Nodes of it that are in memory."},
    {"strata_timescale_observations", kCounter, "", "",
     "Scans taken by all of its nodes together."},
    {"strata_kept_scans", kGauge, "", "", "Scans that a mapper or a learner keeps."},
    {"strata_topologies", kGauge, "", "", "Topologies that are still possible."},
    {"strata_topology_landmarks", kGauge, "", "", "Landmarks of the likeliest topology."},
    {"strata_topology_probability", kGauge, "", "", "Probability of the likeliest topology."},
    {"strata_store_bytes", kGauge, "bytes", "",
     "What a component keeps on the disk, to go on from after a restart or as incidents."},
    {"strata_incidents", kCounter, "", "", "Incidents kept since the start."},
    {"strata_incident_memory_bytes", kGauge, "bytes", "",
     "What the incident recorder keeps in memory."},
    {"strata_incident_messages_gone_early", kCounter, "", "",
     "Messages that it gave up before their time, to stay within its memory."},
    // Every component.
    {"strata_component_up", kGauge, "", "",
     "1 while the component's status comes, 0 when none came for 15 s."},
    {"strata_component_level", kGauge, "", "",
     "The status' level: 0 ok, 1 warning, 2 error, 3 stale."},
    {"strata_component_active", kGauge, "", "", "1 while it is active in its lifecycle, else 0."},
    {"strata_component_messages_processed", kCounter, "", "", "Messages worked on."},
    {"strata_component_failures", kCounter, "", "",
     "What went wrong, messages and all else; what was undecodable is among it."},
    {"strata_component_messages_left_out", kCounter, "", "reason", "Messages not used, by reason."},
    {"strata_component_requests", kCounter, "", "", "Service requests that came."},
    {"strata_component_requests_dropped", kCounter, "", "",
     "Service requests that were not answered since too many waited."},
    {"strata_component_caught_errors", kCounter, "", "",
     "Errors in the middleware's and the executor's threads of the process."},
    {"strata_component_work_seconds", kHistogram, "seconds", "topic",
     "How long a message of the topic was worked on."},
    {"strata_component_latency_seconds", kHistogram, "seconds", "topic",
     "From when a message was written to when it was worked on; by the clocks of both hosts, "
     "latched topics left out."},
    {"strata_topic_received_messages", kCounter, "", "topic",
     "Messages that the component received."},
    {"strata_topic_lost_messages", kCounter, "", "topic",
     "Messages that never came, by gaps in the writers' numbers: lost by DDS or overwritten."},
    {"strata_topic_published_messages", kCounter, "", "topic",
     "Messages that the component published."},
    {"strata_process_resident_memory_bytes", kGauge, "bytes", "",
     "Resident memory of the process that the component is in."},
    // The live view itself.
    {"strata_view_viewers", kGauge, "", "", "Viewers that are connected."},
    {"strata_view_messages_sent", kCounter, "", "", "Messages sent to viewers."},
    {"strata_view_messages_left_out", kCounter, "", "", "Messages that a viewer was too slow for."},
    {"strata_view_requests_refused", kCounter, "", "",
     "What viewers sent and was not understood or not allowed."},
    // The process that answers, by the names that every exporter has.
    {"process_resident_memory_bytes", kGauge, "bytes", "", "Resident memory of this process."},
    {"process_cpu_seconds", kCounter, "seconds", "", "CPU time of this process."},
    {"process_open_fds", kGauge, "", "", "Open files of this process."},
};

constexpr std::string_view kLeftOut = "strata_component_messages_left_out";

constexpr StatusFigure kFigures[] = {
    {"localizationScore", "strata_localization_score"},
    {"localized", "strata_localization_localized", kTruth},
    {"ambiguous", "strata_localization_ambiguous", kTruth},
    {"places", "strata_localization_places"},
    {"recovering", "strata_localization_recovering", kTruth},
    {"deviationRange", "strata_localization_deviation_range_meters"},
    {"position_std_m", "strata_localization_position_stddev_meters"},
    {"heading_std_rad", "strata_localization_heading_stddev_radians"},
    {"explained_share", "strata_localization_explained_ratio"},
    {"judged_share", "strata_localization_judged_ratio"},
    {"particles", "strata_localization_particles"},
    {"update times", "strata_localization_update_seconds", kTimes},
    {"maps taken", "strata_localization_maps_taken"},
    {"sub-maps", "strata_learned_areas"},
    {"sequences kept", "strata_learned_sequences"},
    {"configurations forgotten", "strata_learned_forgotten_configurations"},
    {"bytes", "strata_learned_memory_bytes"},
    {"nodes", "strata_timescale_nodes"},
    {"nodes in RAM", "strata_timescale_resident_nodes"},
    {"observations", "strata_timescale_observations"},
    {"scans kept", "strata_kept_scans"},
    {"topologies", "strata_topologies"},
    {"landmarks of the likeliest", "strata_topology_landmarks"},
    {"probability of the likeliest", "strata_topology_probability"},
    {"store_bytes", "strata_store_bytes"},
    {"incidents", "strata_incidents"},
    {"kept in memory, MB", "strata_incident_memory_bytes", kNumber, "", "", 1e6},
    {"gone before their time", "strata_incident_messages_gone_early"},
    {"processed", "strata_component_messages_processed"},
    {"skipped", "strata_component_failures"},
    {"dropped", kLeftOut, kNumber, "reason", "too_busy"},
    {"undecodable", kLeftOut, kNumber, "reason", "undecodable"},
    {"came while inactive", kLeftOut, kNumber, "reason", "inactive"},
    {"scans without odometry near them", kLeftOut, kNumber, "reason", "scan_without_odometry"},
    {"scans that came too late", kLeftOut, kNumber, "reason", "scan_too_late"},
    {"transforms that are not finite", kLeftOut, kNumber, "reason", "transform_not_finite"},
    {"odometry that is not finite", kLeftOut, kNumber, "reason", "odometry_not_finite"},
    {"clouds without pose", kLeftOut, kNumber, "reason", "cloud_without_pose"},
    {"scans without a map", kLeftOut, kNumber, "reason", "scan_without_map"},
    {"scans left out", kLeftOut, kNumber, "reason", "scan_not_tracked"},
    {"lost on a full disk", kLeftOut, kNumber, "reason", "disk_full"},
    {"messages left out", kLeftOut, kNumber, "reason", "not_in_the_log"},
    {"requests", "strata_component_requests"},
    {"dropped requests", "strata_component_requests_dropped"},
    {"caught", "strata_component_caught_errors"},
    {"work times ", "strata_component_work_seconds", kTopicTimes},
    {"latencies ", "strata_component_latency_seconds", kTopicTimes},
    {"received ", "strata_topic_received_messages", kTopicNumber},
    {"lost ", "strata_topic_lost_messages", kTopicNumber},
    {"published ", "strata_topic_published_messages", kTopicNumber},
    {"process_memory_bytes", "strata_process_resident_memory_bytes"},
    {"viewers", "strata_view_viewers"},
    {"messages_sent", "strata_view_messages_sent"},
    {"messages_left_out", "strata_view_messages_left_out"},
    {"requests_refused", "strata_view_requests_refused"},
};

}  // namespace

std::string_view type_name(MetricType type) {
  switch (type) {
    case kCounter:
      return "counter";
    case kHistogram:
      return "histogram";
    case kInfo:
      return "info";
    case kGauge:
      break;
  }
  return "gauge";
}

std::string_view suffix_of(MetricType type) {
  if (type == kCounter) return "_total";
  if (type == kInfo) return "_info";
  return "";
}

std::span<const MetricFamily> metric_families() { return kFamilies; }
std::span<const StatusFigure> status_figures() { return kFigures; }

}  // namespace strata::live_view
