/* SPDX-License-Identifier: Apache-2.0
 * Service calls as rmw_cyclonedds makes them:
 *
 *   change_state NODE ID                     success 0|1
 *   get_state NODE                           state ID LABEL
 *   get_state_twice NODE                     the same, and "again" when the answer comes once more
 *   time_get_state NODE COUNT                took MS MS ..., of so many calls
 *   get_available_states NODE                states COUNT FIRST
 *   get_available_transitions NODE           transitions COUNT FIRST
 *   list_parameters NODE                     parameter NAME, one a line, then "parameters COUNT"
 *   get_parameter NODE NAME                  value TYPE STRING INTEGER DOUBLE
 *   get_parameter_type NODE NAME             type TYPE
 *   describe_parameter NODE NAME             descriptor NAME TYPE FROM TO
 *   set_parameter NODE NAME DOUBLE           set 0|1 REASON
 *   set_parameter_atomically NODE NAME DOUBLE
 *   load_map NODE URL                        loaded RESULT WIDTH HEIGHT
 *   get_map NODE                             map WIDTH HEIGHT FRAME
 *   save_map NODE TOPIC URL                  saved 0|1
 *   set_initial_pose NAMESPACE X Y           posed
 *   empty NAMESPACE SERVICE                  done
 * those of cyclone_bags.c:
 *   pause, resume, toggle_paused NODE        done
 *   split_bagfile NODE                       done
 *   is_paused NODE                           paused 0|1
 *   get_rate NODE                            rate RATE
 *   set_rate NODE RATE                       success 0|1
 *   seek NODE SECONDS                        success 0|1
 *   play_next NODE                           success 0|1
 * and those of cyclone_manager.c. Each says "made" when its ends are there and "ready" when it has
 * found those of the service. */
#include "cyclone_call.h"
#include "cyclone_map_requests.h"
#include "cyclone_peer.h"
#include "cyclone_requests.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Whether two messages begin with the same client and number: rmw_cyclonedds passes over replies to
 * others, which every client of a topic sees. */
static bool same_call(const void* request, const void* reply) {
  return memcmp(request, reply, 2 * sizeof(uint64_t)) == 0;
}

struct Client open_client(const char* node, const char* package, const char* service,
                          const char* path, const dds_topic_descriptor_t* request_type,
                          const dds_topic_descriptor_t* reply_type) {
  struct Client client;
  char topic[256];
  char type[256];
  snprintf(topic, sizeof topic, "rq%s/%sRequest", node, path);
  snprintf(type, sizeof type, "%s::srv::dds_::%s_Request_", package, service);
  client.writer = make_writer(make_topic(request_type, topic, type), false);
  snprintf(topic, sizeof topic, "rr%s/%sReply", node, path);
  snprintf(type, sizeof type, "%s::srv::dds_::%s_Response_", package, service);
  client.reader = make_reader(make_topic(reply_type, topic, type), false, 10);
  say("made");
  /* Both ways must be known before the first word. */
  const dds_entity_t waitset = dds_create_waitset(g_participant);
  const dds_entity_t ends[] = {client.writer, client.reader};
  require(dds_set_status_mask(client.writer, DDS_PUBLICATION_MATCHED_STATUS), "mask");
  require(dds_set_status_mask(client.reader, DDS_SUBSCRIPTION_MATCHED_STATUS), "mask");
  for (int i = 0; i < 2; ++i) require(dds_waitset_attach(waitset, ends[i], i + 1), "attach");
  require(dds_waitset_attach(waitset, g_end, 3), "attach");
  int matched = 0;
  while (matched != 3) {
    dds_attach_t tags[3];
    const int count = dds_waitset_wait(waitset, tags, 3, DDS_INFINITY);
    for (int i = 0; i < count; ++i) {
      uint32_t status = 0;
      if (tags[i] == 3) exit(1);
      matched |= (int)tags[i];
      dds_take_status(ends[tags[i] - 1], &status,
                      DDS_PUBLICATION_MATCHED_STATUS | DDS_SUBSCRIPTION_MATCHED_STATUS);
      require(dds_waitset_detach(waitset, ends[tags[i] - 1]), "detach");
    }
  }
  attach(client.reader, 0);
  say("ready");
  return client;
}

static void* wait_for_reply(const struct Client* client, const void* request) {
  for (;;) {
    dds_attach_t tags[2];
    const int count = dds_waitset_wait(g_waitset, tags, 2, DDS_INFINITY);
    for (int i = 0; i < count; ++i) {
      if (tags[i] != 0) exit(1);
    }
    void* sample = NULL;
    while (take(client->reader, &sample)) {
      if (same_call(request, sample)) return sample;
      dds_return_loan(client->reader, &sample, 1);
    }
  }
}

void* ask(const struct Client* client, const void* request) {
  require(dds_write(client->writer, request), "request");
  return wait_for_reply(client, request);
}

void* call(const char* node, const char* package, const char* service, const char* path,
                  const dds_topic_descriptor_t* request_type,
                  const dds_topic_descriptor_t* reply_type, const void* request) {
  const struct Client client = open_client(node, package, service, path, request_type, reply_type);
  return ask(&client, request);
}

static void time_get_state(const char* node, int count) {
  REQUEST(GetState, request);
  const struct Client client =
      open_client(node, "lifecycle_msgs", "GetState", "get_state",
                  &cyclone_requests_GetStateRequest_desc, &cyclone_requests_GetStateReply_desc);
  double* took_ms = calloc((size_t)count, sizeof *took_ms);
  if (took_ms == NULL) exit(1);
  for (int i = 0; i < count; ++i) {
    ++request.number;
    const dds_time_t begin = dds_time();
    void* reply = ask(&client, &request);
    took_ms[i] = 1e-6 * (double)(dds_time() - begin);
    dds_return_loan(client.reader, &reply, 1);
  }
  printf("took");
  for (int i = 0; i < count; ++i) printf(" %.4f", took_ms[i]);
  puts("");
  free(took_ms);
}

static void lifecycle(const char* name, char* node, char** arguments) {
  if (strcmp(name, "change_state") == 0) {
    REQUEST(ChangeState, request);
    request.body.transition.id = (uint8_t)atoi(arguments[0]);
    request.body.transition.label = "";
    const cyclone_requests_ChangeStateReply* reply =
        CALL(lifecycle_msgs, ChangeState, "change_state", &request);
    printf("success %d\n", reply->body.success ? 1 : 0);
  } else if (strcmp(name, "get_state") == 0) {
    REQUEST(GetState, request);
    const cyclone_requests_GetStateReply* reply =
        CALL(lifecycle_msgs, GetState, "get_state", &request);
    printf("state %d %s\n", reply->body.current_state.id, reply->body.current_state.label);
  } else if (strcmp(name, "get_state_twice") == 0) {
    REQUEST(GetState, request);
    const struct Client client =
        open_client(node, "lifecycle_msgs", "GetState", "get_state",
                    &cyclone_requests_GetStateRequest_desc, &cyclone_requests_GetStateReply_desc);
    cyclone_requests_GetStateReply* reply = ask(&client, &request);
    printf("state %d %s\n", reply->body.current_state.id, reply->body.current_state.label);
    fflush(stdout);
    dds_return_loan(client.reader, (void**)&reply, 1);
    wait_for_reply(&client, &request);
    puts("again");
  } else if (strcmp(name, "time_get_state") == 0) {
    time_get_state(node, atoi(arguments[0]));
  } else if (strcmp(name, "get_available_states") == 0) {
    REQUEST(GetAvailableStates, request);
    const cyclone_requests_GetAvailableStatesReply* reply =
        CALL(lifecycle_msgs, GetAvailableStates, "get_available_states", &request);
    printf("states %u %s\n", reply->body.available_states._length,
           reply->body.available_states._buffer[0].label);
  } else if (strcmp(name, "get_available_transitions") == 0) {
    REQUEST(GetAvailableTransitions, request);
    const cyclone_requests_GetAvailableTransitionsReply* reply =
        CALL(lifecycle_msgs, GetAvailableTransitions, "get_available_transitions", &request);
    printf("transitions %u %s\n", reply->body.available_transitions._length,
           reply->body.available_transitions._buffer[0].transition.label);
  }
}

static void read_parameters(const char* name, char* node, char** arguments) {
  if (strcmp(name, "list_parameters") == 0) {
    REQUEST(ListParameters, request);
    const cyclone_requests_ListParametersReply* reply =
        CALL(rcl_interfaces, ListParameters, "list_parameters", &request);
    for (uint32_t i = 0; i < reply->body.result.names._length; ++i) {
      printf("parameter %s\n", reply->body.result.names._buffer[i]);
    }
    printf("parameters %u\n", reply->body.result.names._length);
  } else if (strcmp(name, "get_parameter") == 0) {
    REQUEST(GetParameters, request);
    request.body.names._length = request.body.names._maximum = 1;
    request.body.names._buffer = arguments;
    const cyclone_requests_GetParametersReply* reply =
        CALL(rcl_interfaces, GetParameters, "get_parameters", &request);
    const rcl_interfaces_msg_ParameterValue* value = reply->body.values._buffer;
    if (reply->body.values._length != 1) exit(1);
    printf("value %d '%s' %lld %g\n", value->type, value->string_value,
           (long long)value->integer_value, value->double_value);
  } else if (strcmp(name, "get_parameter_type") == 0) {
    REQUEST(GetParameterTypes, request);
    request.body.names._length = request.body.names._maximum = 1;
    request.body.names._buffer = arguments;
    const cyclone_requests_GetParameterTypesReply* reply =
        CALL(rcl_interfaces, GetParameterTypes, "get_parameter_types", &request);
    if (reply->body.types._length != 1) exit(1);
    printf("type %d\n", reply->body.types._buffer[0]);
  } else if (strcmp(name, "describe_parameter") == 0) {
    REQUEST(DescribeParameters, request);
    request.body.names._length = request.body.names._maximum = 1;
    request.body.names._buffer = arguments;
    const cyclone_requests_DescribeParametersReply* reply =
        CALL(rcl_interfaces, DescribeParameters, "describe_parameters", &request);
    if (reply->body.descriptors._length != 1) exit(1);
    const rcl_interfaces_msg_ParameterDescriptor* found = reply->body.descriptors._buffer;
    const bool ranged = found->floating_point_range._length == 1;
    printf("descriptor %s %d %g %g\n", found->name, found->type,
           ranged ? found->floating_point_range._buffer[0].from_value : 0.0,
           ranged ? found->floating_point_range._buffer[0].to_value : 0.0);
  }
}

static void set_parameter(const char* name, char* node, char** arguments) {
  if (strncmp(name, "set_parameter", 13) != 0) return;
  rcl_interfaces_msg_Parameter parameter;
  memset(&parameter, 0, sizeof parameter);
  parameter.name = arguments[0];
  parameter.value.type = 3; /* PARAMETER_DOUBLE */
  parameter.value.double_value = atof(arguments[1]);
  parameter.value.string_value = "";
  const rcl_interfaces_msg_SetParametersResult* result = NULL;
  if (strcmp(name, "set_parameter") == 0) {
    REQUEST(SetParameters, request);
    request.body.parameters._length = request.body.parameters._maximum = 1;
    request.body.parameters._buffer = &parameter;
    const cyclone_requests_SetParametersReply* reply =
        CALL(rcl_interfaces, SetParameters, "set_parameters", &request);
    if (reply->body.results._length != 1) exit(1);
    result = reply->body.results._buffer;
  } else {
    REQUEST(SetParametersAtomically, request);
    request.body.parameters._length = request.body.parameters._maximum = 1;
    request.body.parameters._buffer = &parameter;
    const cyclone_requests_SetParametersAtomicallyReply* reply =
        CALL(rcl_interfaces, SetParametersAtomically, "set_parameters_atomically", &request);
    result = &reply->body.result;
  }
  printf("set %d %s\n", result->successful ? 1 : 0, result->reason);
}

static void maps(const char* name, char* node, char** arguments) {
  if (strcmp(name, "load_map") == 0) {
    REQUEST(LoadMap, request);
    request.body.map_url = arguments[0];
    const cyclone_requests_LoadMapReply* reply = CALL(nav2_msgs, LoadMap, "load_map", &request);
    printf("loaded %d %u %u\n", reply->body.result, reply->body.grid.info.width,
           reply->body.grid.info.height);
  } else if (strcmp(name, "get_map") == 0) {
    REQUEST(GetMap, request);
    const cyclone_requests_GetMapReply* reply = CALL(nav_msgs, GetMap, "map", &request);
    printf("map %u %u %s\n", reply->body.grid.info.width, reply->body.grid.info.height,
           reply->body.grid.header.frame_id);
  } else if (strcmp(name, "save_map") == 0) {
    REQUEST(SaveMap, request);
    request.body.map_topic = arguments[0];
    request.body.map_url = arguments[1];
    request.body.image_format = "pgm";
    request.body.map_mode = "trinary";
    request.body.free_thresh = 0.25F;
    request.body.occupied_thresh = 0.65F;
    const cyclone_requests_SaveMapReply* reply = CALL(nav2_msgs, SaveMap, "save_map", &request);
    printf("saved %d\n", reply->body.result ? 1 : 0);
  }
}

static void localization(const char* name, char* node, char** arguments) {
  if (strcmp(name, "set_initial_pose") == 0) {
    REQUEST(SetInitialPose, request);
    request.body.pose.header.frame_id = "map";
    request.body.pose.pose.pose.position.x = atof(arguments[0]);
    request.body.pose.pose.pose.position.y = atof(arguments[1]);
    request.body.pose.pose.pose.orientation.w = 1.0;
    CALL(nav2_msgs, SetInitialPose, "set_initial_pose", &request);
    puts("posed");
  } else if (strcmp(name, "empty") == 0) {
    REQUEST(Empty, request);
    CALL(std_srvs, Empty, arguments[0], &request);
    puts("done");
  }
}

void call_service(const char* name, char* node, char** arguments) {
  lifecycle(name, node, arguments);
  read_parameters(name, node, arguments);
  set_parameter(name, node, arguments);
  maps(name, node, arguments);
  localization(name, node, arguments);
  call_bags(name, node, arguments);
  manage(name, node, arguments);
}
