/* SPDX-License-Identifier: Apache-2.0
 * What the files of cyclone_peer share. */
#ifndef CYCLONE_PEER_H
#define CYCLONE_PEER_H
#include "dds/dds.h"

extern dds_entity_t g_participant;
extern dds_entity_t g_waitset;
extern dds_entity_t g_end; /* triggers when standard input ends */

/* Ends the process with a message when `result` is an error. */
void require(dds_return_t result, const char* what);
/* Prints a line at once. */
void say(const char* line);
/* The topic of that wire name, with the type name that ROS 2 gives the descriptor's type. */
dds_entity_t make_topic(const dds_topic_descriptor_t* descriptor, const char* topic,
                        const char* wire_type);
dds_entity_t make_reader(dds_entity_t topic, bool latched, int depth);
dds_entity_t make_writer(dds_entity_t topic, bool latched);
/* Reliable; loses nothing. */
dds_entity_t make_keep_all_writer(dds_entity_t topic);
void attach(dds_entity_t reader, dds_attach_t tag);
/* The next message, lent; false when none is there. */
bool take(dds_entity_t reader, void** sample);
/* Says "ready", then gives every message to `use` until standard input ends. */
void use_all(dds_entity_t reader, void (*use)(const void* sample, void* context), void* context);

/* What every ROS 2 process makes besides ros_discovery_info, and a topic of scans; cyclone_ros.c. */
void make_ros_endpoints(void);
void publish_scans(int count, double hertz);
void hear_scans(int count);
void wait_for_input_to_end(void);

/* The ends of a service that a client has. */
struct Client {
  dds_entity_t writer;
  dds_entity_t reader;
};
/* Waits until it has found the service. */
struct Client open_client(const char* node, const char* package, const char* service,
                          const char* path, const dds_topic_descriptor_t* request_type,
                          const dds_topic_descriptor_t* reply_type);
/* Sends a request that begins with a client and a number, as rmw_cyclonedds does, and waits for the
 * reply that begins with them; it is lent. */
void* ask(const struct Client* client, const void* request);

/* The nodes that others announce, and a node that this peer does; is_long: a Gid has 24 bytes, not
 * 16. be_ros_node: with what every ROS 2 process of Cyclone has. See cyclone_graph.c. */
void print_nodes(bool is_long);
void announce_node(bool is_long, char* scope, char* name);
void be_ros_node(char* scope, char* name);

/* Topics as RViz, nav2 and the ros2 tools use them; see cyclone_topics.c. */
void use_topic(const char* name, char* topic, char** arguments);

/* What nav2's lifecycle manager does; see cyclone_manager.c. */
void manage(const char* name, char* node, char** arguments);

/* The services of rosbag2's player and recorder; see cyclone_bags.c. */
void call_bags(const char* name, char* node, char** arguments);

/* Calls the service `name` of `node` with what follows it in `arguments` (ends with NULL) and
 * prints the answer; an unknown name does nothing. */
void call_service(const char* name, char* node, char** arguments);
#endif
