/* SPDX-License-Identifier: Apache-2.0 */
/* ROS 2's graph: what others announce on ros_discovery_info, and what this peer does. */
#include "cyclone_peer.h"
#include "rmw_dds_common.h"
#include "rmw_dds_common_24.h"
#include <stdio.h>
#include <string.h>

/* The graph's message has one name and two layouts. */
#define GRAPH(package)                                                                       \
  static void print_nodes_of_##package(const void* sample, void* unused) {                   \
    (void)unused;                                                                            \
    const package##_msg_ParticipantEntitiesInfo* info = sample;                              \
    for (uint32_t i = 0; i < info->node_entities_info_seq._length; ++i) {                    \
      const package##_msg_NodeEntitiesInfo* node = &info->node_entities_info_seq._buffer[i]; \
      printf("node %s %s\n", node->node_namespace, node->node_name);                         \
    }                                                                                        \
    fflush(stdout);                                                                          \
  }                                                                                          \
  static void announce_in_##package(dds_entity_t writer, char* scope, char* name) {          \
    dds_guid_t own;                                                                          \
    require(dds_get_guid(g_participant, &own), "guid");                                      \
    package##_msg_Gid gids[2];                                                               \
    memset(gids, 0, sizeof gids);                                                            \
    for (int i = 0; i < 2; ++i) {                                                            \
      memcpy(gids[i].data, own.v, sizeof own.v);                                             \
      gids[i].data[15] = (uint8_t)(i + 1);                                                   \
    }                                                                                        \
    package##_msg_NodeEntitiesInfo node;                                                     \
    memset(&node, 0, sizeof node);                                                           \
    node.node_namespace = scope;                                                             \
    node.node_name = name;                                                                   \
    node.reader_gid_seq._length = node.reader_gid_seq._maximum = 1;                          \
    node.reader_gid_seq._buffer = gids;                                                      \
    node.writer_gid_seq._length = node.writer_gid_seq._maximum = 2;                          \
    node.writer_gid_seq._buffer = gids;                                                      \
    package##_msg_ParticipantEntitiesInfo info;                                              \
    memset(&info, 0, sizeof info);                                                           \
    memcpy(info.gid.data, own.v, sizeof own.v);                                              \
    info.node_entities_info_seq._length = info.node_entities_info_seq._maximum = 1;          \
    info.node_entities_info_seq._buffer = &node;                                             \
    require(dds_write(writer, &info), "announce");                                           \
  }
GRAPH(rmw_dds_common)
GRAPH(rmw_dds_common_24)

static dds_entity_t make_graph_topic(bool is_long) {
  return make_topic(is_long ? &rmw_dds_common_24_msg_ParticipantEntitiesInfo_desc
                            : &rmw_dds_common_msg_ParticipantEntitiesInfo_desc,
                    "ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_");
}

static void print_nodes_of(dds_entity_t reader, bool is_long) {
  use_all(reader, is_long ? print_nodes_of_rmw_dds_common_24 : print_nodes_of_rmw_dds_common,
          NULL);
}

void print_nodes(bool is_long) {
  print_nodes_of(make_reader(make_graph_topic(is_long), true, 0), is_long);
}

void announce_node(bool is_long, char* scope, char* name) {
  const dds_entity_t writer = make_writer(make_graph_topic(is_long), true);
  (is_long ? announce_in_rmw_dds_common_24 : announce_in_rmw_dds_common)(writer, scope, name);
  say("ready");
  wait_for_input_to_end();
}

void be_ros_node(char* scope, char* name) {
  const dds_entity_t topic = make_graph_topic(false);
  const dds_entity_t reader = make_reader(topic, true, 0);
  const dds_entity_t writer = make_writer(topic, true);
  make_ros_endpoints();
  announce_in_rmw_dds_common(writer, scope, name);
  print_nodes_of(reader, false);
}
