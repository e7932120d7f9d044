/* SPDX-License-Identifier: Apache-2.0 */
/* An independent DDS in a process of its own, with types that its own compiler made from our IDL.
 *
 *   cyclone_peer DOMAIN echo                 every message of rt/ask_<Type> goes back on
 *                                            rt/answer_<Type>, through Cyclone's own structs
 *   cyclone_peer DOMAIN best_effort          the same for rt/ask_best_effort (LaserScan) and
 *                                            rt/answer_best_effort, best effort both
 *   cyclone_peer DOMAIN nodes GID            prints "node NAMESPACE NAME" of what others announce;
 *                                            GID: the bytes of a Gid, 24 or 16
 *   cyclone_peer DOMAIN announce GID NAMESPACE NAME
 *                                            announces a node with one reader and two writers
 *   cyclone_peer DOMAIN ros_node NAMESPACE NAME
 *                                            has what every ROS 2 process of Cyclone has; prints as
 *                                            `nodes`
 *   cyclone_peer DOMAIN scans COUNT HZ       waits for a reader, publishes numbered scans, "done"
 *   cyclone_peer DOMAIN hear COUNT           "heard N of M, K in order" after scan M = COUNT - 1
 *   cyclone_peer DOMAIN USE TOPIC ...        reads or writes it; cyclone_topics.c
 *   cyclone_peer DOMAIN SERVICE NODE ...     calls it and prints what it answers; cyclone_services.c
 *
 * Says "ready" once everything is made; ends when its standard input does. */
#include "bond.h"
#include "cyclone_peer.h"
#include "diagnostic_msgs.h"
#include "geometry_msgs.h"
#include "lifecycle_msgs.h"
#include "nav2_msgs.h"
#include "nav_msgs.h"
#include "octomap_msgs.h"
#include "rcl_interfaces.h"
#include "rosgraph_msgs.h"
#include "sensor_msgs.h"
#include "std_msgs.h"
#include "strata_msgs.h"
#include "tf2_msgs.h"
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct Type {
  const char* package;
  const char* name;
  const dds_topic_descriptor_t* descriptor;
};
#define TYPE(package, name) \
  { #package, #name, &package##_msg_##name##_desc }
static const struct Type kTypes[] = {TYPE(diagnostic_msgs, DiagnosticArray),
                                     TYPE(geometry_msgs, PoseWithCovarianceStamped),
                                     TYPE(lifecycle_msgs, TransitionEvent),
                                     TYPE(nav2_msgs, CostmapFilterInfo),
                                     TYPE(nav2_msgs, ParticleCloud),
                                     TYPE(nav_msgs, OccupancyGrid),
                                     TYPE(nav_msgs, Odometry),
                                     TYPE(octomap_msgs, Octomap),
                                     TYPE(rcl_interfaces, Log),
                                     TYPE(rcl_interfaces, ParameterEvent),
                                     TYPE(rosgraph_msgs, Clock),
                                     TYPE(sensor_msgs, LaserScan),
                                     TYPE(tf2_msgs, TFMessage),
                                     TYPE(strata_msgs, Ack),
                                     TYPE(strata_msgs, LabeledScan),
                                     TYPE(strata_msgs, LocalizationHealth),
                                     TYPE(strata_msgs, NodeMap),
                                     TYPE(strata_msgs, PatchMap),
                                     TYPE(strata_msgs, ReflectionGrid),
                                     TYPE(strata_msgs, ScanPose),
                                     TYPE(strata_msgs, Step),
                                     TYPE(strata_msgs, SubmapStates),
                                     TYPE(strata_msgs, Trajectory),
                                     TYPE(sensor_msgs, PointCloud2),
                                     TYPE(geometry_msgs, PointStamped),
                                     TYPE(strata_msgs, Topologies),
                                     TYPE(sensor_msgs, Image),
                                     TYPE(sensor_msgs, CameraInfo),
                                     TYPE(bond, Status),
                                     TYPE(std_msgs, String)};
enum { kTypeCount = sizeof kTypes / sizeof kTypes[0] };

dds_entity_t g_participant;
dds_entity_t g_waitset;
dds_entity_t g_end;

void require(dds_return_t result, const char* what) {
  if (result >= 0) return;
  fprintf(stderr, "cyclone_peer: %s: %s\n", what, dds_strretcode(-result));
  exit(1);
}

void say(const char* line) {
  puts(line);
  fflush(stdout);
}

static void* wait_for_end(void* unused) {
  (void)unused;
  while (getchar() != EOF) {
  }
  dds_set_guardcondition(g_end, true);
  return NULL;
}

static dds_qos_t* make_qos(bool latched, int depth) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
  dds_qset_durability(qos, latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, depth > 0 ? DDS_HISTORY_KEEP_LAST : DDS_HISTORY_KEEP_ALL, depth);
  return qos;
}

/* The topic of that wire name, with the type name that ROS 2 gives the descriptor's type. */
dds_entity_t make_topic(const dds_topic_descriptor_t* descriptor, const char* topic,
                               const char* wire_type) {
  dds_topic_descriptor_t renamed = *descriptor;
  renamed.m_typename = wire_type;
  const dds_entity_t made = dds_create_topic(g_participant, &renamed, topic, NULL, NULL);
  require(made, topic);
  return made;
}

dds_entity_t make_reader(dds_entity_t topic, bool latched, int depth) {
  dds_qos_t* qos = make_qos(latched, depth);
  const dds_entity_t reader = dds_create_reader(g_participant, topic, qos, NULL);
  dds_delete_qos(qos);
  require(reader, "reader");
  return reader;
}

static dds_entity_t make_writer_with(dds_entity_t topic, bool latched, int depth) {
  dds_qos_t* qos = make_qos(latched, depth);
  const dds_entity_t writer = dds_create_writer(g_participant, topic, qos, NULL);
  dds_delete_qos(qos);
  require(writer, "writer");
  return writer;
}

dds_entity_t make_writer(dds_entity_t topic, bool latched) {
  return make_writer_with(topic, latched, latched ? 1 : 10);
}

dds_entity_t make_keep_all_writer(dds_entity_t topic) { return make_writer_with(topic, false, 0); }

void attach(dds_entity_t reader, dds_attach_t tag) {
  const dds_entity_t condition = dds_create_readcondition(reader, DDS_ANY_STATE);
  require(condition, "read condition");
  require(dds_waitset_attach(g_waitset, condition, tag), "attach");
}

/* The next message, lent; false when none is there. */
bool take(dds_entity_t reader, void** sample) {
  for (;;) {
    dds_sample_info_t info;
    *sample = NULL;
    if (dds_take(reader, sample, &info, 1, 1) <= 0) return false;
    if (info.valid_data) return true;
    dds_return_loan(reader, sample, 1);
  }
}

void use_all(dds_entity_t reader, void (*use)(const void* sample, void* context), void* context) {
  attach(reader, 0);
  say("ready");
  for (;;) {
    dds_attach_t tags[2];
    const int count = dds_waitset_wait(g_waitset, tags, 2, DDS_INFINITY);
    for (int i = 0; i < count; ++i) {
      if (tags[i] != 0) return;
    }
    void* sample = NULL;
    while (take(reader, &sample)) {
      use(sample, context);
      dds_return_loan(reader, &sample, 1);
    }
  }
}

static void echo(void) {
  dds_entity_t readers[kTypeCount];
  dds_entity_t writers[kTypeCount];
  for (int i = 0; i < kTypeCount; ++i) {
    char type[128];
    char ask[128];
    char answer[128];
    snprintf(type, sizeof type, "%s::msg::dds_::%s_", kTypes[i].package, kTypes[i].name);
    snprintf(ask, sizeof ask, "rt/ask_%s", kTypes[i].name);
    snprintf(answer, sizeof answer, "rt/answer_%s", kTypes[i].name);
    writers[i] = make_writer(make_topic(kTypes[i].descriptor, answer, type), true);
    readers[i] = make_reader(make_topic(kTypes[i].descriptor, ask, type), true, 1);
    attach(readers[i], i);
  }
  say("ready");
  for (;;) {
    dds_attach_t tags[kTypeCount + 1];
    const int count = dds_waitset_wait(g_waitset, tags, kTypeCount + 1, DDS_INFINITY);
    for (int i = 0; i < count; ++i) {
      if (tags[i] >= kTypeCount) return;
      void* sample = NULL;
      while (take(readers[tags[i]], &sample)) {
        require(dds_write(writers[tags[i]], sample), kTypes[tags[i]].name);
        dds_return_loan(readers[tags[i]], &sample, 1);
        printf("echoed %s\n", kTypes[tags[i]].name);
        fflush(stdout);
      }
    }
  }
}

static void answer(const void* sample, void* writer) {
  require(dds_write(*(const dds_entity_t*)writer, sample), "best effort");
}

/* Best effort as sensors are, which a reliable endpoint of the other side may not be. */
static void echo_best_effort(void) {
  const char* const type = "sensor_msgs::msg::dds_::LaserScan_";
  dds_qos_t* qos = make_qos(false, 5);
  dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
  const dds_entity_t writer = dds_create_writer(
      g_participant, make_topic(&sensor_msgs_msg_LaserScan_desc, "rt/answer_best_effort", type), qos,
      NULL);
  const dds_entity_t reader = dds_create_reader(
      g_participant, make_topic(&sensor_msgs_msg_LaserScan_desc, "rt/ask_best_effort", type), qos,
      NULL);
  dds_delete_qos(qos);
  require(writer, "best-effort writer");
  require(reader, "best-effort reader");
  use_all(reader, answer, (void*)&writer);
}

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  g_participant = dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL);
  require(g_participant, "participant");
  g_waitset = dds_create_waitset(g_participant);
  g_end = dds_create_guardcondition(g_participant);
  require(dds_waitset_attach(g_waitset, g_end, 1000), "attach");
  pthread_t thread;
  if (pthread_create(&thread, NULL, wait_for_end, NULL) != 0) return 1;
  (void)pthread_detach(thread);
  if (strcmp(argv[2], "echo") == 0) echo();
  if (strcmp(argv[2], "best_effort") == 0) echo_best_effort();
  const bool is_long = argc >= 4 && strcmp(argv[3], "24") == 0;
  if (strcmp(argv[2], "nodes") == 0) print_nodes(is_long);
  if (strcmp(argv[2], "announce") == 0 && argc >= 6) announce_node(is_long, argv[4], argv[5]);
  if (strcmp(argv[2], "ros_node") == 0 && argc >= 5) be_ros_node(argv[3], argv[4]);
  if (strcmp(argv[2], "scans") == 0 && argc >= 5) publish_scans(atoi(argv[3]), atof(argv[4]));
  if (strcmp(argv[2], "hear") == 0 && argc >= 4) hear_scans(atoi(argv[3]));
  if (argc >= 4) use_topic(argv[2], argv[3], argv + 4);
  if (argc >= 4) call_service(argv[2], argv[3], argv + 4);
  dds_delete(g_participant);
  fflush(stdout);
  return 0;
}
