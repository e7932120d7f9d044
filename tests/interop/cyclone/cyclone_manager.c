/* SPDX-License-Identifier: Apache-2.0
 * What nav2's lifecycle manager does with a node, over clients that stay:
 *
 *   manage NODE ID ...      its state, then each transition and the state that it has led to:
 *                           "state ID", then "ID success 0|1 state ID"; at the end "managed"
 *   bond NAMESPACE NODE     heartbeats until its input ends; "bond 1" when the node answers them,
 *                           "bond 0" when it takes leave                                      */
#include "bond.h"
#include "cyclone_peer.h"
#include "cyclone_requests.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t kClient = 0x0fedcba987654321ULL;
static int64_t g_number = 0;

static int state_of(const struct Client* get_state) {
  cyclone_requests_GetStateRequest request;
  memset(&request, 0, sizeof request);
  request.guid = kClient;
  request.number = ++g_number;
  cyclone_requests_GetStateReply* reply = ask(get_state, &request);
  const int state = reply->body.current_state.id;
  dds_return_loan(get_state->reader, (void**)&reply, 1);
  return state;
}

static bool change(const struct Client* change_state, int transition) {
  cyclone_requests_ChangeStateRequest request;
  memset(&request, 0, sizeof request);
  request.guid = kClient;
  request.number = ++g_number;
  request.body.transition.id = (uint8_t)transition;
  request.body.transition.label = "";
  cyclone_requests_ChangeStateReply* reply = ask(change_state, &request);
  const bool success = reply->body.success;
  dds_return_loan(change_state->reader, (void**)&reply, 1);
  return success;
}

static void lead(const char* node, char** transitions) {
  const struct Client change_state = open_client(
      node, "lifecycle_msgs", "ChangeState", "change_state",
      &cyclone_requests_ChangeStateRequest_desc, &cyclone_requests_ChangeStateReply_desc);
  const struct Client get_state =
      open_client(node, "lifecycle_msgs", "GetState", "get_state",
                  &cyclone_requests_GetStateRequest_desc, &cyclone_requests_GetStateReply_desc);
  printf("state %d\n", state_of(&get_state));
  for (; *transitions != NULL; ++transitions) {
    const bool success = change(&change_state, atoi(*transitions));
    printf("%s success %d state %d\n", *transitions, success ? 1 : 0, state_of(&get_state));
    fflush(stdout);
  }
  say("managed");
}

static void hold_bond(const char* node_namespace, char* id) {
  char topic[256];
  snprintf(topic, sizeof topic, "rt%s/bond", node_namespace);
  const dds_entity_t made = make_topic(&bond_msg_Status_desc, topic, "bond::msg::dds_::Status_");
  const dds_entity_t writer = make_writer(made, false);
  const dds_entity_t reader = make_reader(made, false, 10);
  attach(reader, 0);
  bond_msg_Status beat;
  memset(&beat, 0, sizeof beat);
  beat.header.frame_id = "";
  beat.id = id;
  beat.instance_id = "the manager";
  beat.active = true;
  beat.heartbeat_timeout = 4.0F;
  beat.heartbeat_period = 0.1F;
  int last = -1;
  dds_time_t due = dds_time();
  for (;;) {
    // It hears its own heartbeats too: only those of the clock are to be followed by another.
    if (dds_time() >= due) {
      require(dds_write(writer, &beat), "heartbeat");
      due = dds_time() + DDS_MSECS(100);
    }
    dds_attach_t tags[2];
    const int count = dds_waitset_wait_until(g_waitset, tags, 2, due);
    for (int i = 0; i < count; ++i) {
      if (tags[i] != 0) return;
    }
    void* sample = NULL;
    while (take(reader, &sample)) {
      const bond_msg_Status* heard = sample;
      const bool is_other = strcmp(heard->instance_id, beat.instance_id) != 0;
      const int active = heard->active ? 1 : 0;
      if (is_other && strcmp(heard->id, id) == 0 && active != last) {
        last = active;
        printf("bond %d\n", active);
        fflush(stdout);
      }
      dds_return_loan(reader, &sample, 1);
    }
  }
}

void manage(const char* name, char* node, char** arguments) {
  if (strcmp(name, "manage") == 0) lead(node, arguments);
  if (strcmp(name, "bond") == 0) hold_bond(node, arguments[0]);
}
