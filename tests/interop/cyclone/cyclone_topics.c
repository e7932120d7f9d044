/* SPDX-License-Identifier: Apache-2.0
 * Topics as others on a robot use them:
 *
 *   late_pose TOPIC           reads it as nav2_simple_commander does, transient local: "pose X Y"
 *   set_pose TOPIC X Y        writes it once as RViz does, volatile: "sent"
 *   filter_info TOPIC         reads it as nav2's costmap filters do: "info TYPE TOPIC BASE
 * MULTIPLIER FRAME" mask TOPIC                reads the mask that they follow: "mask WIDTH HEIGHT
 * CELLS GREATEST" with the number of cells above 0 rosout TOPIC              reads the log as `ros2
 * topic echo` does: "log LEVEL NAME TEXT"
 *
 * The readers go on until their input ends. */
#include "cyclone_peer.h"
#include "geometry_msgs.h"
#include "nav2_msgs.h"
#include "nav_msgs.h"
#include "rcl_interfaces.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char* const kPoseType = "geometry_msgs::msg::dds_::PoseWithCovarianceStamped_";

static void print_pose(const void* sample, void* unused) {
  (void)unused;
  const geometry_msgs_msg_PoseWithCovarianceStamped* message = sample;
  printf("pose %.3f %.3f\n", message->pose.pose.position.x, message->pose.pose.position.y);
  fflush(stdout);
}

static void print_info(const void* sample, void* unused) {
  (void)unused;
  const nav2_msgs_msg_CostmapFilterInfo* info = sample;
  printf("info %d %s %.3f %.3f %s\n", info->type, info->filter_mask_topic, (double)info->base,
         (double)info->multiplier, info->header.frame_id);
  fflush(stdout);
}

static void print_mask(const void* sample, void* unused) {
  (void)unused;
  const nav_msgs_msg_OccupancyGrid* mask = sample;
  unsigned cells = 0;
  int greatest = -1;
  for (uint32_t i = 0; i < mask->data._length; ++i) {
    const int value = (signed char)mask->data._buffer[i];
    if (value > 0) ++cells;
    if (value > greatest) greatest = value;
  }
  printf("mask %u %u %u %d\n", mask->info.width, mask->info.height, cells, greatest);
  fflush(stdout);
}

static void print_log(const void* sample, void* unused) {
  (void)unused;
  const rcl_interfaces_msg_Log* log = sample;
  printf("log %d %s %s\n", log->level, log->name, log->msg);
  fflush(stdout);
}

static void set_pose(const char* topic, char** arguments) {
  const dds_entity_t writer = make_writer(
      make_topic(&geometry_msgs_msg_PoseWithCovarianceStamped_desc, topic, kPoseType), false);
  const dds_entity_t waitset = dds_create_waitset(g_participant);
  require(dds_set_status_mask(writer, DDS_PUBLICATION_MATCHED_STATUS), "mask");
  require(dds_waitset_attach(waitset, writer, 1), "attach");
  require(dds_waitset_attach(waitset, g_end, 2), "attach");
  dds_attach_t tag = 0;
  require(dds_waitset_wait(waitset, &tag, 1, DDS_INFINITY), "match");
  if (tag != 1) return;
  geometry_msgs_msg_PoseWithCovarianceStamped pose;
  memset(&pose, 0, sizeof pose);
  pose.header.frame_id = "map";
  pose.pose.pose.position.x = atof(arguments[0]);
  pose.pose.pose.position.y = atof(arguments[1]);
  pose.pose.pose.orientation.w = 1.0;
  require(dds_write(writer, &pose), "pose");
  require(dds_wait_for_acks(writer, DDS_SECS(20)), "acknowledgment");
  say("sent");
}

void use_topic(const char* name, char* topic, char** arguments) {
  if (strcmp(name, "late_pose") == 0) {
    const dds_entity_t pose =
        make_topic(&geometry_msgs_msg_PoseWithCovarianceStamped_desc, topic, kPoseType);
    use_all(make_reader(pose, true, 1), print_pose, NULL);
  } else if (strcmp(name, "set_pose") == 0) {
    set_pose(topic, arguments);
  } else if (strcmp(name, "filter_info") == 0) {
    const dds_entity_t info = make_topic(&nav2_msgs_msg_CostmapFilterInfo_desc, topic,
                                         "nav2_msgs::msg::dds_::CostmapFilterInfo_");
    use_all(make_reader(info, true, 1), print_info, NULL);
  } else if (strcmp(name, "mask") == 0) {
    const dds_entity_t mask =
        make_topic(&nav_msgs_msg_OccupancyGrid_desc, topic, "nav_msgs::msg::dds_::OccupancyGrid_");
    use_all(make_reader(mask, true, 3), print_mask, NULL);
  } else if (strcmp(name, "rosout") == 0) {
    const dds_entity_t log =
        make_topic(&rcl_interfaces_msg_Log_desc, topic, "rcl_interfaces::msg::dds_::Log_");
    use_all(make_reader(log, true, 1000), print_log, NULL);
  }
}
