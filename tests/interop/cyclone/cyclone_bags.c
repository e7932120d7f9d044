/* SPDX-License-Identifier: Apache-2.0 */
/* The services of rosbag2's player and recorder, as a client of theirs calls them. */
#include "cyclone_bag_requests.h"
#include "cyclone_call.h"
#include "cyclone_peer.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A call without a word in either way. */
#define CALL_EMPTY(service, path)                     \
  if (strcmp(name, path) == 0) {                      \
    REQUEST(service, request);                        \
    CALL(rosbag2_interfaces, service, path, &request); \
    puts("done");                                     \
  }

void call_bags(const char* name, char* node, char** arguments) {
  CALL_EMPTY(Pause, "pause")
  CALL_EMPTY(Resume, "resume")
  CALL_EMPTY(TogglePaused, "toggle_paused")
  CALL_EMPTY(SplitBagfile, "split_bagfile")
  if (strcmp(name, "is_paused") == 0) {
    REQUEST(IsPaused, request);
    const cyclone_requests_IsPausedReply* reply =
        CALL(rosbag2_interfaces, IsPaused, "is_paused", &request);
    printf("paused %d\n", reply->body.paused ? 1 : 0);
  } else if (strcmp(name, "get_rate") == 0) {
    REQUEST(GetRate, request);
    const cyclone_requests_GetRateReply* reply =
        CALL(rosbag2_interfaces, GetRate, "get_rate", &request);
    printf("rate %g\n", reply->body.rate);
  } else if (strcmp(name, "set_rate") == 0) {
    REQUEST(SetRate, request);
    request.body.rate = atof(arguments[0]);
    const cyclone_requests_SetRateReply* reply =
        CALL(rosbag2_interfaces, SetRate, "set_rate", &request);
    printf("success %d\n", reply->body.success ? 1 : 0);
  } else if (strcmp(name, "seek") == 0) {
    REQUEST(Seek, request);
    request.body.time.sec = atoi(arguments[0]);
    const cyclone_requests_SeekReply* reply = CALL(rosbag2_interfaces, Seek, "seek", &request);
    printf("success %d\n", reply->body.success ? 1 : 0);
  } else if (strcmp(name, "play_next") == 0) {
    REQUEST(PlayNext, request);
    const cyclone_requests_PlayNextReply* reply =
        CALL(rosbag2_interfaces, PlayNext, "play_next", &request);
    printf("success %d\n", reply->body.success ? 1 : 0);
  }
}
