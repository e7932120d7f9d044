/* SPDX-License-Identifier: Apache-2.0 */
/* Processes as ROS 2 has them with rmw_cyclonedds: what every one of them makes at its start, and
 * the ends of a topic of scans that network_peer has too. */
#include "cyclone_peer.h"
#include "rcl_interfaces.h"
#include "sensor_msgs.h"
#include <stdio.h>
#include <stdlib.h>

enum { kBeams = 1080 };

void wait_for_input_to_end(void) {
  dds_attach_t tag;
  (void)dds_waitset_wait(g_waitset, &tag, 1, DDS_INFINITY);
}

void make_ros_endpoints(void) {
  const dds_entity_t events =
      make_topic(&rcl_interfaces_msg_ParameterEvent_desc, "rt/parameter_events",
                 "rcl_interfaces::msg::dds_::ParameterEvent_");
  (void)make_reader(events, false, 1000);
  (void)make_writer(events, false);
}

static dds_entity_t make_scan_topic(void) {
  return make_topic(&sensor_msgs_msg_LaserScan_desc, "rt/scan",
                    "sensor_msgs::msg::dds_::LaserScan_");
}

static void wait_for_match(dds_entity_t writer) {
  dds_publication_matched_status_t status;
  do {
    require(dds_get_publication_matched_status(writer, &status), "matched");
    if (status.current_count == 0) dds_sleepfor(DDS_MSECS(10));
  } while (status.current_count == 0);
}

void publish_scans(int count, double hertz) {
  const dds_entity_t writer = make_keep_all_writer(make_scan_topic());
  say("ready");
  wait_for_match(writer);
  sensor_msgs_msg_LaserScan scan = {0};
  static float ranges[kBeams];
  for (int i = 0; i < kBeams; ++i) ranges[i] = 1.0F;
  scan.header.frame_id = "";
  scan.ranges._length = scan.ranges._maximum = kBeams;
  scan.ranges._buffer = ranges;
  for (int i = 0; i < count; ++i) {
    scan.header.stamp.sec = i;
    require(dds_write(writer, &scan), "scan");
    dds_sleepfor((dds_duration_t)(1e9 / hertz));
  }
  say("done");
  wait_for_input_to_end();
}

struct Heard {
  int count;
  int heard;
  int in_order;
};

static void hear_scan(const void* sample, void* context) {
  struct Heard* so_far = context;
  const sensor_msgs_msg_LaserScan* scan = sample;
  const int number = scan->header.stamp.sec;
  if (number == so_far->heard && scan->ranges._length == kBeams) ++so_far->in_order;
  ++so_far->heard;
  if (number != so_far->count - 1) return;
  printf("heard %d of %d, %d in order\n", so_far->heard, so_far->count, so_far->in_order);
  fflush(stdout);
}

void hear_scans(int count) {
  /* Cyclone tells the writer of a match before it listens: what comes in between is asked for. */
  const dds_entity_t reader = make_reader(make_scan_topic(), true, 0);
  struct Heard so_far = {count, 0, 0};
  use_all(reader, hear_scan, &so_far);
}
